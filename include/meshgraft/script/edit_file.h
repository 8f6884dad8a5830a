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

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/orientation.h>
#include <meshgraft/mesh/repair.h>
#include <meshgraft/select/selection.h>

namespace meshgraft {

/// A vertex set as an edit file describes it. It may refer to other selections by name, to files, and to the
/// products of an earlier step. Running the step makes a `Selection` of it, which refers to nothing but a mesh.
struct EditSelection {
  using Child = std::shared_ptr<const EditSelection>;
  enum class SelRole { fixed, free, handle };

  /// An entry of `EditFile::selections`.
  struct Named {
    std::string name;
  };
  /// A file with one vertex index per line.
  struct IndexFile {
    std::string file;
  };
  /// The vertices with one role in a `.sel` file.
  struct SelFile {
    std::string file;
    SelRole take = SelRole::handle;
  };
  /// A product of an earlier step, e.g. the loop that a cut made; docs/edit-file.md lists them.
  struct Produced {
    std::string step, what;
  };
  using Grow = SelectionOperations<EditSelection>::Grow;
  using GrowLength = SelectionOperations<EditSelection>::GrowLength;
  using Union = SelectionOperations<EditSelection>::Union;
  using Minus = SelectionOperations<EditSelection>::Minus;
  using Intersect = SelectionOperations<EditSelection>::Intersect;
  using Mirror = SelectionOperations<EditSelection>::Mirror;
  using Rim = SelectionOperations<EditSelection>::Rim;

