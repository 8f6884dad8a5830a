#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/orientation.h>

#include "cli/facts.h"

namespace meshgraft::cli {

/// Parses finite numbers with `separator` between them and nothing else. Throws Error(usage) that names
/// `option`.
template <class T>
std::vector<T> numbers(std::string_view text, const std::string& option, char separator = ',') {
  std::vector<T> values;
  while (true) {
    const std::string_view word = text.substr(0, text.find(separator));
    T value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error == std::errc::result_out_of_range)
      throw Error(facts::cli::NumberTooLargeOrSmall{.text = word}, Location::place(option));
    if (error != std::errc() || end != word.data() + word.size())
      throw Error(facts::cli::NotANumber{.text = word, .separator = std::string(1, separator)},
                  Location::place(option));
    if constexpr (std::is_floating_point_v<T>)
      if (!std::isfinite(value)) throw Error(facts::cli::NotFinite{.text = word}, Location::place(option));
    values.push_back(value);
    if (word.size() == text.size()) return values;
    text.remove_prefix(word.size() + 1);
  }
}

/// Parses "x=0.5" (or y, z), or a point and a normal as px,py,pz,nx,ny,nz. Throws Error(usage) that names
/// `option`.
Plane parse_plane(const std::string& text, const std::string& option);

/// The known orientations of two models.
struct UprightModels {
  Orientation target, source;
};

/// Parses "UP,FRONT:UP,FRONT", target first, of axes such as z and -y. Throws Error(usage) that names `option`.
UprightModels parse_upright(std::string_view text, const std::string& option);

/// Parses two numbers from 0 on, such as "12:7". Throws Error(usage) that names `option`.
std::array<Index, 2> index_pair(const std::string& text, const std::string& option);

/// Returns a coordinate as text, rounded to that many digits of `size` or of the value, whichever is finer.
std::string coordinate_text(double value, double size, int digits = 6);

}  // namespace meshgraft::cli
