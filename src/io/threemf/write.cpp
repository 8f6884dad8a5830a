#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <ranges>
#include <utility>

#include <meshgraft/core/error.h>

#include "core/sparse_checks.h"
#include "document.h"
#include "io/facts.h"
#include "io/number_text.h"
#include "io/unwritten.h"
#include "mesh/join.h"
#include "threemf.h"
#include "threemf/facts.h"

namespace meshgraft::io {

namespace {

constexpr std::array<std::string_view, 1> extensions = {".3mf"};

void require_in_range(const Eigen::RowVector3d& position, Eigen::Index vertex) {
  constexpr float largest = 1e9F;  // the limit of lib3mf
  if (!(position.cast<float>().cwiseAbs().maxCoeff() < largest))
    throw Error(facts::threemf::CoordinateTooLarge{.vertex = vertex});
}

/// Returns new positions of a file's objects, in their own frames. Returns nothing if copies of one object
/// differ, or if a flattening transform has no inverse. The file cannot express either case.
std::optional<std::vector<Points>> object_positions(const ThreemfDocument& document, const Mesh& mesh) {
  constexpr double tolerance_rel = 1e-9;
  const double size = mesh.positions.size() == 0 ? 0 : mesh.positions.cwiseAbs().maxCoeff();
  std::vector<Points> positions;
  for (std::size_t k = 0; k < document.sources.size(); ++k) positions.push_back(document.vertices(k).positions);
  Flags decided(positions.size(), false);
  Eigen::Index first = 0;
  for (const ThreemfModel::Placement& placement : document.placements) {
    const Points& old = document.vertices(placement.object).positions;
    Points& now = positions[placement.object];
    const Eigen::Affine3d inverse = placement.transform.inverse();
    const bool is_plain = placement.transform.matrix() == Eigen::Affine3d::Identity().matrix();
    for (Eigen::Index v = 0; v < old.rows(); ++v) {
      const Eigen::RowVector3d world = mesh.positions.row(first + v);
      const bool moved = world != placed(placement.transform, old.row(v));
      if (decided[placement.object]) {
        if ((placed(placement.transform, now.row(v)) - world).cwiseAbs().maxCoeff() > tolerance_rel * size)
          return std::nullopt;
      } else if (moved) {
        now.row(v) = is_plain ? world : placed(inverse, world);
        if (!now.row(v).allFinite()) return std::nullopt;
        require_in_range(now.row(v), first + v);
      }
    }
    decided[placement.object] = true;
    first += old.rows();
  }
  return positions;
}

/// Appends a long text, here that of all triangles, with checks between its pieces.
void append_in_pieces(std::string& out, std::string_view text, const Context& context) {
  constexpr std::size_t piece = std::size_t{1} << 24;
  for (; !text.empty(); text.remove_prefix(std::min(piece, text.size()))) {
    context.throw_if_stopped();
    out.append(text.substr(0, piece));
  }
}

/// Returns the part with new coordinates in its vertex tags.
std::string rewritten(std::string_view xml, const std::vector<ThreemfVertices>& meshes,
                      const std::vector<const Points*>& positions, const Context& context) {
  SparseChecks check(context);
  std::string out;
  out.reserve(xml.size() + xml.size() / 4);
  std::size_t copied = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (positions[m] == nullptr) continue;
    const ThreemfVertices& old = meshes[m];
    for (std::size_t v = 0; v < old.tag_begin.size(); ++v) {
      check();
      const auto row = static_cast<Eigen::Index>(v);
      if (old.positions.row(row) == positions[m]->row(row)) continue;
      out.append(xml, copied, old.tag_begin[v] - copied);
      append_tag(out, xml.substr(old.tag_begin[v], old.tag_length[v]), old.positions.row(row),
                 positions[m]->row(row));
      copied = old.tag_begin[v] + old.tag_length[v];
    }
  }
  append_in_pieces(out, xml.substr(copied), context);
  return out;
}

std::string patch(const ThreemfDocument& document, const std::vector<Points>& positions,
                  const Context& context) {
  std::vector<PackagePart> changed;
  for (std::size_t p = 0; p < document.parts.size(); ++p) {
    std::vector<const Points*> of_mesh(document.scanned[p].meshes.size(), nullptr);
    for (std::size_t k = 0; k < positions.size(); ++k)
      if (document.sources[k].part == p) of_mesh[document.sources[k].mesh] = &positions[k];
    std::string text = rewritten(document.parts[p].content, document.scanned[p].meshes, of_mesh, context);
    if (text != document.parts[p].content) changed.push_back({document.parts[p].name, std::move(text)});
  }
  return changed.empty() ? document.package : with_parts(document.package, changed, context);
}

/// Composes a new package with one object per value of the attribute "object".
class ThreemfComposer {
 public:
  ThreemfComposer(const Mesh& mesh, const Context& context) : mesh_(mesh), context_(context) {}

