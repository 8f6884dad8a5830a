#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "core/memory_budget.h"

/// Growing lists whose memory is charged to a budget before it is allocated.
namespace meshgraft::io {

/// About what a short text takes in a map, a set or a list, and its node: the text itself and two copies of
/// its characters come on top.
inline constexpr std::uint64_t bytes_of_label = 256;

inline std::uint64_t bytes_of(std::string_view label) { return bytes_of_label + 2 * label.size(); }

/// Makes the capacity of a list at least `size`.
template <class T>
void reserve_charged(std::vector<T>& list, std::size_t size, MemoryBudget& budget) {
  const std::size_t before = list.capacity();
  if (size <= before) return;
  budget.charge(size * sizeof(T));
  list.reserve(size);
  budget.release(before * sizeof(T));
}

/// Makes room for `more` further elements. Capacities at least double, so that growing takes linear time.
template <class T>
void make_room(std::vector<T>& list, std::size_t more, MemoryBudget& budget) {
  const std::size_t needed = list.size() + more;
  if (needed > list.capacity()) reserve_charged(list, std::max(needed, 2 * list.capacity()), budget);
}

template <class T>
void push_charged(std::vector<T>& list, T element, MemoryBudget& budget) {
  make_room(list, 1, budget);
  list.push_back(std::move(element));
}

/// Resizes a list that is to be filled, with new elements equal to `value`.
template <class T>
void resize_charged(std::vector<T>& list, std::size_t size, const T& value, MemoryBudget& budget) {
  reserve_charged(list, size, budget);
  list.resize(size, value);
}

/// Frees the memory of a list.
template <class T>
void free_charged(std::vector<T>& list, MemoryBudget& budget) {
  budget.release(list.capacity() * sizeof(T));
  list = std::vector<T>();
}

/// Faces without an element have a capacity of one offset, which is not charged.
inline std::uint64_t bytes_of_offsets(const Faces& faces) {
  return faces.offsets().capacity() > 1 ? faces.offsets().capacity() * sizeof(Index) : 0;
}
inline std::uint64_t bytes_of_corners(const Faces& faces) { return faces.corners().capacity() * sizeof(Index); }

/// Makes the capacity at least so many faces and corners.
inline void reserve_charged(Faces& faces, std::size_t face_count, std::size_t corners, MemoryBudget& budget) {
  constexpr std::size_t most = std::numeric_limits<Index>::max();
  face_count = std::min(face_count, most - 1);
  corners = std::min(corners, most);
  const bool more_offsets = face_count + 1 > faces.offsets().capacity();
  const bool more_corners = corners > faces.corners().capacity();
  const std::uint64_t before =
      (more_offsets ? bytes_of_offsets(faces) : 0) + (more_corners ? bytes_of_corners(faces) : 0);
  budget.charge(((more_offsets ? face_count + 1 : 0) + (more_corners ? corners : 0)) * sizeof(Index));
  faces.reserve(static_cast<Index>(face_count), static_cast<Index>(corners));
  budget.release(before);
}

inline void push_charged(Faces& faces, std::span<const Index> face, MemoryBudget& budget) {
  const std::size_t offsets = faces.offsets().capacity(), corners = faces.corners().capacity();
  const bool more_offsets = faces.offsets().size() == offsets;
  const std::size_t corner_count = faces.corners().size() + face.size();
  if (more_offsets || corner_count > corners)
    reserve_charged(faces, more_offsets ? 2 * offsets : 0,
                    corner_count > corners ? std::max(corner_count, 2 * corners) : 0, budget);
  faces.push_back(face);
}

/// Frees the memory of faces.
inline void free_charged(Faces& faces, MemoryBudget& budget) {
  budget.release(bytes_of_offsets(faces) + bytes_of_corners(faces));
  faces = Faces();
}

/// Makes positions of so many vertices, to be filled.
inline void resize_charged(Points& positions, std::size_t vertices, MemoryBudget& budget) {
  budget.charge(vertices * 3 * sizeof(double));
  positions.resize(static_cast<Eigen::Index>(vertices), 3);
}

}  // namespace meshgraft::io
