#include "partition.h"

#include <algorithm>

#include "petsc_objects.h"

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

/// Returns the rings of the own flagged vertices as PETSc's adjacency matrix.
OwnedMat adjacency(const Communicator& comm, const LocalMesh& mesh, const std::vector<Number>& numbers,
                   const std::vector<Number>& starts) {
  std::size_t entries = 0;
  const auto for_each_edge = [&](const auto& end_row, const auto& body) {
    for (Index v = 0; v < mesh.vertices.own(); ++v) {
      if (numbers[v] < 0) continue;
      for (const Index w : mesh.rings[v])
        if (numbers[w] >= 0) body(numbers[w]);
      end_row();
    }
  };
  for_each_edge([] {}, [&](Number) { ++entries; });
  const auto rows = static_cast<PetscInt>(starts[comm.rank() + 1] - starts[comm.rank()]);
  PetscInt *offsets = nullptr, *columns = nullptr;  // the matrix frees them
  require(PetscMalloc1(rows + 1, &offsets));
  require(PetscMalloc1(entries + 1, &columns));
  PetscInt entry = 0, row = 0;
  offsets[0] = 0;
  for_each_edge(
      [&] {
        std::sort(columns + offsets[row], columns + entry);
        offsets[++row] = entry;
      },
      [&](Number column) { columns[entry++] = static_cast<PetscInt>(column); });
  OwnedMat matrix;
  require(MatCreateMPIAdj(comm.get(), rows, static_cast<PetscInt>(starts.back()), offsets, columns, nullptr,
                          matrix.out()));
  return matrix;
}

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
  const OwnedMat graph = adjacency(comm, mesh, numbers, starts);
  OwnedPartitioning partitioning;
  require(MatPartitioningCreate(comm.get(), partitioning.out()));
  require(MatPartitioningSetAdjacency(partitioning, graph));
  require(MatPartitioningSetType(partitioning, MATPARTITIONINGPTSCOTCH));
  require(MatPartitioningSetFromOptions(partitioning));
  OwnedIs parts;
  require(MatPartitioningApply(partitioning, parts.out()));
  const PetscInt* part = nullptr;
  require(ISGetIndices(parts, &part));
  for (Index v = 0, row = 0; v < own; ++v)
    if (numbers[v] >= 0) rank_of[v] = static_cast<int>(part[row++]);
  require(ISRestoreIndices(parts, &part));
  return rank_of;
}

}  // namespace meshgraft::distributed