  Written compose() {
    choose_unit();
    choose_properties();
    context_.throw_if_stopped();
    split_into_objects();
    context_.throw_if_stopped();
    Written written{write_threemf_model(model_, context_)};
    restore_digits(written.content);
    written.notes = left_out_notes(mesh_);
    note_losses(written.notes);
    return written;
  }

 private:
  void choose_unit() {
    const FileDocument* origin = origin_of(mesh_);
    if (origin != nullptr && !origin->unit().empty()) model_.unit = origin->unit();
  }

  void choose_properties() {
    object_ = label_attribute("object");
    material_ = label_attribute("material");
    for (const Domain domain : {Domain::corner, Domain::vertex, Domain::face}) {
      const Attribute* colour = mesh_.find_attribute(domain, "colour");
      if (colour_ == nullptr && colour != nullptr && (colour->components == 3 || colour->components == 4))
        colour_ = colour;
    }
    if (material_ == nullptr) return;
    model_.material_names = material_->labels;
    model_.material_colours.assign(material_->labels.size(), {200, 200, 200, 255});
  }

  const Attribute* label_attribute(std::string_view name) const {
    const Attribute* attribute = mesh_.find_attribute(Domain::face, name);
    return attribute != nullptr && attribute->components == 1 && !attribute->labels.empty() ? attribute
                                                                                            : nullptr;
  }

  void split_into_objects() {
    const Triangulation pieces = triangulate(mesh_);
    number_.assign(static_cast<std::size_t>(mesh_.vertex_count()), none);
    SparseChecks check(context_);
    std::map<double, std::vector<Eigen::Index>> triangles_of;
    for (Eigen::Index t = 0; t < pieces.triangles.rows(); ++t) {
      check();
      const Index face = pieces.face[t];
      const bool has_none = object_ == nullptr || std::isnan(object_->values[face]);
      triangles_of[has_none ? -1 : object_->values[face]].push_back(t);
    }
    for (const auto& [value, triangles] : triangles_of) {
      model_.objects.emplace_back().name = name_of(value);
      context_.throw_if_stopped();
      add_vertices(pieces, triangles);
      context_.throw_if_stopped();
      for (const Eigen::Index t : triangles) {
        check();
        add_triangle(pieces.triangles.row(t), pieces.face[t]);
      }
    }
  }

  std::string name_of(double value) const {
    const bool named = object_ != nullptr && value >= 0 && value < static_cast<double>(object_->labels.size());
    return named ? object_->labels[static_cast<std::size_t>(value)] : std::string();
  }

  // Adds the vertices that the triangles use, in the order of the mesh.
  void add_vertices(const Triangulation& pieces, const std::vector<Eigen::Index>& triangles) {
    for (const Index v : used_) number_[v] = none;
    used_.clear();
    for (const Eigen::Index t : triangles)
      for (const Index v : pieces.triangles.row(t))
        if (std::exchange(number_[v], 0) == none) used_.push_back(v);
    context_.throw_if_stopped();
    std::sort(used_.begin(), used_.end());
    for (std::size_t k = 0; k < used_.size(); ++k) number_[used_[k]] = static_cast<std::uint32_t>(k);
    positions_.emplace_back(mesh_.positions(used_, Eigen::all));
    for (const Index v : used_) {
      require_in_range(mesh_.positions.row(v), v);
      const Eigen::RowVector3f p = mesh_.positions.row(v).cast<float>();
      model_.objects.back().vertices.push_back({p.x(), p.y(), p.z()});
    }
  }

  void add_triangle(const Eigen::Matrix<Index, 1, 3>& triangle, Index face) {
    ThreemfModel::Object& object = model_.objects.back();
    std::array<std::uint32_t, 3> corners{};
    for (int c = 0; c < 3; ++c) corners[c] = number_[triangle[c]];
    object.triangles.push_back(corners);
    if (material_ != nullptr) {
      const double value = material_->values[face];
      const bool named = value >= 0 && value < static_cast<double>(material_->labels.size());
      object.materials.push_back(named ? static_cast<std::int32_t>(value) : ThreemfModel::none);
    }
    if (colour_ != nullptr) object.colours.push_back(colours_of(triangle, face));
  }

