// Reading keeps to its memory budget, in every format.
#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "expect_error.h"
#include "io/number_text.h"
#include "ply_files.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

namespace fs = std::filesystem;

/// A wavy sheet of side² vertices, in coordinates of four digits.
Mesh sheet(int side) {
  Points points(Eigen::Index{side} * side, 3);
  Triangles triangles(Eigen::Index{2} * (side - 1) * (side - 1), 3);
  Eigen::Index t = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const int v = y * side + x;
      points.row(v) << x, y, std::round(1e3 * std::sin(0.1 * x) * std::cos(0.07 * y)) / 1e3;
      if (x + 1 == side || y + 1 == side) continue;
      triangles.row(t++) << v, v + 1, v + side + 1;
      triangles.row(t++) << v, v + side + 1, v + side;
    }
  return make_mesh(points, triangles);
}

Attribute attribute(std::string name, Domain domain, ScalarType type, int components, Index count, int period) {
  Attribute made{.name = std::move(name), .domain = domain, .type = type, .components = components};
  made.values.resize(static_cast<std::size_t>(count) * static_cast<std::size_t>(components));
  for (std::size_t k = 0; k < made.values.size(); ++k)
    made.values[k] =
        static_cast<double>(k / static_cast<std::size_t>(components) % static_cast<std::size_t>(period));
  return made;
}

Mesh with(Mesh mesh, std::vector<Attribute> attributes) {
  mesh.attributes = std::move(attributes);
  return mesh;
}

Mesh with_normals_and_uvs(const Mesh& mesh) {
  return with(mesh, {attribute("normal", Domain::vertex, ScalarType::float32, 3, mesh.vertex_count(), 2),
                     attribute("uv", Domain::corner, ScalarType::float32, 2, mesh.faces.corner_count(), 5)});
}

Mesh with_labels(const Mesh& mesh) {
  Attribute object = attribute("object", Domain::face, ScalarType::int32, 1, mesh.face_count(), 2);
  object.interpolation = Interpolation::nearest;
  object.labels = {"left", "right"};
  Attribute material = object;
  material.name = "material";
  return with(mesh, {object, material});
}

/// A PLY of vertices with `properties` bytes each, which become doubles.
std::string ply_of_bytes(const Mesh& mesh, int properties) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                     std::to_string(mesh.vertex_count()) +
                     "\nproperty float x\nproperty float y\nproperty float z\n";
  for (int k = 0; k < properties; ++k) text += "property uchar q" + std::to_string(k) + "\n";
  text += "end_header\n";
  Bytes bytes(false);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    for (int axis = 0; axis < 3; ++axis) bytes.put(static_cast<float>(mesh.positions(v, axis)));
    for (int k = 0; k < properties; ++k) bytes.put(static_cast<std::uint8_t>(k));
  }
  return text + bytes.text();
}

/// A PLY of triangle strips in rows.
std::string ply_of_strips(const Mesh& mesh, int side) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(mesh.vertex_count()) +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement tristrips " +
                     std::to_string(side - 1) + "\nproperty list int int vertex_indices\nend_header\n";
  for (const auto& p : mesh.positions.rowwise())
    text += std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
  for (int y = 0; y + 1 < side; ++y) {
    text += std::to_string(2 * side);
    for (int x = 0; x < side; ++x)
      text += " " + std::to_string(y * side + x) + " " + std::to_string((y + 1) * side + x);
    text += "\n";
  }
  return text;
}

std::string ascii_stl(const Mesh& mesh) {
  std::string text = "solid a\n";
  for (Index f = 0; f < mesh.face_count(); ++f) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const Index v : mesh.faces[f])
      text += "vertex " + std::to_string(mesh.positions(v, 0)) + " " + std::to_string(mesh.positions(v, 1)) +
              " " + std::to_string(mesh.positions(v, 2)) + "\n";
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid a\n";
}

/// Returns `text` so often as it takes to fill about `bytes`.
std::string repeated(std::string_view text, std::size_t bytes) {
  std::string many;
  while (many.size() < bytes) many += text;
  return many;
}

/// A glTF file of many small values: an array in its extras, and nodes that show nothing.
std::string gltf_of_values(std::size_t bytes) {
  return R"({"asset": {"version": "2.0"}, "nodes": [{}])" + (", \"extras\": [0" + repeated(",0", bytes)) +
         "], \"materials\": [{}" + repeated(",{}", bytes / 8) + "]}";
}

