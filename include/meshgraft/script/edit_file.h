#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/handle.h>
#include <meshgraft/deform/selection.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/merge/pose_source.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A vertex set as an edit file writes it. Unlike `Selection` it may refer to other selections by name, to
/// files, and to what an earlier step produced; running the step replaces those by what they stand for.
struct SelectionSpec {
  using Child = std::shared_ptr<const SelectionSpec>;
  enum class SelPart { fixed, free, handle };

  struct Named {
    std::string name;
  };  ///< an entry of `EditFile::selections`
  struct IndexFile {
    std::string file;
  };  ///< one vertex index per line
  struct SelFile {
    std::string file;
    SelPart take = SelPart::handle;
  };  ///< a part of a `.sel` file
  struct Produced {
    std::string step, what;
  };  ///< e.g. the loop that a cut made; docs/edit-file.md lists what steps produce
  struct Grow {
    Child of;
    int rings = 0;
  };
  struct GrowLength {
    Child of;
    double length = 0;
  };
  struct Union {
    std::vector<SelectionSpec> of;
  };
  struct Minus {
    std::vector<SelectionSpec> of;
  };
  struct Intersect {
    std::vector<SelectionSpec> of;
  };
  struct Mirror {
    Child of;
    Eigen::Vector3d point, normal;
    double tolerance_rel = 1e-3;
  };
  struct Rim {
    Child of;
    int rings = 1;
  };

  using Kind =
      std::variant<Selection::All, Selection::Indices, Selection::Box, Selection::Sphere, Selection::HalfSpace,
                   Selection::Component, Selection::Loop, Selection::NearestVertex, Selection::Path, Named,
                   IndexFile, SelFile, Produced, Grow, GrowLength, Union, Minus, Intersect, Mirror, Rim>;
  Kind kind = Selection::All{};
};

struct NamedSelection {
  std::string name;
  SelectionSpec selection;
  std::string colour{};  ///< to draw it in, "#rrggbb"; empty: none
};

/// A mesh that an edit starts from: a file or a built-in sample.
struct EditInput {
  std::string name;
  std::string file;                   ///< relative to the edit file; empty for a sample
  std::optional<std::string> sha256;  ///< of the file's bytes, 64 lower-case hexadecimal digits
  std::string sample;                 ///< name of a built-in sample; empty for a file
  int resolution = 0;                 ///< of the sample; 0 = its default
};

/// Where a handle goes.
struct PoseSpec {
  struct DefFile {
    std::string file;
  };  ///< a `.def` file with a 4×4 matrix
  struct Redrawn {
    Points polyline;
  };  ///< the new course of a curve handle, k×3
  using Kind = std::variant<HandleMotion, Eigen::Matrix4d, DefFile, Redrawn>;
  Kind kind = HandleMotion{};
};

struct HandleSpec {
  std::string name;
  HandleShape shape = HandleShape::region;
  std::optional<bool> closed;  ///< of a curve; absent: closed where its ends share an edge
  SelectionSpec select;
  bool constrain_position = true;
  bool constrain_transform = true;
  PoseSpec pose;
};

