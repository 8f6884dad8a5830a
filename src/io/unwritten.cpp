#include "unwritten.h"

#include <algorithm>
#include <cmath>

#include "obj/materials.h"

namespace meshgraft::io {

namespace {

// Returns the name in quotes. If other attributes share the name, the domain is added.
std::string name_of(const Attribute& attribute, const Mesh& mesh) {
  std::string name = "'" + attribute.name + "'";
  if (std::ranges::count(mesh.attributes, attribute.name, &Attribute::name) == 1) return name;
  switch (attribute.domain) {
    case Domain::vertex: return name + " of the vertices";
    case Domain::face: return name + " of the faces";
    case Domain::corner: break;
  }
  return name + " of the corners";
}

}  // namespace

void note_unwritten(const Mesh& mesh, std::string_view format, std::initializer_list<const Attribute*> written,
                    std::vector<std::string>& notes) {
  std::string names;
  for (const Attribute& attribute : mesh.attributes) {
    if (std::ranges::find(written, &attribute) != written.end()) continue;
    if (std::ranges::all_of(attribute.values, [](double value) { return std::isnan(value); })) continue;
    names += (names.empty() ? "" : ", ") + name_of(attribute, mesh);
  }
  if (!names.empty())
    notes.push_back(std::string(format) + " has no place for " + names + "; a PLY file keeps it");
  for (const std::string& library : material_libraries_of(mesh))
    notes.push_back(std::string(format) + " has no place for the materials that " + library + " defines");
}

}  // namespace meshgraft::io
