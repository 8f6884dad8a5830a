#include "cancel_cases.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/deform/quick_frames.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/repair.h>
#include <meshgraft/samples/samples.h>

#include "mesh/refine.h"

namespace meshgraft::test {
namespace {

/// Returns a call that keeps its result alive, so that freeing it is not part of the call.
template <class Work>
CancellableCall call(Work work) {
  return [work = std::move(work)](const Context& context) -> std::shared_ptr<void> {
    using Result = decltype(work(context));
    return std::make_shared<Result>(work(context));
  };
}

int resolution(Index vertices) { return static_cast<int>(std::lround(std::sqrt(vertices))); }

Mesh sample(const char* name, Index vertices) { return make_sample(name, resolution(vertices)); }

/// A sheet with bumps whose border is fixed. Its handle, a disc in the middle, turns out of the plane.
struct Sheet {
  Points points;
  Triangles triangles;
  Region region;
  std::vector<HandlePose> poses;
};

Sheet make_sheet(Index vertices) {
  const Mesh mesh = sample("bumpy_plane", vertices);
  Sheet sheet{mesh.positions, triangulate(mesh).triangles, {}, {}};
  sheet.region.whole = true;
  Handle handle{.name = "disc"};
  const double edge = 1 / std::sqrt(vertices);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Eigen::RowVector3d p = mesh.positions.row(v);
    if (std::max(std::abs(p[0]), std::abs(p[1])) > 0.5 - 1.5 * edge)
      sheet.region.fixed.push_back(v);
    else if (std::hypot(p[0], p[1]) < 0.1)
      handle.vertices.push_back(v);
  }
  sheet.region.handles.push_back(std::move(handle));
  sheet.poses.push_back(make_pose({.translate = {0, 0, 0.2}, .axis = {1, 0, 0}, .angle_deg = 45}, {0, 0, 0}));
  return sheet;
}

std::vector<Index> all_vertices(Index count) {
  std::vector<Index> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

DeformerOptions options_of(DeformMethod method, SolverBackend backend = SolverBackend::automatic,
                           DegenerateTreatment treatment = DegenerateTreatment::apex) {
  DeformerOptions options;
  options.method = method;
  options.backend = backend;
  options.operators.degenerate = treatment;
  return options;
}

CancelCase set_up(std::string name, const DeformerOptions& options, Index most) {
  return {std::move(name),
          [options](Index vertices) {
            return call([sheet = make_sheet(vertices), options](const Context& context) {
              return Deformer(sheet.points, sheet.triangles, sheet.region, options, context);
            });
          },
          most};
}

/// A case whose input is a finished Deformer on the sheet.
template <class Work>
CancelCase after_set_up(std::string name, const DeformerOptions& options, Index most, Work work) {
  return {std::move(name),
          [options, work](Index vertices) {
            const auto sheet = std::make_shared<Sheet>(make_sheet(vertices));
            const auto deformer =
                std::make_shared<Deformer>(sheet->points, sheet->triangles, sheet->region, options);
            return call(
                [sheet, deformer, work](const Context& context) { return work(*deformer, *sheet, context); });
          },
          most};
}

CancelCase evaluation(std::string name, const DeformerOptions& options, Index most) {
  return after_set_up(std::move(name), options, most,
                      [](const Deformer& deformer, const Sheet& sheet, const Context& context) {
                        return deformer.evaluate(sheet.poses, context);
                      });
}

std::vector<CancelCase> deform_cases() {
  using enum DeformMethod;
  const DeformerOptions linear = options_of(ft05, SolverBackend::multifrontal, DegenerateTreatment::ft05_noise);
  // Above these sizes the factors do not fit a machine with 16 GB.
  constexpr Index most_direct = 250'000, most_direct_noise = 500'000, most_basis = 500'000;
  std::vector<CancelCase> cases{
      set_up("set-up, ft05", options_of(ft05, SolverBackend::multifrontal), most_direct),
      set_up("set-up, ft05-noise", linear, most_direct_noise),
      set_up("set-up, corotational", options_of(corotational, SolverBackend::multifrontal), most_direct),
      set_up("set-up, iterative", options_of(corotational, SolverBackend::iterative), 1'000'000),
      evaluation("evaluate, ft05", options_of(ft05, SolverBackend::multifrontal), most_direct),
      evaluation("evaluate, rotation-aware", options_of(rotation_aware, SolverBackend::multifrontal),
                 most_direct),
      evaluation("evaluate, corotational", options_of(corotational, SolverBackend::multifrontal), most_direct),
      evaluation("evaluate, iterative", options_of(corotational, SolverBackend::iterative), 1'000'000)};
  cases.push_back(after_set_up("handle basis", linear, most_basis,
                               [](const Deformer& deformer, const Sheet&, const Context& context) {
                                 return HandleBasis(deformer, {}, context);
                               }));
  cases.push_back(after_set_up("reduced frames", options_of(corotational, SolverBackend::multifrontal),
                               most_direct, [](const Deformer& deformer, const Sheet&, const Context& context) {
                                 return ReducedFrames(deformer, {}, context);
                               }));
  cases.push_back(after_set_up("another region", linear, most_direct_noise,
                               [](const Deformer& deformer, const Sheet& sheet, const Context& context) {
                                 Region region = sheet.region;
                                 region.handles[0].vertices.resize(region.handles[0].vertices.size() / 2);
                                 return deformer.with_region(region, context);
                               }));
  cases.push_back({"matrix without a mesh",
                   [linear](Index vertices) {
                     const Sheet sheet = make_sheet(vertices);
                     const Deformer deformer(sheet.points, sheet.triangles, sheet.region, linear);
                     return call([matrix = deformer.normal_matrix()](const Context& context) {
                       std::shared_ptr<LinearSolver> solver = make_solver(SolverBackend::multifrontal);
                       solver->analyse(matrix, {}, context);
                       return solver;
                     });
                   },
                   most_direct_noise});
  for (const Index proxy_vertices : {4'000, 32'000})
    cases.push_back({"proxy of " + std::to_string(proxy_vertices), [proxy_vertices](Index vertices) {
                       return call([sheet = make_sheet(vertices), proxy_vertices](const Context& context) {
                         ProxyOptions options;
                         options.vertices = proxy_vertices;
                         return ProxyDeformer(sheet.points, sheet.triangles, sheet.region, options, context);
                       });
                     }});
  cases.push_back({"quality", [](Index vertices) {
                     const Sheet sheet = make_sheet(vertices);
                     Points edited = sheet.points;
                     for (Index v = 0; v < edited.rows(); ++v) edited(v, 2) += 0.1 * std::sin(9 * edited(v, 0));
                     return call(
                         [rest = sheet.points, edited, triangles = sheet.triangles,
                          free = all_vertices(static_cast<Index>(edited.rows()))](const Context& context) {
                           return measure_quality({rest, edited, triangles, free}, {}, context);
                         });
                   }});
  return cases;
}

/// Returns the mesh with each triangle apart from its neighbours, as STL files have it.
Mesh apart(const Mesh& mesh) {
  const Triangles triangles = triangulate(mesh).triangles;
  Points points(triangles.size(), 3);
  Triangles own(triangles.rows(), 3);
  for (Index t = 0; t < triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) {
      own(t, k) = 3 * t + k;
      points.row(own(t, k)) = mesh.positions.row(triangles(t, k));
    }
  return make_mesh(points, own);
}

/// Returns the mesh without every 500th of its faces.
Mesh with_holes(const Mesh& mesh) {
  const Triangles triangles = triangulate(mesh).triangles;
  Triangles kept(triangles.rows(), 3);
  Index count = 0;
  for (Index t = 0; t < triangles.rows(); ++t)
    if (t % 500 != 250) kept.row(count++) = triangles.row(t);
  return make_mesh(mesh.positions, kept.topRows(count));
}

std::vector<CancelCase> mesh_cases() {
  std::vector<CancelCase> cases;
  const auto add = [&](std::string name, auto make, auto work) {
    cases.push_back(
        {std::move(name), [make, work](Index vertices) {
           return call([mesh = make(vertices), work](const Context& context) { return work(mesh, context); });
         }});
  };
  const auto sampled = [](const char* name) {
    return [name](Index vertices) { return sample(name, vertices); };
  };
  for (const char* name : {"octopus", "bracket", "bumpy_plane"})
    cases.push_back({std::string("sample ") + name, [name](Index vertices) {
                       return call([name, vertices](const Context& context) {
                         return make_sample(name, resolution(vertices), context);
                       });
                     }});
  add("check", sampled("knot"),
      [](const Mesh& mesh, const Context& context) { return check_mesh(mesh, context); });
  add("repair a clean mesh", sampled("knot"),
      [](const Mesh& mesh, const Context& context) { return repair(mesh, {}, context); });
  add(
      "repair triangles apart", [](Index vertices) { return apart(sample("knot", vertices / 6)); },
      [](const Mesh& mesh, const Context& context) { return repair(mesh, {}, context); });
  add(
      "fill many holes", [](Index vertices) { return with_holes(sample("knot", vertices)); },
      [](const Mesh& mesh, const Context& context) {
        RepairOptions options;
        options.hole_edges = 100;
        options.hole_fill = HoleFill::faired;
        return repair(mesh, options, context);
      });
  add("fill large holes", sampled("cylinder"), [](const Mesh& mesh, const Context& context) {
    RepairOptions options;
    options.hole_edges = 100'000;
    options.hole_fill = HoleFill::faired;
    return repair(mesh, options, context);
  });
  add("normals", sampled("knot"), [](const Mesh& mesh, const Context& context) {
    const Triangles triangles = triangulate(mesh).triangles;
    return vertex_normals(mesh.positions, triangles, vertex_triangles(mesh.vertex_count(), triangles, context),
                          context);
  });
  add("cut by a plane", sampled("knot"), [](const Mesh& mesh, const Context& context) {
    return cut_by_plane(mesh, {{0, 0, 0.5}, {0.1, 0.2, 1}}, {}, context);
  });
  add("cut along a loop", sampled("cylinder"), [](const Mesh& mesh, const Context& context) {
    std::vector<Index> loop;
    for (const double angle : {0.0, 2.0, 4.0}) {
      const Eigen::RowVector3d at(0.5 * std::cos(angle), 0.5 * std::sin(angle), 2 + 0.3 * std::cos(5 * angle));
      Index nearest = 0;
      (mesh.positions.rowwise() - at).rowwise().squaredNorm().minCoeff(&nearest);
      loop.push_back(nearest);
    }
    return cut_along_loop(mesh, loop, {}, context);
  });
  add(
      "refine", [](Index vertices) { return sample("knot", vertices / 4); },
      [](const Mesh& mesh, const Context& context) {
        return split_edges(mesh, [](Index, Index) { return true; }, context);
      });
  return cases;
}

Index foremost(const Mesh& mesh, const std::vector<Index>& loop) {
  return *std::max_element(loop.begin(), loop.end(),
                           [&](Index a, Index b) { return mesh.positions(a, 1) < mesh.positions(b, 1); });
}

std::vector<CancelCase> merge_cases() {
  struct Graft {
    Mesh target, source;
    std::vector<MergePair> pairs;
  };
  const auto graft = [](Index vertices) {
    Graft result{sample("bust", vertices / 2), sample("head", vertices / 2), {}};
    result.source.positions.col(2).array() += 0.15;
    const LoopPair loops{boundary_loops(result.source).front(), boundary_loops(result.target).front()};
    // Coarse loops fit from several starts, so one is given.
    result.pairs = {{loops, {{foremost(result.source, loops.source), foremost(result.target, loops.target)}}}};
    return result;
  };
  std::vector<CancelCase> cases;
  cases.push_back({"merge",
                   [graft](Index vertices) {
                     return call([g = graft(vertices)](const Context& context) {
                       return merge_meshes(g.target, g.source, g.pairs, {}, context);
                     });
                   },
                   500'000});
  cases.push_back({"drop",
                   [](Index vertices) {
                     const auto target = std::make_shared<Mesh>(sample("knot", vertices / 2));
                     auto source = std::make_shared<Mesh>(sample("head", vertices / 2));
                     source->positions *= 0.1;
                     Index top = 0;
                     target->positions.col(2).maxCoeff(&top);
                     return call([target, source, top](const Context& context) {
                       Drop drop;
                       drop.surface_point = top;
                       drop.source_loop = boundary_loops(*source).front();
                       return drop_source(*target, *source, drop, {}, context);
                     });
                   },
                   500'000});
  return cases;
}

/// A folder that is deleted with its files.
class Folder {
 public:
  Folder() : path_(std::filesystem::temp_directory_path() / ("meshgraft-cancel-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Returns whether this build can write the file's format; 3MF is optional.
bool is_known_format(const std::filesystem::path& path) {
  try {
    require_mesh_format(path);
    return true;
  } catch (const Error&) {
    return false;
  }
}

std::vector<CancelCase> file_cases() {
  const auto folder = std::make_shared<Folder>();
  std::vector<CancelCase> cases;
  for (const char* extension : {"ply", "obj", "off", "stl", "glb", "gltf", "3mf"}) {
    const std::filesystem::path path = *folder / (std::string("mesh.") + extension);
    if (!is_known_format(path)) continue;
    cases.push_back({std::string("write ") + extension, [folder, path](Index vertices) {
                       return call([folder, path, mesh = sample("knot", vertices)](const Context& context) {
                         return write_mesh(mesh, path, {}, context);
                       });
                     }});
    cases.push_back({std::string("read ") + extension, [folder, path](Index vertices) {
                       write_mesh(sample("knot", vertices), path);
                       return call([folder, path](const Context& context) { return read_mesh(path, context); });
                     }});
    cases.push_back({std::string("write again ") + extension, [folder, path](Index vertices) {
                       write_mesh(sample("knot", vertices), path);
                       Mesh mesh = read_mesh(path);
                       mesh.positions *= 1.1;
                       const std::filesystem::path other =
                           path.parent_path() / ("other" + path.extension().string());
                       return call([folder, other, mesh = std::move(mesh)](const Context& context) {
                         return write_mesh(mesh, other, {}, context);
                       });
                     }});
  }
  return cases;
}

}  // namespace

std::vector<CancelCase> cancel_cases() {
  std::vector<CancelCase> cases;
  for (auto of_layer : {mesh_cases, file_cases, deform_cases, merge_cases})
    for (CancelCase& each : of_layer()) cases.push_back(std::move(each));
  return cases;
}

}  // namespace meshgraft::test
