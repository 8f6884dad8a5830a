#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <Eigen/Core>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::python {

namespace nb = nanobind;

// Arrays that the front has checked and converted: C-contiguous, of these types. Reading them copies nothing.
using PointsIn = nb::ndarray<const double, nb::ndim<2>, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using TrianglesIn = nb::ndarray<const Index, nb::ndim<2>, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using IndicesIn = nb::ndarray<const Index, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using NumbersIn = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using PointsOut = nb::ndarray<double, nb::ndim<2>, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

inline Points points_of(const PointsIn& array) {
  return Eigen::Map<const Points>(array.data(), static_cast<Eigen::Index>(array.shape(0)), 3);
}

inline Triangles triangles_of(const TrianglesIn& array) {
  return Eigen::Map<const Triangles>(array.data(), static_cast<Eigen::Index>(array.shape(0)), 3);
}

inline std::vector<Index> indices_of(const IndicesIn& array) {
  return {array.data(), array.data() + array.size()};
}

inline Eigen::Map<Points> map_of(const PointsOut& array) {
  return {array.data(), static_cast<Eigen::Index>(array.shape(0)), 3};
}

/// Returns an array over memory that `owner` keeps.
template <class Scalar>
nb::object view_of(const Scalar* data, std::initializer_list<std::size_t> shape, nb::handle owner) {
  static const Scalar nothing{};  // an empty array has an address, too
  using Array = nb::ndarray<nb::numpy, const Scalar>;
  return nb::cast(Array(data == nullptr ? &nothing : data, shape.size(), shape.begin(), owner));
}

/// Returns an array of NumPy's that owns what is moved into it: `shape` over `data(owned)`.
template <class Owned, class Shape>
nb::object array_over(Owned owned, const Shape& shape) {
  using Scalar = std::remove_const_t<std::remove_pointer_t<decltype(owned.data())>>;
  auto* kept = new Owned(std::move(owned));
  nb::capsule owner(kept, [](void* pointer) noexcept { delete static_cast<Owned*>(pointer); });
  static Scalar nothing{};
  Scalar* data = kept->data() == nullptr ? &nothing : kept->data();
  return nb::cast(nb::ndarray<nb::numpy, Scalar>(data, shape.size(), shape.data(), owner));
}

template <class Scalar>
nb::object array_of(std::vector<Scalar> values) {
  const std::array<std::size_t, 1> shape{values.size()};
  return array_over(std::move(values), shape);
}

/// Returns a row-major matrix as an array of two dimensions.
template <class Scalar, int rows, int cols>
  requires(rows != 1 && cols != 1)
nb::object array_of(Eigen::Matrix<Scalar, rows, cols, Eigen::RowMajor> matrix) {
  using Dynamic = Eigen::Matrix<Scalar, Eigen::Dynamic, cols, Eigen::RowMajor>;
  const std::array<std::size_t, 2> shape{static_cast<std::size_t>(matrix.rows()),
                                         static_cast<std::size_t>(matrix.cols())};
  return array_over(Dynamic(std::move(matrix)), shape);
}

/// Returns a vector of three as an array.
inline nb::object array_of(const Eigen::Vector3d& vector) {
  return array_of(std::vector<double>(vector.data(), vector.data() + 3));
}

}  // namespace meshgraft::python
