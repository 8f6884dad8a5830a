#include "part.h"

#include <algorithm>
#include <numeric>

namespace meshgraft::distributed {

Redistribution::Redistribution(const Communicator& comm, const LocalMesh& mesh, const std::vector<int>& rank_of,
                               int layers)
    : comm_(comm), rank_of_(rank_of), sent_(comm.size()), received_(comm.size()) {
  // The vertices of a part are numbered in the order of the whole mesh, whose ranks have consecutive ranges.
  for (Index v = 0; v < mesh.vertices.own(); ++v)
    if (rank_of[v] >= 0) sent_[rank_of[v]].push_back(v);
  const ByRank<Index> arrived = comm.exchange(sent_);
  Index own = 0;
  for (int rank = 0; rank < comm.size(); ++rank) {
    received_[rank].resize(arrived[rank].size());
    std::iota(received_[rank].begin(), received_[rank].end(), own);
    own += static_cast<Index>(arrived[rank].size());
  }
  const std::vector<Number> starts = comm.starts(own);

  ByRank<Number> numbered(comm.size());
  for (int rank = 0; rank < comm.size(); ++rank)
    for (const Index v : received_[rank]) numbered[rank].push_back(starts[comm.rank()] + v);
  const ByRank<Number> answers = comm.exchange(numbered);
  std::vector<Number> number(mesh.vertices.size(), -1);
  for (int rank = 0; rank < comm.size(); ++rank)
    for (std::size_t k = 0; k < sent_[rank].size(); ++k) number[sent_[rank][k]] = answers[rank][k];
  mesh.vertices.update(number);

  std::vector<NumberedTriangle> triangles;
  for (Index t = 0; t < mesh.triangles.rows(); ++t) {
    if (!mesh.owns_triangle(t)) continue;
    const auto corners = mesh.triangles.row(t);
    if (std::all_of(corners.begin(), corners.end(), [&](Index v) { return number[v] >= 0; }))
      triangles.push_back(
          {mesh.triangle_numbers[t], {number[corners[0]], number[corners[1]], number[corners[2]]}});
  }
  part_ = make_local_mesh(comm, starts, triangles, layers);
}

Columns Redistribution::bring(const Columns& values) const {
  const Eigen::Index width = values.cols();
  ByRank<double> to(comm_.size());
  for (int rank = 0; rank < comm_.size(); ++rank)
    for (const Index v : sent_[rank])
      to[rank].insert(to[rank].end(), values.row(v).begin(), values.row(v).end());
  const ByRank<double> from = comm_.exchange(to);
  Columns of_part(part_.vertices.size(), width);
  for (int rank = 0; rank < comm_.size(); ++rank)
    for (std::size_t k = 0; k < received_[rank].size(); ++k)
      of_part.row(received_[rank][k]) =
          Eigen::Map<const Eigen::RowVectorXd>(from[rank].data() + k * static_cast<std::size_t>(width), width);
  part_.vertices.update(of_part);
  return of_part;
}

void Redistribution::bring_back(const Columns& of_part, Columns& values) const {
  const Eigen::Index width = of_part.cols();
  ByRank<double> to(comm_.size());
  for (int rank = 0; rank < comm_.size(); ++rank)
    for (const Index v : received_[rank])
      to[rank].insert(to[rank].end(), of_part.row(v).begin(), of_part.row(v).end());
  const ByRank<double> from = comm_.exchange(to);
  for (int rank = 0; rank < comm_.size(); ++rank)
    for (std::size_t k = 0; k < sent_[rank].size(); ++k)
      values.row(sent_[rank][k]) =
          Eigen::Map<const Eigen::RowVectorXd>(from[rank].data() + k * static_cast<std::size_t>(width), width);
}

Flags flag_patch(const LocalMesh& mesh, std::span<const std::uint8_t> active, int rings) {
  Flags inside(mesh.vertices.size(), 0);
  std::copy_n(active.begin(), mesh.vertices.own(), inside.begin());
  mesh.vertices.update(inside);
  for (int ring = 0; ring <= rings; ++ring) {
    Flags wider = inside;
    for (Index v = 0; v < mesh.vertices.own(); ++v)
      wider[v] |=
          std::any_of(mesh.rings[v].begin(), mesh.rings[v].end(), [&](Index w) { return inside[w] != 0; });
    mesh.vertices.update(wider);
    inside.swap(wider);
  }
  return inside;
}

}  // namespace meshgraft::distributed