std::string obj_of_groups(std::size_t count) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (std::size_t k = 0; k < count; ++k) text += "g " + std::to_string(k) + "\n";
  return text + "f 1 2 3\n";
}

/// Writes files of all formats, with a mesh of side² vertices or about as much of something else.
std::vector<fs::path> files_of_all_formats(const TemporaryFolder& folder, int side) {
  const Mesh plain = sheet(side), full = with_normals_and_uvs(plain), labelled = with_labels(plain);
  const auto count = static_cast<std::size_t>(plain.vertex_count());
  std::vector<fs::path> files;
  const auto written = [&](const Mesh& mesh, const char* name) {
    write_mesh(mesh, folder / name);
    files.push_back(folder / name);
  };
  written(plain, "plain.ply");
  written(full, "full.ply");
  files.push_back(folder.file("bytes.ply", ply_of_bytes(plain, 16)));
  files.push_back(folder.file("strips.ply", ply_of_strips(plain, side)));
  files.push_back(folder.file("comments.ply", "ply\nformat ascii 1.0\n" + repeated("comment x\n", 8 * count) +
                                                  "element vertex 1\nproperty float x\nproperty float y\n"
                                                  "property float z\nend_header\n0 0 0\n"));
  written(plain, "plain.obj");
  written(full, "full.obj");
  written(with(plain, {attribute("colour", Domain::vertex, ScalarType::float32, 3, plain.vertex_count(), 2)}),
          "colours.obj");
  files.push_back(folder.file("groups.obj", obj_of_groups(count)));
  written(plain, "plain.off");
  written(with(plain, {attribute("colour", Domain::face, ScalarType::uint8, 3, plain.face_count(), 200)}),
          "colours.off");
  written(plain, "plain.stl");
  written(with(plain, {attribute("attribute", Domain::face, ScalarType::uint16, 1, plain.face_count(), 200)}),
          "attributes.stl");
  files.push_back(folder.file("ascii.stl", ascii_stl(plain)));
  written(plain, "plain.glb");
  written(full, "full.glb");
  written(labelled, "labelled.gltf");
  files.push_back(folder.file("values.gltf", gltf_of_values(8 * count)));
#ifdef MESHGRAFT_HAS_3MF
  written(plain, "plain.3mf");
  written(labelled, "labelled.3mf");
  written(with(plain, {attribute("colour", Domain::face, ScalarType::uint8, 3, plain.face_count(), 200)}),
          "colours.3mf");
#endif
  return files;
}

Context with_memory(std::uint64_t bytes) {
  Context context{.threads = 1};
  context.memory = bytes;
  return context;
}

/// Returns the largest number below which `fails` holds, for one that fails at `low` and not at `high`.
std::uint64_t threshold(std::uint64_t low, std::uint64_t high, double precision,
                        const std::function<bool(std::uint64_t)>& fails) {
  while (static_cast<double>(high) > precision * static_cast<double>(low) && high - low > 1) {
    const std::uint64_t middle = low + (high - low) / 2;
    (fails(middle) ? low : high) = middle;
  }
  return high;
}

bool is_refused(const fs::path& path, std::uint64_t memory) {
  try {
    read_mesh(path, with_memory(memory));
    return false;
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), "core.over_budget") << error.what();
    EXPECT_NE(std::string(error.what()).find(path.filename().string()), std::string::npos) << error.what();
    return true;
  }
}

void expect_same(const Mesh& a, const Mesh& b, const fs::path& path) {
  EXPECT_TRUE(a.positions == b.positions) << path;
  EXPECT_TRUE(a.faces == b.faces) << path;
  ASSERT_EQ(a.attributes.size(), b.attributes.size()) << path;
  for (std::size_t k = 0; k < a.attributes.size(); ++k) {
    EXPECT_EQ(a.attributes[k].name, b.attributes[k].name) << path;
    EXPECT_TRUE(std::ranges::equal(a.attributes[k].values, b.attributes[k].values, io::same_value)) << path;
  }
}