  using Kind =
      std::variant<Selection::All, Selection::Indices, Selection::Box, Selection::Sphere, Selection::HalfSpace,
                   Selection::Component, Selection::Loop, Selection::NearestVertex, Selection::Path, Named,
                   IndexFile, SelFile, Produced, Grow, GrowLength, Union, Minus, Intersect, Mirror, Rim>;
  Kind kind = Selection::All{};
};

struct NamedSelection {
  std::string name;
  EditSelection selection;
  std::string colour{};  ///< drawing colour, "#rrggbb"; empty: none
};

/// A mesh that an edit starts from: a file or a built-in model.
struct EditInput {
  std::string name;
  std::string file;                   ///< relative to the edit file; empty for a sample
  std::optional<std::string> sha256;  ///< SHA-256 of the file's bytes, 64 lower-case hexadecimal digits
  std::string sample;                 ///< name of a built-in model; empty for a file
  int resolution = 0;                 ///< resolution of the sample; 0 = its default
  /// Directions that are up and front in the model; absent: guessed where a start has to be found.
  std::optional<Orientation> orientation;
};

/// The pose of a handle.
struct PoseSpec {
  /// A `.def` file with a 4×4 matrix.
  struct DefFile {
    std::string file;
  };
  /// The new course of a curve handle, k×3, model units.
  struct Redrawn {
    Points polyline;
  };
  using Kind = std::variant<HandleMotion, Eigen::Matrix4d, DefFile, Redrawn>;
  Kind kind = HandleMotion{};
};

struct HandleSpec {
  std::string name;
  HandleShape shape = HandleShape::region;
  std::optional<bool> closed;  ///< for `curve`; absent: closed if its ends share an edge
  EditSelection select;
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
  EditSelection select;
  double weight = Anchor{}.weight;
};

/// Vertices that keep their shape up to one unknown map (FT05 section 7). In a merge step they are the
/// source's.
struct FeatureSpec {
  EditSelection select;
  bool similarity = true;  ///< or any affine map
};

/// Symmetric editing: the edits of a deform step on one side of a plane are mirrored to the other side.
struct SymmetrySpec {
  Plane plane;
  /// Largest distance of a vertex from the mirror image of its partner, × the diagonal of the mesh's bounding
  /// box.
  double tolerance_rel = 1e-3;
};

/// Numbers that a reader of the edit checks against the mesh; absent ones are not checked.
struct ExpectedCounts {
  std::optional<Index> vertices, faces, region, fixed, handle, free;
};

/// Settings that have a name. Other settings that a step gives replace those of its preset.
enum class Preset {
  as_published,  ///< FT05 as written; results never change
};

std::string_view to_string(Preset value);

struct DeformSettings {
  std::optional<Preset> preset;  ///< settings with a name, which the others replace
  DeformerOptions deformer;
  /// Number of times that edges around handles and around the region's fixed boundary are halved for the
  /// solve (FT05 section 6). Absent: twice around sparse handles and targets, those without an interior
  /// vertex; not for published methods and proxies. The result has the original vertices only.
  std::optional<int> refine_boundary;
  /// Approximate number of vertices of the decimated proxy that is solved in place of the region
  /// (deform/quick_frames.h). 0: the region itself is solved.
  Index proxy = 0;
  /// Treats boundary vertices at exactly the same position as one vertex for the solve (a soup, a seam of
  /// UVs).
  bool weld = true;
};

/// Deforms one mesh (FT05 sections 3 and 4).
struct DeformStep {
  std::string mesh;      ///< name of an input or of an earlier step's result
  std::string result;    ///< name of the resulting mesh; empty = the same name
  EditSelection region;  ///< region of interest
  /// Absent: two rings of the region along its boundary with the rest, without the
  /// vertices of handles, targets and transforms.
  std::optional<EditSelection> fixed;
  std::vector<HandleSpec> handles;
  std::vector<TargetSpec> targets;        ///< positions per vertex
  std::vector<TransformSpec> transforms;  ///< local transforms per vertex
  std::vector<AnchorSpec> anchors;
  std::vector<FeatureSpec> features;
  std::optional<SymmetrySpec> symmetry;
  DeformSettings settings;
  ExpectedCounts counts;
};

/// A vertex by its index, or the vertex nearest to a point.
using VertexSpec = std::variant<Index, Eigen::Vector3d>;

/// A pair of vertices that meet, one of the source and one of the target, each in its own mesh at the start
/// of the step.
struct MatchSpec {
  VertexSpec source, target;
  bool operator==(const MatchSpec&) const = default;
};

/// A loop of the source and the loop of the target that it meets. A selection contains all vertices of one
/// boundary loop, in any order.
struct MergePairSpec {
  EditSelection source_loop, target_loop;
  /// As `MergePair::matches`; points stand for the loops' nearest vertices. The file's `start` comes first.
  std::vector<MatchSpec> matches;
};

/// The location and turn of a source that is dropped on a surface without a hole, as in `Drop`.
struct DropSpec {
  /// Vertex of the target, or a point: the nearest point of the surface.
  VertexSpec surface_point;
  double spin_deg = 0;                         ///< turn about the target's normal, degrees
  std::optional<EditSelection> source_loop{};  ///< absent: the source's only loop
  /// Without `source_loop`: opens the source here, as in `Drop`. Absent: where the source has no loop, its base
  /// is found. A height is in units of the source before it was posed.
  std::optional<DropBase> base{};
};

struct MergeSettings {
  std::optional<Preset> preset;  ///< also decides the shape, unless the step gives one
  DeformerOptions deformer = MergeOptions{}.deformer;
  SeamOptions seam;
};

/// Numbers that a reader of the edit checks against the meshes; absent or empty ones are not checked.
struct MergeCounts {
  std::optional<Index> source_vertices, source_faces, target_vertices, target_faces, fixed;
  std::optional<Index> free;                      ///< source vertices that are neither on its loops nor fixed
  std::vector<Index> source_loops, target_loops;  ///< number of vertices per pair
};

/// Grafts a mesh onto another (FT05 section 5).
struct MergeStep {
  std::string target, source;  ///< names of inputs or of earlier steps' results
  std::string result;          ///< name of the resulting mesh; empty = the target's
  MergePose pose = MergePose::find;
  MergeShape shape = MergeShape::similar;
  /// If empty: the loops that `matches` lie on, or the only loop of each mesh.
  std::vector<MergePairSpec> pairs;
  /// Matches of any pair; each belongs to the pair on whose loops it lies.
  std::vector<MatchSpec> matches;
  std::optional<DropSpec> at;  ///< drop, used instead of `pairs`
  /// Pose of the source before the merge: first this mirror, then one of the next two.
  std::optional<Plane> mirror;
  std::optional<Eigen::Matrix4d> source_transform;
  std::vector<MatchSpec> align;  ///< pairs for `align_source`
  std::optional<double> size;
  double normal_angle_deg = 0;
  std::optional<EditSelection> fixed;  ///< vertices of the source
  Reach reach;                         ///< a length is in units of the source before it was posed
  std::vector<FeatureSpec> features;
  bool smooth_boundary = false;
  bool fix_winding = false;
  bool retry = true;
  MergeSettings settings;
  MergeCounts counts;
};

/// Cuts a mesh open.
struct CutStep {
  std::string mesh;
  std::string result;                             ///< name of the resulting mesh; empty = the same name
  std::variant<Plane, std::vector<Index>> along;  ///< a plane, or the vertices of a closed curve
  CutOptions options;
};

/// Removes defects of a mesh (`repair`).
struct RepairStep {
  std::string mesh;
  std::string result;  ///< name of the resulting mesh; empty = the same name
  RepairOptions options;
};

/// Moves, turns and scales a whole mesh.
struct TransformStep {
  std::string mesh;
  std::string result;  ///< name of the resulting mesh; empty = the same name
  /// The pivot of a motion is the origin unless given. A map that reflects turns the faces over, too.
  std::variant<HandleMotion, Eigen::Matrix4d> pose;
};

/// Ways to shape a part of a surface without handles.
enum class SculptAction {
  smooth,   ///< removes detail and keeps the tangent planes around the region
  inflate,  ///< raises the middle of the region along its normals, or lowers it
  flatten,  ///< moves the region towards its plane
};

/// Returns the action's name in edit files and reports.
std::string_view to_string(SculptAction value);

/// Smooths, inflates or flattens a region.
struct SculptStep {
  std::string mesh;
  std::string result;  ///< name of the resulting mesh; empty = the same name
  SculptAction action = SculptAction::smooth;
  EditSelection region;         ///< vertices that are shaped; those at an open boundary stay
  double strength = 0.5;        ///< for `smooth` and `flatten`, 0 to 1
  double height = 0;            ///< for `inflate`: of the middle (see reach), model units; negative: inward
  std::optional<double> reach;  ///< for `inflate` and `flatten`: how far around the region the surface follows,
                                ///< along edges, model units; without it the movement fades inside the region
  std::optional<SymmetrySpec> symmetry;  ///< the mirror image of the region is shaped, too
};

/// One step of an edit. New kinds of steps are added to the variant.
struct EditStep {
  std::string name;   ///< optional; unique where given
  std::string about;  ///< optional
  std::variant<DeformStep, MergeStep, CutStep, RepairStep, TransformStep, SculptStep> action;
};

/// Number of the methods. It is raised when the same edit file gives other results than before, other than
/// by rounding.
inline constexpr int current_methods = 9;

/// The program that an edit file was written by.
struct MadeWith {
  std::string version;  ///< of meshgraft
  int methods = 0;      ///< its `current_methods`
};

/// Returns the version and the methods of this library.
MadeWith this_library();

/// A complete edit: the inputs and the steps, in order. Each step works on the meshes as the steps before it
/// left them.
struct EditFile {
  std::string name;
  std::string about;
  std::optional<MadeWith> made_with;  ///< set it to `this_library()` before the edit is written to a file
  std::vector<EditInput> inputs;
  std::vector<NamedSelection> selections;
  std::vector<EditStep> steps;
  std::string output;  ///< name of the resulting mesh; empty = that of the last step
  /// Notes on former words of the format, read as the current ones, and on other methods
  /// (script.other_methods).
  std::vector<Note> notes;

