#include "values.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "cli/facts.h"

namespace meshgraft::cli {

namespace {

// Returns whether a text is meant as a list of numbers, rather than as an axis and a place on it.
bool is_list(const std::string& text) {
  return text.find('=') == std::string::npos && text.find(',') != std::string::npos;
}

Plane plane_from(const std::string& text, const std::string& option) {
  Plane plane;
  if (text.size() > 2 && text[1] == '=' && text[0] >= 'x' && text[0] <= 'z') {
    const auto values = numbers<double>(std::string_view(text).substr(2), option);
    if (values.size() == 1) {
      plane.point[text[0] - 'x'] = values[0];
      plane.normal[text[0] - 'x'] = 1;
      return plane;
    }
  } else if (is_list(text)) {
    const auto values = numbers<double>(text, option);
    if (values.size() == 6) {
      plane.point = Eigen::Map<const Eigen::Vector3d>(values.data());
      plane.normal = Eigen::Map<const Eigen::Vector3d>(values.data() + 3);
      return plane;
    }
  }
  throw Error(facts::cli::NotAPlane{.text = text}, Location::place(option));
}

}  // namespace

Plane parse_plane(const std::string& text, const std::string& option) {
  const Plane plane = plane_from(text, option);
  if (plane.normal.isZero(0)) throw Error(facts::cli::ZeroNormal{}, Location::place(option));
  return plane;
}

std::array<Index, 2> index_pair(const std::string& text, const std::string& option) {
  const auto values = numbers<Index>(text, option, ':');
  if (values.size() != 2 || values[0] < 0 || values[1] < 0)
    throw Error(facts::cli::NotAPair{.text = text}, Location::place(option));
  return {values[0], values[1]};
}

UprightModels parse_upright(std::string_view text, const std::string& option) {
  const auto fail = [&]() { throw Error(facts::cli::NotUpright{.text = text}, Location::place(option)); };
  const auto orientation = [&](std::string_view model) {
    const std::size_t comma = model.find(',');
    if (comma == std::string_view::npos) fail();
    const auto up = axis_named(model.substr(0, comma)), front = axis_named(model.substr(comma + 1));
    if (!up || !front || up->cross(*front).isZero()) fail();
    return make_orientation(*up, *front);
  };
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) fail();
  return {orientation(text.substr(0, colon)), orientation(text.substr(colon + 1))};
}

std::string coordinate_text(double value, double size, int digits) {
  constexpr int most_digits = 17;
  const double larger = size > 0 ? std::abs(value) / size : 1;
  const double before = std::clamp(std::ceil(std::log10(larger)), 0.0, 1.0 * most_digits);
  return fmt::format("{:.{}g}", value, std::min(digits + static_cast<int>(before), most_digits));
}

}  // namespace meshgraft::cli
