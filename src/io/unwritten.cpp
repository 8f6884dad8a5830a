#include "unwritten.h"

#include <algorithm>
#include <cmath>

#include "obj_materials.h"

namespace meshgraft::io {

void note_unwritten(const Mesh& mesh, std::string_view format, std::initializer_list<const Attribute*> written,
                    std::vector<std::string>& notes) {
  std::string names;
  for (const Attribute& attribute : mesh.attributes) {
    if (std::ranges::find(written, &attribute) != written.end()) continue;
    if (std::ranges::all_of(attribute.values, [](double value) { return std::isnan(value); })) continue;
    names += (names.empty() ? "'" : ", '") + attribute.name + "'";
  }
  if (!names.empty())
    notes.push_back(std::string(format) + " has no place for " + names + "; a PLY file keeps it");
  for (const std::string& library : material_libraries_of(mesh))
    notes.push_back(std::string(format) + " has no place for the materials that " + library + " defines");
}

}  // namespace meshgraft::io