  std::string location;               ///< name of the file in messages
  std::filesystem::path base_folder;  ///< folder of its relative paths
};

/// Returns the name of the mesh that a step works on; for a merge, its target.
const std::string& mesh_of(const EditStep& step);

/// Returns the name of the mesh that a step produces: its `result`, or `mesh_of`.
const std::string& outcome_of(const EditStep& step);

/// Returns the names of the meshes at the end of an edit: its inputs, then the meshes that its steps produce,
/// each once.
std::vector<std::string> mesh_names(const EditFile& edit);

/// The size of the largest edit file that is read, in bytes, and the deepest nesting in it.
inline constexpr std::uintmax_t edit_file_size_limit = std::uintmax_t{256} << 20;
inline constexpr int edit_file_depth_limit = 64;

/// Reads an edit file, version 1 or 2 (docs/edit-file.md). Throws Error(io) if it cannot be read, and what
/// `parse_edit` throws.
EditFile read_edit_file(const std::filesystem::path& path);

/// Parses an edit from `text` (JSON, UTF-8). A version 1 file becomes one step by the method or shape `ft05`,
/// for which that format was made. Throws Error(input) for anything that violates docs/edit-file.md: unknown,
/// missing or repeated fields, wrong types and ranges, names that do not exist. The error's location is
/// `location` and the path of the field, e.g.
/// "edit.json: steps[0].handles[1].pose.rotate.axis".
EditFile parse_edit(std::string_view text, const std::string& location,
                    const std::filesystem::path& base_folder = {});

/// Parses a selection in the form of an edit file. Throws what `parse_edit` throws.
EditSelection parse_selection(std::string_view text, const std::string& location);

/// Returns the edit as a version 2 file; `parse_edit` reads it back to an equal edit.
std::string write_edit(const EditFile& edit);

/// Returns every file that running the edit reads, without repeats: the path as given, joined with the base
/// folder.
std::vector<std::filesystem::path> referenced_files(const EditFile& edit);

std::string_view to_string(EditSelection::SelRole value);

}  // namespace meshgraft
