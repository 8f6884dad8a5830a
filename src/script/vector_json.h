#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace meshgraft {

/// Returns the elements of a vector as a list of JSON.
template <class Json = nlohmann::ordered_json, class Derived>
Json vector_json(const Eigen::MatrixBase<Derived>& vector) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < vector.size(); ++i) list.push_back(vector(i));
  return list;
}

}  // namespace meshgraft