  std::array<std::uint8_t, 12> colours_of(const Eigen::Matrix<Index, 1, 3>& triangle, Index face) const {
    std::array<std::uint8_t, 12> colours;
    colours.fill(255);
    const bool fractions = colour_->type == ScalarType::float32 || colour_->type == ScalarType::float64;
    for (std::size_t c = 0; c < 3; ++c) {
      const Index element = element_of(triangle[static_cast<int>(c)], face);
      for (std::size_t k = 0; element >= 0 && k < static_cast<std::size_t>(colour_->components); ++k) {
        const double value =
            colour_
                ->values[static_cast<std::size_t>(element) * static_cast<std::size_t>(colour_->components) + k];
        if (std::isnan(value)) continue;
        colours[4 * c + k] =
            static_cast<std::uint8_t>(std::lround(std::clamp(fractions ? 255 * value : value, 0.0, 255.0)));
      }
    }
    return colours;
  }

  Index element_of(Index vertex, Index face) const {
    if (colour_->domain == Domain::vertex) return vertex;
    if (colour_->domain == Domain::face) return face;
    const auto corners = mesh_.faces[face];
    const auto corner = std::ranges::find(corners, vertex);
    return mesh_.faces.first_corner(face) + static_cast<Index>(corner - corners.begin());
  }

  // Restores the digits of coordinates. lib3mf writes six decimals, which would flatten a small model.
  void restore_digits(std::string& package) const {
    MemoryBudget unlimited(std::numeric_limits<std::uint64_t>::max());  // the package is our own
    std::vector<PackagePart> parts = model_parts(package, {}, unlimited, context_);
    parts.resize(1);
    PackagePart& part = parts.front();
    const std::vector<ThreemfVertices> written = scan_part(part.content, part.name, unlimited, context_).meshes;
    std::vector<const Points*> positions;
    for (const Points& points : positions_) positions.push_back(&points);
    part.content = rewritten(part.content, written, positions, context_);
    context_.throw_if_stopped();
    package = with_parts(package, parts, context_);
  }

  void note_losses(std::vector<Note>& notes) const {
    note_unwritten(mesh_, "3MF", {object_, material_, colour_}, notes);
    if (material_ != nullptr && colour_ != nullptr) notes.push_back(facts::threemf::ColoursLost{});
    Flags used(mesh_.vertex_count(), false);
    for (const Index v : mesh_.faces.corners()) used[v] = true;
    const auto lonely = std::ranges::count(used, false);
    if (lonely > 0) notes.push_back(facts::io::VerticesLeftOut{.format = "3MF", .count = lonely});
    const auto polygons = std::ranges::count_if(std::views::iota(Index{0}, mesh_.face_count()),
                                                [&](Index f) { return mesh_.faces[f].size() > 3; });
    if (polygons > 0) notes.push_back(facts::io::PolygonsSplit{.format = "3MF", .count = polygons});
  }

  const Mesh& mesh_;
  const Context& context_;
  const Attribute *object_ = nullptr, *material_ = nullptr, *colour_ = nullptr;
  ThreemfModel model_;
  std::vector<Points> positions_;  // per object, in full precision
  std::vector<Index> used_;        // vertices of the current object
  static constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number_;  // by vertex of the mesh: its number in the current object, or none
};

}  // namespace

Format threemf_format() {
  constexpr auto has_signature = [](std::string_view content) { return content.starts_with("PK\x03\x04"); };
  return {"3MF", extensions, has_signature, read_threemf, write_threemf};
}

Written write_threemf(const Mesh& mesh, const std::filesystem::path&, const WriteOptions&,
                      const Context& context) {
  const auto* document = dynamic_cast<const ThreemfDocument*>(mesh.source.get());
  const bool unchanged = document != nullptr && document->has_topology_of(mesh);
  if (!unchanged) return ThreemfComposer(mesh, context).compose();
  if (!document->sources.empty())
    if (const auto positions = object_positions(*document, mesh))
      return {patch(*document, *positions, context)};
  Written written = ThreemfComposer(mesh, context).compose();
  written.notes.push_back(document->sources.empty() ? Note(facts::threemf::MeshesAlike{})
                                                    : Note(facts::threemf::CopiesEditedApart{}));
  return written;
}

}  // namespace meshgraft::io