struct TargetSpec {
  Index vertex = -1;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

struct TransformSpec {
  Index vertex = -1;
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
};

struct AnchorSpec {
  SelectionSpec select;
  double weight = Anchor{}.weight;
};

/// Symmetric editing: what a deform step asks for on one side of a plane happens on the other side, too.
struct SymmetrySpec {
  MirrorPlane plane;
  /// How far a vertex may be from another one's mirror image, × the diagonal of the mesh's bounding box.
  double tolerance_rel = 1e-3;
};

/// Numbers that a reader of the edit checks against the mesh; absent ones are not checked.
struct ExpectedCounts {
  std::optional<Index> vertices, faces, region, fixed, handle, free;
};

struct DeformSettings {
  DeformerOptions deformer;
  /// How often the surroundings of handles and of the fixed rim are halved for the solve (FT05 section 6); the
  /// result has the original vertices only.
  int refine_boundary = 0;
  /// About how many vertices the decimated proxy has that is solved in the region's place (deform/proxy.h); 0:
  /// the region itself is solved.
  Index proxy = 0;
  /// Vertices of a boundary at exactly the same place are one for the solve (a soup, a seam of UVs).
  bool weld = true;
};

/// Deforms one mesh (FT05 sections 3 and 4).
struct DeformStep {
  std::string mesh;                    ///< name of an input or of an earlier step's result
  std::string result;                  ///< name of the outcome; empty = the same name
  SelectionSpec region;                ///< what may move
  std::optional<SelectionSpec> fixed;  ///< absent: the region's rim towards the rest, two rings, no handles
  std::vector<HandleSpec> handles;
  std::vector<TargetSpec> targets;        ///< positions per vertex
  std::vector<TransformSpec> transforms;  ///< local transforms per vertex
  std::vector<AnchorSpec> anchors;
  std::optional<SymmetrySpec> symmetry;
  DeformSettings settings;
  ExpectedCounts counts;
};

/// A vertex by its number, or the one nearest to a point.
using VertexSpec = std::variant<Index, Eigen::Vector3d>;

/// A vertex of the source and one of the target, each in its own mesh as the step finds it.
struct MatchSpec {
  VertexSpec source, target;
  bool operator==(const MatchSpec&) const = default;
};

/// A loop of the source and the loop of the target that it meets. A selection names all vertices of one
/// boundary loop, in any order.
struct MergePairSpec {
  SelectionSpec source_loop, target_loop;
  /// As `MergePair::matches`, points standing for the loops' nearest vertices; the file's `start` comes first.
  std::vector<MatchSpec> matches;
};

struct MergeFeatureSpec {
  SelectionSpec select;  ///< on the source
  bool similarity = true;
};

/// Where a part is dropped on a surface without a hole: as `Drop`.
struct DropSpec {
  VertexSpec surface_point;                    ///< a vertex of the target, or the surface nearest to a point
  double spin_deg = 0;                         ///< turn about the target's normal
  std::optional<SelectionSpec> source_loop{};  ///< absent: the source's only loop
};

struct MergeSettings {
  DeformerOptions deformer = MergeOptions{}.deformer;
  SeamOptions seam;
};

/// Numbers that a reader of the edit checks against the meshes; absent or empty ones are not checked.
struct MergeCounts {
  std::optional<Index> source_vertices, source_faces, target_vertices, target_faces, fixed;
  std::optional<Index> free;                      ///< of the source: neither of its loops nor fixed
  std::vector<Index> source_loops, target_loops;  ///< vertices of each pair's
};

/// Grafts a mesh onto another (FT05 section 5).
struct MergeStep {
  std::string target, source;  ///< names of inputs or of earlier steps' results
  std::string result;          ///< name of the outcome; empty = the target's
  MergePose pose = MergePose::find;
  MergeShape shape = MergeShape::similar;
  /// None: the loops that `matches` lie on, or the only loop of each mesh.
  std::vector<MergePairSpec> pairs;
  std::vector<MatchSpec> matches;     ///< each of the pair on whose loops it lies
  std::optional<DropSpec> at;         ///< in the place of pairs
  std::optional<MirrorPlane> mirror;  ///< what poses the source first: this, then one of the next two
  std::optional<Eigen::Matrix4d> source_transform;
  std::vector<MatchSpec> align;  ///< as `align_source`
  std::optional<double> size;
  double normal_angle_deg = 0;
  std::optional<SelectionSpec> fixed;  ///< on the source
  Reach reach;                         ///< a length in units of the source as it was before it was posed
  std::vector<MergeFeatureSpec> features;
  bool smooth_boundary = false;
  bool fix_winding = false;
  MergeSettings settings;
  MergeCounts counts;
};

/// Cuts a mesh open.
struct CutStep {
  struct Plane {
    Eigen::Vector3d point, normal;
  };
  std::string mesh;
  std::string result;                             ///< name of the outcome; empty = the same name
  std::variant<Plane, std::vector<Index>> along;  ///< a plane, or vertices that a closed curve joins
  CutOptions options;
};

/// One step of an edit. New kinds of step join the variant.
struct EditStep {
  std::string name;   ///< optional; unique where given
  std::string about;  ///< optional
  std::variant<DeformStep, MergeStep, CutStep> action;
};

/// A complete edit: what to start from and what to do, in order. Each step sees the meshes as the steps before
/// it left them.
struct EditFile {
  std::string name;
  std::string about;
  std::vector<EditInput> inputs;
  std::vector<NamedSelection> selections;
  std::vector<EditStep> steps;
  std::string output;              ///< name of the mesh that is the result; empty = that of the last step
  std::vector<std::string> notes;  ///< sentences for people about words that are read as others

  std::string location;               ///< what messages call the file
  std::filesystem::path base_folder;  ///< what its relative paths start from
};

/// The mesh that a step works on; a merge's target.
const std::string& mesh_of(const EditStep& step);

/// The mesh that a step leaves: its `result`, or `mesh_of`.
const std::string& outcome_of(const EditStep& step);

/// Names of the meshes that an edit has at its end: its inputs, then what its steps leave, each once.
std::vector<std::string> mesh_names(const EditFile& edit);

/// Largest edit file that is read, in bytes, and its deepest nesting.
inline constexpr std::uintmax_t edit_file_size_limit = std::uintmax_t{256} << 20;
inline constexpr int edit_file_depth_limit = 64;

/// Reads an edit file, version 1 or 2 (docs/edit-file.md). Throws Error(io) if it cannot be read, and what
/// `parse_edit` throws.
EditFile read_edit_file(const std::filesystem::path& path);

/// The edit that `text` (JSON, UTF-8) describes. Throws Error(input) whose place is `location` and the path of
/// the field, e.g. "edit.json: steps[0].handles[1].pose.rotate.axis", for anything that is not as
/// docs/edit-file.md says: unknown, missing or repeated fields, wrong types and ranges, names that nothing
/// has. A version 1 file becomes one step by the method or shape `ft05`, for which the format was made.
EditFile parse_edit(std::string_view text, const std::string& location,
                    const std::filesystem::path& base_folder = {});

/// A selection as it stands in an edit file. Throws as `parse_edit`.
SelectionSpec parse_selection(std::string_view text, const std::string& location);

/// The edit as a version 2 file; `parse_edit` reads it back to the same.
std::string write_edit(const EditFile& edit);

/// Every file that running the edit reads, as given in it joined with the base folder, without repeats.
std::vector<std::filesystem::path> referenced_files(const EditFile& edit);

std::string_view to_string(SelectionSpec::SelPart value);

}  // namespace meshgraft
