#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

#include "communicator.h"

namespace meshgraft::distributed {

/// Items that each rank owns a range of, and copies of other ranks' items. A rank numbers its own items from 0
/// and its copies, the halo, after them.
class Halo {
 public:
  Halo() = default;
  /// `starts` has where each rank's items start, and the number of all. `copies` are the numbers of the items
  /// in the halo, ascending, none of them own.
  Halo(const Communicator& comm, std::vector<Number> starts, std::vector<Number> copies);

  Number first() const { return starts_[comm_->rank()]; }
  Index own() const { return static_cast<Index>(starts_[comm_->rank() + 1] - first()); }
  Index size() const { return own() + static_cast<Index>(copies_.size()); }
  Number total() const { return starts_.back(); }
  const std::vector<Number>& starts() const { return starts_; }
  const std::vector<Number>& copies() const { return copies_; }
  /// Returns the rank that owns an item.
  int owner(Number number) const;
  /// Returns the number of a local item.
  Number number(Index local) const { return local < own() ? first() + local : copies_[local - own()]; }
  /// Returns the local index of an item, or -1 if this rank has no copy of it.
  Index local(Number number) const;

  /// Copies `width` values of each item from its owner to the halo of other ranks. `values` has size() · width
  /// values, item by item.
  template <class T>
  void update(T* values, int width = 1) const {
    std::vector<T> packed(sent_.size() * static_cast<std::size_t>(width));
    for (std::size_t k = 0; k < sent_.size(); ++k)
      std::copy_n(values + static_cast<std::ptrdiff_t>(sent_[k]) * width, width,
                  packed.data() + k * static_cast<std::size_t>(width));
    const std::size_t bytes = sizeof(T) * static_cast<std::size_t>(width);
    comm_->transfer(messages(send_from_, packed.data(), bytes),
                    messages(copies_from_, values + static_cast<std::ptrdiff_t>(own()) * width, bytes), bytes);
  }
  template <class T>
  void update(std::vector<T>& values) const {
    update(values.data());
  }
  template <class Derived>
  void update(Eigen::PlainObjectBase<Derived>& rows) const {
    update(rows.data(), static_cast<int>(rows.cols()));
  }

  /// Adds the values of the halo to those of the items' owners. The halo's values stay.
  template <class Derived>
  void add_to_owners(Eigen::PlainObjectBase<Derived>& rows) const {
    const auto width = static_cast<int>(rows.cols());
    std::vector<double> packed(sent_.size() * static_cast<std::size_t>(width));
    const std::size_t bytes = sizeof(double) * static_cast<std::size_t>(width);
    comm_->transfer(messages(copies_from_, rows.data() + static_cast<std::ptrdiff_t>(own()) * width, bytes),
                    messages(send_from_, packed.data(), bytes), bytes);
    for (std::size_t k = 0; k < sent_.size(); ++k)
      for (int column = 0; column < width; ++column)
        rows(sent_[k], column) +=
            packed[k * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
  }

  /// Returns how many ranks this one sends to at each update.
  int neighbour_count() const { return static_cast<int>(send_from_.size()); }

 private:
  /// The items for or from one rank, as a range of a list.
  struct Range {
    int rank;
    std::size_t begin, end;
  };
  static std::vector<Communicator::Message> messages(const std::vector<Range>& ranges, void* items,
                                                     std::size_t item_size);

  const Communicator* comm_ = nullptr;
  std::vector<Number> starts_, copies_;
  std::vector<Range> copies_from_;  ///< ranges of `copies_`
  std::vector<Index> sent_;         ///< own items that other ranks have copies of, rank by rank
  std::vector<Range> send_from_;    ///< ranges of `sent_`
};

/// A triangle by its number and the numbers of its vertices.
struct NumberedTriangle {
  Number number = -1;
  std::array<Number, 3> corners{};
};

/// A rank's part of a mesh: its own vertices, and those around them.
struct LocalMesh {
  Halo vertices;
  Triangles triangles;  ///< local indices, in the order of their numbers
  std::vector<Number> triangle_numbers;
  IndexLists faces_at, rings;  ///< per local vertex

  /// Returns whether the triangle belongs to this rank: it owns the corner with the smallest number.
  bool owns_triangle(Index triangle) const;
};

/// Makes a local mesh. Any rank may have any triangle, but each triangle is at one rank. The result has all
/// triangles around the vertices that are within `layers` edges of an own vertex. A rank without own vertices
/// gets those around vertex 0, so that no rank with work to do has an empty mesh.
LocalMesh make_local_mesh(const Communicator& comm, const std::vector<Number>& starts,
                          const std::vector<NumberedTriangle>& triangles, int layers);

}  // namespace meshgraft::distributed
