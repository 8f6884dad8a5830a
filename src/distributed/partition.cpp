#include "partition.h"

#include <mpi.h>
#include <ptscotch.h>

#include <algorithm>
#include <limits>
#include <optional>

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

/// Throws Error(internal) if the loaded library is not that of the header, which a path may do.
void require_same_numbers() {
  const int found = SCOTCH_numSizeof();
  constexpr int built = sizeof(SCOTCH_Num);
  if (found != built) throw Error(facts::distributed::DivisionOfOtherNumbers{.found = found, .built = built});
}

/// The ranks that call with `takes_part`, as a communicator of their own. It has none on the others.
class SomeRanks {
 public:
  SomeRanks(const Communicator& comm, bool takes_part) {
    const bool is_split =
        MPI_Comm_split(comm.get(), takes_part ? 0 : MPI_UNDEFINED, comm.rank(), &comm_) == MPI_SUCCESS;
    if (comm.any(!is_split)) throw Error(facts::distributed::DivisionFailed{});
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

/// A distributed graph of PT-Scotch with the strategy that divides it. Each function returns whether it
/// succeeded on this rank; all ranks call the next one only where all succeeded.
class ScotchGraph {
 public:
  explicit ScotchGraph(MPI_Comm comm)
      : made_(SCOTCH_stratInit(&strategy_) == 0 && SCOTCH_dgraphInit(&graph_, comm) == 0) {}
  ScotchGraph(const ScotchGraph&) = delete;
  ScotchGraph& operator=(const ScotchGraph&) = delete;
  ~ScotchGraph() {
    if (!made_) return;
    SCOTCH_dgraphExit(&graph_);
    SCOTCH_stratExit(&strategy_);
  }

  bool is_made() const { return made_; }
  /// `edges` must outlive the graph.
  bool build(Adjacency& edges) {
    const auto vertices = static_cast<SCOTCH_Num>(edges.offsets.size()) - 1;
    const auto arcs = static_cast<SCOTCH_Num>(edges.neighbours.size());
    return SCOTCH_dgraphBuild(&graph_, 0, vertices, vertices, edges.offsets.data(), edges.offsets.data() + 1,
                              nullptr, nullptr, arcs, arcs, edges.neighbours.data(), nullptr, nullptr) == 0;
  }
  /// Writes the part of each own vertex.
  bool divide(SCOTCH_Num parts, SCOTCH_Num* part_of) {
    constexpr double imbalance = 0.01;
    return SCOTCH_stratDgraphMapBuild(&strategy_, SCOTCH_STRATDEFAULT, parts, parts, imbalance) == 0 &&
           SCOTCH_dgraphPart(&graph_, parts, &strategy_, part_of) == 0;
  }

 private:
  SCOTCH_Dgraph graph_;
  SCOTCH_Strat strategy_;
  bool made_ = false;
};

/// Returns the part of each own vertex of a graph. Ranks without vertices take no part, for which PT-Scotch is
/// not made.
std::vector<SCOTCH_Num> divide(const Communicator& comm, Adjacency& edges) {
  const std::size_t own = edges.offsets.size() - 1;
  std::vector<SCOTCH_Num> part_of;
  comm.together([&] { part_of.resize(own); });
  const SomeRanks with_vertices(comm, own > 0);
  const auto require_on_all = [&](bool succeeded) {
    if (comm.any(!succeeded)) throw Error(facts::distributed::DivisionFailed{});
  };
  std::optional<ScotchGraph> graph;
  if (own > 0) graph.emplace(with_vertices.get());
  require_on_all(!graph || graph->is_made());
  require_on_all(!graph || graph->build(edges));
  require_on_all(!graph || graph->divide(static_cast<SCOTCH_Num>(comm.size()), part_of.data()));
  return part_of;
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
  comm.together(require_same_numbers);
  Adjacency edges = adjacency(comm, mesh, numbers);
  const std::vector<SCOTCH_Num> part = divide(comm, edges);
  for (Index v = 0, row = 0; v < own; ++v)
    if (numbers[v] >= 0) rank_of[v] = static_cast<int>(part[row++]);
  return rank_of;
}

}  // namespace meshgraft::distributed
