#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "support/paths.h"

namespace meshgraft::test {

struct Outcome {
  int status = -1;
  std::string out, err;
};

inline std::string read_text(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// Runs the built program in a folder of its own, with a flat sheet and an edit of it.
class CommandLine : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() / (std::string("meshgraft_cli_") + test->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    write("sheet.obj", sheet());
    write("edit.json", edit());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static std::string sheet() {
    std::string text = "# a sheet\n";
    const int side = 8;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        text += "v " + std::to_string(x) + " " + std::to_string(y) + " " + (((x + y) % 3) == 0 ? "0.2" : "0") +
                "\n";
    text += "g sheet\n";
    for (int y = 0; y + 1 < side; ++y)
      for (int x = 0; x + 1 < side; ++x) {
        const int v = y * side + x + 1;
        text += "f " + std::to_string(v) + " " + std::to_string(v + 1) + " " + std::to_string(v + side + 1) +
                " " + std::to_string(v + side) + "\n";
      }
    return text;
  }

  static std::string edit(const std::string& handle_more = "") {
    return R"({"format": "meshgraft-edit", "version": 2, "inputs": {"sheet": {"file": "sheet.obj"}},
      "steps": [{"kind": "deform", "mesh": "sheet",
        "fixed": {"half_space": {"point": [0, 1.5, 0], "normal": [0, -1, 0]}},
        "handles": [{"name": "edge", "select": {"half_space": {"point": [0, 5.5, 0], "normal": [0, 1, 0]}},
                     "pose": {"translate": [0, 0, 2]})" +
           handle_more + "}]}]}";
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  Outcome run(const std::string& arguments, const std::string& before = "") const {
    const std::string command = "cd '" + folder_.string() + "' && " + before + "'" + program() + "' " +
                                arguments + " > .out 2> .err < /dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_text(folder_ / ".out"),
            read_text(folder_ / ".err")};
  }

  // Returns the names in the folder, without the files that the fixture put there.
  std::vector<std::string> new_files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      if (name != ".out" && name != ".err" && name != "sheet.obj" && name != "edit.json") names.push_back(name);
    }
    return names;
  }

  std::filesystem::path folder_;
};

// Returns the OBJ text of a tube with a lid, or of one upside down. Its rim is the vertices 0 to 11. Faces
// have UVs and the material "skin".
inline std::string tube(double bottom, bool upside_down, const std::string& library) {
  constexpr int around = 12, rings = 6;
  std::string text = library.empty() ? "" : "mtllib " + library + "\n";
  const double sign = upside_down ? -1 : 1;
  for (int k = 0; k < rings; ++k)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * 3.14159265358979 * i / around;
      text += "v " + std::to_string(std::cos(angle)) + " " + std::to_string(sign * std::sin(angle)) + " " +
              std::to_string(bottom + sign * k * 0.5) + "\n";
    }
  text += "v 0 0 " + std::to_string(bottom + sign * (rings - 1) * 0.5) + "\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
  if (!library.empty()) text += "usemtl skin\n";
  const auto corner = [](int v, int uv) { return " " + std::to_string(v + 1) + "/" + std::to_string(uv); };
  for (int k = 0; k + 1 < rings; ++k)
    for (int i = 0; i < around; ++i) {
      const int a = k * around + i, b = k * around + (i + 1) % around;
      text += "f" + corner(a, 1) + corner(b, 2) + corner(b + around, 3) + corner(a + around, 4) + "\n";
    }
  for (int i = 0; i < around; ++i)
    text += "f" + corner((rings - 1) * around + i, 1) + corner((rings - 1) * around + (i + 1) % around, 2) +
            corner(rings * around, 3) + "\n";
  return text;
}

}  // namespace meshgraft::test
