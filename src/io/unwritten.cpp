#include "unwritten.h"

#include <algorithm>
#include <cmath>

#include "io/facts.h"
#include "mesh/box_diagonal.h"
#include "obj/materials.h"

namespace meshgraft::io {

namespace {

// Returns the attribute's name. If other attributes share it, the domain stands before it.
std::string name_of(const Attribute& attribute, const Mesh& mesh) {
  if (std::ranges::count(mesh.attributes, attribute.name, &Attribute::name) == 1) return attribute.name;
  switch (attribute.domain) {
    case Domain::vertex: return "vertex " + attribute.name;
    case Domain::face: return "face " + attribute.name;
    case Domain::corner: break;
  }
  return "corner " + attribute.name;
}

}  // namespace

void note_unwritten(const Mesh& mesh, std::string_view format, std::initializer_list<const Attribute*> written,
                    std::vector<Note>& notes) {
  std::vector<std::string> names;
  for (const Attribute& attribute : mesh.attributes) {
    if (std::ranges::find(written, &attribute) != written.end()) continue;
    if (std::ranges::all_of(attribute.values, [](double value) { return std::isnan(value); })) continue;
    names.push_back(name_of(attribute, mesh));
  }
  if (!names.empty()) notes.push_back(facts::io::AttributesLeftOut{.format = format, .attributes = names});
  for (const std::string& library : material_libraries_of(mesh))
    notes.push_back(facts::io::MaterialsLeftOut{.format = format, .library = library});
}

bool note_coarse_coordinates(const Mesh& mesh, std::string_view format, std::vector<Note>& notes) {
  constexpr double coarse_rel = 5e-6;
  double error = 0;
  for (const double value : mesh.positions.reshaped<Eigen::RowMajor>())
    if (std::isfinite(value))
      error = std::max(error, std::abs(value - static_cast<double>(static_cast<float>(value))));
  const double size = box_diagonal(mesh.positions);
  if (!(error > coarse_rel * size)) return false;
  notes.push_back(facts::io::CoordinatesCoarse{
      .format = std::string(format), .error = error, .error_rel = size > 0 ? error / size : 1});
  return true;
}

}  // namespace meshgraft::io
