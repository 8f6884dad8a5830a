#include "face_keys.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "face_defects.h"

namespace meshgraft {

namespace {

// Writes the corners of a face in canonical order: from its smallest corner on, towards that corner's smaller
// neighbour.
void canonical(std::span<const Index> face, std::span<const Index> number, std::vector<Index>& out) {
  out.clear();
  for (const Index v : face) out.push_back(number.empty() ? v : number[v]);
  std::rotate(out.begin(), std::min_element(out.begin(), out.end()), out.end());
  if (out.size() > 2 && out.back() < out[1]) std::reverse(out.begin() + 1, out.end());
}

}  // namespace

std::vector<std::vector<Index>> same_faces(const Faces& faces, Index vertex_count,
                                           std::span<const Index> number) {
  std::vector<std::pair<std::uint64_t, Index>> order;  // hash of the face, face
  order.reserve(faces.size());
  std::vector<Index> key, other;
  for (Index f = 0; f < faces.size(); ++f) {
    const auto face = faces[f];
    if (!std::all_of(face.begin(), face.end(), [&](Index v) { return v >= 0 && v < vertex_count; })) continue;
    canonical(face, number, key);
    if (is_degenerate(key)) continue;
    std::uint64_t hash = key.size();
    for (const Index v : key) {
      hash = (hash ^ static_cast<std::uint64_t>(v)) * 0x9E3779B97F4A7C15ull;
      hash ^= hash >> 29;
    }
    order.emplace_back(hash, f);
  }
  std::sort(order.begin(), order.end());

  std::vector<std::vector<Index>> groups;
  Flags taken;
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin + 1;
    while (end < order.size() && order[end].first == order[begin].first) ++end;
    taken.assign(end - begin, 0);
    for (std::size_t i = begin; i + 1 < end; ++i) {  // equal hashes: nearly always equal faces
      if (taken[i - begin]) continue;
      canonical(faces[order[i].second], number, key);
      std::vector<Index> group{order[i].second};
      for (std::size_t k = i + 1; k < end; ++k) {
        canonical(faces[order[k].second], number, other);
        if (taken[k - begin] || key != other) continue;
        taken[k - begin] = 1;
        group.push_back(order[k].second);
      }
      if (group.size() > 1) groups.push_back(std::move(group));
    }
    begin = end;
  }
  std::sort(groups.begin(), groups.end());
  return groups;
}

}  // namespace meshgraft
