#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/samples/samples.h>

#include "io/file.h"
#include "io/temporary_folder.h"
#include "page_client.h"

/// Helpers of tests that open and edit a bar through the editor's socket.
namespace meshgraft::test {

inline const Json turn = {{"rotate", {{"axis", {1, 0, 0}}, {"angle_deg", 40}}}, {"translate", {0.1, 0, 0}}};
inline const Json open_bar = {{"do", "open"}, {"sample", "bar"}, {"resolution", 20}};

/// Makes a handle of the bar's upper end.
inline Json paint_top(Page& page, const std::string& name = "top") {
  const std::vector<int> top = page.vertices([](double, double, double z) { return z > 3.7; });
  return page.ask({{"do", "paint-handle"}, {"vertices", top}, {"name", name}, {"reach", 2.0}});
}

inline Json pose_top(Page& page) { return page.ask({{"do", "pose"}, {"poses", {{"top", turn}}}}); }

/// Returns the coordinates that the page shows for these positions, 3 floats a vertex.
inline std::vector<float> as_shown(const Points& positions, const std::vector<double>& offset) {
  std::vector<float> numbers;
  for (Eigen::Index v = 0; v < positions.rows(); ++v)
    for (int k = 0; k < 3; ++k)
      numbers.push_back(static_cast<float>(positions(v, k) - offset[static_cast<std::size_t>(k)]));
  return numbers;
}

inline std::string saved(Page& page, const std::filesystem::path& file) {
  page.ask({{"do", "save"}, {"edit", file.string()}, {"overwrite", true}});
  return read_file(file);
}

inline std::filesystem::path bar_file(const TemporaryFolder& folder, const char* name = "bar.ply") {
  write_mesh(make_sample("bar", 16), folder / name);
  return folder / name;
}

}  // namespace meshgraft::test
