#include "partition.h"

#include <mpi.h>
#include <ptscotch.h>

#include <algorithm>
#include <limits>

#include <meshgraft/core/error.h>

#include "distributed/facts.h"

namespace meshgraft::distributed {

namespace {

/// Numbers the flagged vertices over all ranks; others get -1. The result has one number per local vertex.
std::vector<Number> number_flagged(const LocalMesh& mesh, std::span<const std::uint8_t> flagged, Number first) {
  std::vector<Number> numbers(mesh.vertices.size(), -1);
  for (Index v = 0; v < mesh.vertices.own(); ++v)
    if (flagged[v]) numbers[v] = first++;
  mesh.vertices.update(numbers);
  return numbers;
}

/// The edges from the own flagged vertices to flagged ones, as PT-Scotch numbers them.
struct Adjacency {
  std::vector<SCOTCH_Num> offsets{0}, neighbours;
};

/// Throws Error(input) if the vertices of all ranks have more neighbours together than PT-Scotch can number.
Adjacency adjacency(const Communicator& comm, const LocalMesh& mesh, const std::vector<Number>& numbers) {
  const auto for_each_neighbour = [&](Index v, const auto& body) {
    for (const Index w : mesh.rings[v])
      if (numbers[w] >= 0) body(numbers[w]);
  };
  Number own = 0;
  for (Index v = 0; v < mesh.vertices.own(); ++v)
    if (numbers[v] >= 0) for_each_neighbour(v, [&](Number) { ++own; });
  const Number count = comm.sum(own);
  if (count > std::numeric_limits<SCOTCH_Num>::max())
    throw Error(facts::distributed::NeedsWideGraph{.neighbours = count});
  Adjacency edges;
  comm.together([&] {
    edges.neighbours.reserve(static_cast<std::size_t>(own));
    for (Index v = 0; v < mesh.vertices.own(); ++v) {
      if (numbers[v] < 0) continue;
      for_each_neighbour(v, [&](Number w) { edges.neighbours.push_back(static_cast<SCOTCH_Num>(w)); });
      edges.offsets.push_back(static_cast<SCOTCH_Num>(edges.neighbours.size()));
    }
  });
  return edges;
}

void require_scotch(int status) {
  if (status != 0) throw Error(facts::distributed::DivisionFailed{});
}

/// The ranks that call with `takes_part`, as a communicator of their own.
class SomeRanks {
 public:
  SomeRanks(const Communicator& comm, bool takes_part) {
    MPI_Comm_split(comm.get(), takes_part ? 0 : MPI_UNDEFINED, comm.rank(), &comm_);
  }
  SomeRanks(const SomeRanks&) = delete;
  SomeRanks& operator=(const SomeRanks&) = delete;
  ~SomeRanks() {
    if (comm_ != MPI_COMM_NULL) MPI_Comm_free(&comm_);
  }
  MPI_Comm get() const { return comm_; }

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
};

/// A distributed graph of PT-Scotch. `edges` must outlive it.
class ScotchGraph {
 public:
  ScotchGraph(MPI_Comm comm, Adjacency& edges) {
    require_scotch(SCOTCH_dgraphInit(&graph_, comm));
    const auto vertices = static_cast<SCOTCH_Num>(edges.offsets.size()) - 1;
    const auto arcs = static_cast<SCOTCH_Num>(edges.neighbours.size());
    built_ = SCOTCH_dgraphBuild(&graph_, 0, vertices, vertices, edges.offsets.data(), edges.offsets.data() + 1,
                                nullptr, nullptr, arcs, arcs, edges.neighbours.data(), nullptr, nullptr);
  }
  ScotchGraph(const ScotchGraph&) = delete;
  ScotchGraph& operator=(const ScotchGraph&) = delete;
  ~ScotchGraph() { SCOTCH_dgraphExit(&graph_); }

  /// Returns the part of each own vertex.
  std::vector<SCOTCH_Num> divide(SCOTCH_Num parts, std::size_t own) {
    require_scotch(built_);
    constexpr double imbalance = 0.01;
    SCOTCH_Strat strategy;
    require_scotch(SCOTCH_stratInit(&strategy));
    std::vector<SCOTCH_Num> part(own);
    const bool divided =
        SCOTCH_stratDgraphMapBuild(&strategy, SCOTCH_STRATDEFAULT, parts, parts, imbalance) == 0 &&
        SCOTCH_dgraphPart(&graph_, parts, &strategy, part.data()) == 0;
    SCOTCH_stratExit(&strategy);
    require_scotch(divided ? 0 : 1);
    return part;
  }

 private:
  SCOTCH_Dgraph graph_;
  int built_ = 0;
};

}  // namespace

std::vector<int> partition_vertices(const Communicator& comm, const LocalMesh& mesh,
                                    std::span<const std::uint8_t> flagged) {
  const Index own = mesh.vertices.own();
  std::vector<int> rank_of(own, -1);
  const std::vector<Number> starts = comm.starts(std::count(flagged.begin(), flagged.begin() + own, 1));
  const std::vector<Number> numbers = number_flagged(mesh, flagged, starts[comm.rank()]);
  const Number total = starts.back();
  constexpr Number few = 200;
  if (total < few * comm.size() || comm.size() == 1) {
    const Number per_rank = std::max<Number>(1, (total + comm.size() - 1) / comm.size());
    for (Index v = 0; v < own; ++v)
      if (numbers[v] >= 0) rank_of[v] = static_cast<int>(numbers[v] / per_rank);
    return rank_of;
  }
  Adjacency edges = adjacency(comm, mesh, numbers);
  const std::size_t flagged_count = edges.offsets.size() - 1;
  const SomeRanks with_vertices(comm, flagged_count > 0);
  std::vector<SCOTCH_Num> part;
  comm.together([&] {
    if (flagged_count == 0) return;
    ScotchGraph graph(with_vertices.get(), edges);
    part = graph.divide(static_cast<SCOTCH_Num>(comm.size()), flagged_count);
  });
  for (std::size_t v = 0, row = 0; v < numbers.size() && row < part.size(); ++v)
    if (numbers[v] >= 0) rank_of[v] = static_cast<int>(part[row++]);
  return rank_of;
}

}  // namespace meshgraft::distributed
