// Takes the place of intersections.cpp in a build without CGAL.
#include <meshgraft/deform/intersections.h>

namespace meshgraft {

std::optional<std::vector<TrianglePair>> self_intersections(const Points&, const Triangles&,
                                                            std::span<const Index>, const Context&) {
  return std::nullopt;
}

std::optional<std::vector<TrianglePair>> new_self_intersections(const Points&, const Points&, const Triangles&,
                                                                std::span<const Index>, const Context&) {
  return std::nullopt;
}

}  // namespace meshgraft