/// Returns the bytes that a mesh takes without its file.
std::uint64_t bytes_of(const Mesh& mesh) {
  std::uint64_t bytes = sizeof(double) * static_cast<std::uint64_t>(mesh.positions.size()) +
                        sizeof(Index) * (mesh.faces.offsets().size() + mesh.faces.corners().size());
  for (const Attribute& a : mesh.attributes) bytes += sizeof(double) * a.values.size();
  return bytes;
}

TEST(MemoryBudget, OneByteDecidesAndNothingElseChanges) {
  const TemporaryFolder folder;
  for (const fs::path& path : files_of_all_formats(folder, 12)) {
    const Mesh mesh = read_mesh(path);
    const std::uint64_t file = fs::file_size(path);
    const std::uint64_t least = threshold(file - 1, std::uint64_t{1} << 30, 1,
                                          [&](std::uint64_t memory) { return is_refused(path, memory); });
    EXPECT_GE(least, file + bytes_of(mesh)) << path;
    EXPECT_TRUE(is_refused(path, least - 1)) << path;
    expect_same(read_mesh(path, with_memory(least)), mesh, path);
  }
}

TEST(MemoryBudget, CountsTheDoublesThatBytesBecome) {
  const TemporaryFolder folder;
  const Mesh plain = sheet(60);
  const auto path = folder.file("bytes.ply", ply_of_bytes(plain, 100));
  const std::uint64_t in_the_file = 112 * 3600, in_the_mesh = 103 * 8 * 3600;
  EXPECT_TRUE(is_refused(path, in_the_file + in_the_mesh));
  EXPECT_FALSE(is_refused(path, (in_the_file + in_the_mesh) / 10 * 11));
}

#if defined(__GLIBC__) && !defined(MESHGRAFT_SANITIZES_ADDRESSES) && !defined(MESHGRAFT_SANITIZES_THREADS)

/// Returns a value of this process in bytes: "VmHWM" is the peak of its memory, "VmRSS" the present use.
std::uint64_t memory_of_process(std::string_view key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(key)) return 1024 * std::strtoull(line.c_str() + key.size() + 1, nullptr, 10);
  return 0;
}

struct Attempt {
  bool refused = false, failed = true;
  std::uint64_t peak = 0;  ///< what reading added to the process's memory
};

/// Reads a file in a process of its own, because the peak of a process never sinks.
Attempt attempt(const fs::path& path, std::uint64_t memory) {
  Attempt result;
  int ends[2];
  if (::pipe(ends) != 0) return result;
  ::malloc_trim(0);  // the child would fill the memory that this process has freed
  const pid_t child = ::fork();
  if (child == 0) {
    Attempt made{.failed = false};
    const std::uint64_t before = memory_of_process("VmRSS");
    try {
      read_mesh(path, with_memory(memory));
    } catch (const Error& error) {
      made.refused = error.id() == "core.over_budget";
      made.failed = !made.refused;
    }
    made.peak = memory_of_process("VmHWM") - before;
    const bool told = ::write(ends[1], &made, sizeof made) == sizeof made;
    ::_exit(told ? 0 : 1);
  }
  ::close(ends[1]);
  if (child < 0 || ::read(ends[0], &result, sizeof result) != sizeof result) result = {};
  ::close(ends[0]);
  if (child > 0) ::waitpid(child, nullptr, 0);
  return result;
}

TEST(MemoryBudget, HoldsForTheMemoryOfTheProcess) {
  constexpr double own = 4e6;  // of the program and of the allocator, at any size of the mesh
  const TemporaryFolder folder;
  for (const fs::path& path : files_of_all_formats(folder, 250)) {
    const auto fails = [&](std::uint64_t memory) {
      const Attempt made = attempt(path, memory);
      EXPECT_FALSE(made.failed) << path;
      EXPECT_LT(static_cast<double>(made.peak), 1.3 * static_cast<double>(memory) + own)
          << path << " with " << memory << (made.refused ? ", refused" : "");
      return made.refused;
    };
    const std::uint64_t file = fs::file_size(path);
    const std::uint64_t least = threshold(file - 1, 64 * file, 1.2, fails);
    EXPECT_GT(static_cast<double>(attempt(path, least).peak), 0.4 * static_cast<double>(least)) << path;
  }
}

#endif

}  // namespace
}  // namespace meshgraft::test
