// Times the reading and writing of files, beside established readers of the same files in the same run:
//
//   meshgraft_io_bench [--resolution=1000] [--peak_memory] [Google Benchmark's own flags]
//
// The files hold a torus of resolution² vertices and twice as many triangles. They lie in a temporary folder,
// which is removed at the end, and stay in the disk cache. --peak_memory measures, instead of times, by how
// much one reading raises the peak memory of a fresh process.

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <benchmark/benchmark.h>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/samples/samples.h>

#include "other_readers.h"

namespace meshgraft::bench {
namespace {

namespace fs = std::filesystem;

/// A temporary folder for the files; removed on destruction.
class Folder {
 public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "meshgraft-bench-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
    path_ = pattern;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  fs::path operator/(std::string_view name) const { return path_ / name; }

 private:
  fs::path path_;
};

// Returns a torus whose coordinates have six decimals, as programs write them.
Mesh make_torus(int resolution) {
  Mesh mesh = make_sample("torus", resolution);
  mesh.positions = (mesh.positions.array() * 1e6).round() / 1e6;
  mesh.attributes.clear();
  return mesh;
}

Mesh with_normals_and_uvs(Mesh mesh) {
  const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
  Attribute normal{.name = "normal",
                   .interpolation = Interpolation::direction,
                   .type = ScalarType::float32,
                   .components = 3};
  Attribute uv{.name = "uv", .type = ScalarType::float32, .components = 2};
  for (const auto p : mesh.positions.rowwise()) {
    const double around = std::hypot(p[0], p[1]);
    const Eigen::Vector3d n =
        Eigen::Vector3d(p[0] * (1 - 1 / around), p[1] * (1 - 1 / around), p[2]).normalized();
    for (const double value : n) normal.values.push_back(rounded(value));
    uv.values.push_back(rounded(std::atan2(p[1], p[0]) / 7 + 0.5));
    uv.values.push_back(rounded(std::atan2(p[2], around - 1) / 7 + 0.5));
  }
  mesh.attributes = {std::move(normal), std::move(uv)};
  return mesh;
}

// Writes a binary PLY of floats, as scanners and other programs do, because meshgraft composes doubles.
void write_float_ply(const Mesh& mesh, const fs::path& path) {
  static_assert(std::endian::native == std::endian::little);
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                     std::to_string(mesh.vertex_count()) +
                     "\nproperty float x\nproperty float y\nproperty float z\n";
  const bool has_normals = !mesh.attributes.empty();
  if (has_normals) text += "property float nx\nproperty float ny\nproperty float nz\n";
  text += "element face " + std::to_string(mesh.face_count()) +
          "\nproperty list uchar int vertex_indices\nend_header\n";
  const auto put = [&](const auto value) {
    const auto bytes = std::bit_cast<std::array<char, sizeof value>>(value);
    text.append(bytes.data(), bytes.size());
  };
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    for (int axis = 0; axis < 3; ++axis) put(static_cast<float>(mesh.positions(v, axis)));
    for (std::size_t axis = 0; has_normals && axis < 3; ++axis)
      put(static_cast<float>(mesh.attributes[0].values[3 * static_cast<std::size_t>(v) + axis]));
  }
  for (Index f = 0; f < mesh.face_count(); ++f) {
    text += static_cast<char>(mesh.faces[f].size());
    for (const Index corner : mesh.faces[f]) put(corner);
  }
  std::ofstream(path, std::ios::binary) << text;
}

void make_files(const Folder& folder, int resolution) {
  const Mesh plain = make_torus(resolution);
  const Mesh full = with_normals_and_uvs(plain);
  write_float_ply(plain, folder / "plain.ply");
  write_float_ply(full, folder / "normals.ply");
  write_mesh(plain, folder / "plain.stl");
  write_mesh(plain, folder / "plain.obj");
  write_mesh(full, folder / "full.obj");
  write_mesh(plain, folder / "plain.off");
}

constexpr std::array<std::string_view, 6> file_names = {"plain.ply", "normals.ply", "plain.stl",
                                                        "plain.obj", "full.obj",    "plain.off"};

struct Reader {
  std::string_view name;
  std::size_t (*read)(const fs::path& path);  ///< returns the number of faces; 0 for an unknown format
};

std::size_t read_by_meshgraft(const fs::path& path) {
  return static_cast<std::size_t>(read_mesh(path).face_count());
}
std::size_t read_by_one_thread(const fs::path& path) {
  return static_cast<std::size_t>(read_mesh(path, {.threads = 1}).face_count());
}

constexpr std::array<Reader, 5> readers = {{{"meshgraft", read_by_meshgraft},
                                            {"meshgraft_1_thread", read_by_one_thread},
                                            {"CGAL", read_by_cgal},
                                            {"assimp", read_by_assimp},
                                            {"tinyobjloader", read_by_tinyobj}}};

bool knows(const Reader& reader, std::string_view file) {
  return reader.name != "tinyobjloader" || file.ends_with(".obj");
}

void register_reading(const Folder& folder) {
  for (const std::string_view file : file_names) {
    for (const Reader& reader : readers) {
      if (!knows(reader, file)) continue;
      const fs::path path = folder / file;
      const auto body = [path, read = reader.read](benchmark::State& state) {
        for ([[maybe_unused]] auto iteration : state) {
          if (read(path) == 0) return state.SkipWithError("not read");
        }
        state.SetBytesProcessed(static_cast<std::int64_t>(fs::file_size(path)) *
                                static_cast<std::int64_t>(state.iterations()));
      };
      const std::string name = "read/" + std::string(file) + "/" + std::string(reader.name);
      benchmark::RegisterBenchmark(name.c_str(), body)->UseRealTime()->Unit(benchmark::kMillisecond);
    }
  }
}

// The times include flushing to the disk, because users' files are written so.
void register_writing(const Folder& folder) {
  for (const std::string_view file : file_names) {
    for (const bool edited : {true, false}) {
      const fs::path path = folder / file;
      const fs::path out = folder / ("out" + path.extension().string());
      const auto body = [path, out, edited](benchmark::State& state) {
        Mesh mesh = read_mesh(path);
        mesh.positions.topRows(mesh.vertex_count() / 10).array() += 0.125;
        if (!edited) mesh.source = nullptr;
        for ([[maybe_unused]] auto iteration : state) write_mesh(mesh, out);
        state.SetBytesProcessed(static_cast<std::int64_t>(fs::file_size(out)) *
                                static_cast<std::int64_t>(state.iterations()));
      };
      const std::string name = "write/" + std::string(file) + (edited ? "/edited" : "/composed");
      benchmark::RegisterBenchmark(name.c_str(), body)->UseRealTime()->Unit(benchmark::kMillisecond);
    }
  }
}

// Returns a value of /proc/self/status in MB: "VmHWM" is the peak, "VmRSS" the present use.
double memory(std::string_view key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(key)) return std::strtod(line.c_str() + key.size() + 1, nullptr) * 1024 / 1e6;
  return 0;
}

