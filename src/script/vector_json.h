#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace meshgraft {

/// Returns the elements of a vector as a list.
template <class Derived>
nlohmann::ordered_json vector_json(const Eigen::MatrixBase<Derived>& vector) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < vector.size(); ++i) list.push_back(vector(i));
  return list;
}

}  // namespace meshgraft