void in_child(const std::function<void()>& body) {
  std::fflush(stdout);
  const pid_t child = ::fork();
  if (child == 0) {
    body();
    std::fflush(stdout);
    ::_exit(0);
  }
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, 0) != child || status != 0)
    throw std::runtime_error("a child failed");
}

double megabytes_of(const Mesh& mesh) {
  double bytes = 24.0 * mesh.vertex_count() + 4.0 * mesh.faces.corner_count() + 4.0 * mesh.face_count();
  for (const Attribute& attribute : mesh.attributes)
    bytes += 8.0 * static_cast<double>(attribute.values.size());
  return bytes / 1e6;
}

void report_peak_memory(const Folder& folder) {
  std::printf("%-12s %-20s %9s %9s %9s\n", "file", "reader", "file MB", "mesh MB", "peak MB");
  for (const std::string_view file : file_names) {
    const fs::path path = folder / file;
    for (const Reader& reader : readers) {
      if (!knows(reader, file)) continue;
      in_child([&] {
        const double before = memory("VmRSS:");
        if (reader.read(path) == 0) throw std::runtime_error("not read");
        const double peak = memory("VmHWM:") - before;
        const double mesh = megabytes_of(read_mesh(path));
        std::printf("%-12s %-20s %9.1f %9.1f %9.1f\n", path.filename().c_str(),
                    std::string(reader.name).c_str(), static_cast<double>(fs::file_size(path)) / 1e6, mesh,
                    peak);
      });
    }
  }
}

// Takes a flag of our own out of the arguments; the rest is Google Benchmark's.
std::string take_flag(int& argc, char** argv, std::string_view flag, std::string value) {
  char** const end = std::remove_if(argv + 1, argv + argc, [&](const char* argument) {
    if (!std::string_view(argument).starts_with(flag)) return false;
    value = argument + flag.size();
    return true;
  });
  argc = static_cast<int>(end - argv);
  return value;
}

int run(int argc, char** argv) {
  const int resolution = std::atoi(take_flag(argc, argv, "--resolution=", "1000").c_str());
  const bool peak_memory = take_flag(argc, argv, "--peak_memory", "off").empty();
  const Folder folder;
  in_child([&] { make_files(folder, resolution); });
  if (peak_memory) {
    report_peak_memory(folder);
    return 0;
  }
  register_reading(folder);
  register_writing(folder);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

}  // namespace
}  // namespace meshgraft::bench

int main(int argc, char** argv) { return meshgraft::bench::run(argc, argv); }
