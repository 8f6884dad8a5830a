#include "mesh_messages.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/normals.h>

#include "core/memory_budget.h"
#include "io/file.h"
#include "io/textures.h"

namespace meshgraft::editor {

namespace {

Json header_of(const Object& base) {
  const Eigen::RowVector3d& o = base.offset;
  return {{"mesh", base.id}, {"offset", {o.x(), o.y(), o.z()}}, {"scale", 1.0}};
}

std::vector<float> to_floats(const std::vector<double>& values, double unit) {
  std::vector<float> floats;
  floats.reserve(values.size());
  for (const double value : values) floats.push_back(static_cast<float>(value / unit));
  return floats;
}

template <class Matrix>
std::span<const float> numbers_of(const Matrix& matrix) {
  return {matrix.data(), static_cast<std::size_t>(matrix.size())};
}

}  // namespace

void add_surface(BinaryMessage& message, const Mesh& mesh, const Triangles& triangles,
                 const Eigen::RowVector3d& offset) {
  message.add("positions", relative_to(offset, mesh.positions));
  message.add("triangles",
              std::span<const Index>(triangles.data(), static_cast<std::size_t>(triangles.size())));
  message.add("normals", relative_to(Eigen::RowVector3d::Zero(), vertex_normals(mesh)));
  if (const Attribute* uv = mesh.find_attribute(Domain::vertex, "uv"); uv != nullptr && uv->components == 2)
    message.add("uv", to_floats(uv->values, 1));
  if (const Attribute* colour = mesh.find_attribute(Domain::vertex, "colour");
      colour != nullptr && colour->components == 3)
    message.add("colours", to_floats(colour->values, colour->type == ScalarType::uint8 ? 255 : 1));
}

namespace {

// Adds the uv of the corners of triangles, 2 numbers each.
void add_corner_uv(BinaryMessage& message, const Object& object) {
  const Mesh& mesh = object.mesh();
  const Attribute* uv = mesh.find_attribute(Domain::corner, "uv");
  if (uv == nullptr || uv->components != 2) return;
  std::vector<float> numbers;
  numbers.reserve(2 * object.triangles.size());
  for (Index t = 0; t < object.triangles.rows(); ++t) {
    const Index face = object.triangle_faces[t];
    const auto corners = mesh.faces[face];
    for (int k = 0; k < 3; ++k) {
      const auto corner = std::find(corners.begin(), corners.end(), object.triangles(t, k)) - corners.begin();
      const auto at = static_cast<std::size_t>(2 * (mesh.faces.first_corner(face) + corner));
      for (std::size_t i = 0; i < 2; ++i)
        numbers.push_back(std::isfinite(uv->values[at + i]) ? static_cast<float>(uv->values[at + i]) : 0.0F);
    }
  }
  message.add("corner_uv", numbers);
}

/// Adds texture images to a message, each once though several materials show it.
class PictureSender {
 public:
  PictureSender(BinaryMessage& message, const Folders& folders) : message_(message), folders_(folders) {}

  /// Returns the number of the image in the message, from 1. Returns 0 where it must not be read, cannot be
  /// read, or exceeds the size limit of one image or of all.
  Index send(const MaterialTexture& texture) {
    const auto [known, is_new] = numbers_.try_emplace({texture.file, texture.bytes.get()}, 0);
    if (is_new) known->second = add(texture);
    return known->second;
  }

  Index count() const { return count_; }

 private:
  Index add(const MaterialTexture& texture) {
    try {
      const std::string of_file = texture.file.empty() ? std::string() : read(texture.file);
      const std::string& bytes = texture.bytes ? *texture.bytes : of_file;
      if (bytes.empty()) return 0;
      budget_.charge(bytes.size());
      const auto* begin = reinterpret_cast<const std::uint8_t*>(bytes.data());
      message_.add("picture", std::span(begin, bytes.size()), ++count_);
      return count_;
    } catch (const std::exception&) {
      return 0;  // the surface is shown without it
    }
  }

  std::string read(const std::filesystem::path& texture) const {
    MemoryBudget one(most_bytes_of_one);
    return read_file(folders_.inside(texture), one);
  }

  static constexpr std::uint64_t most_bytes_of_one = std::uint64_t{1} << 28,
                                 most_bytes = std::uint64_t{1} << 29;

  BinaryMessage& message_;
  const Folders& folders_;
  std::map<std::pair<std::filesystem::path, const std::string*>, Index> numbers_;
  MemoryBudget budget_{most_bytes};
  Index count_ = 0;
};

// Texture images of faces. The attribute `numbers` holds the index into `textures` per face; null: 0 for all
// faces.
struct Pictures {
  const Attribute* numbers = nullptr;
  std::vector<MaterialTexture> textures;  ///< indexed by the values of `numbers`
};

Pictures pictures_of(const Mesh& mesh) {
  Pictures pictures;
  const Attribute* material = mesh.find_attribute(Domain::face, "material");
  if (material == nullptr) {
    pictures.textures = textures_of(mesh);
    pictures.numbers = mesh.find_attribute(Domain::face, "texnumber");
    return pictures;
  }
  pictures.numbers = material;
  pictures.textures.resize(material->labels.size());
  for (MaterialTexture& texture : textures_of(mesh)) {
    const auto label = std::find(material->labels.begin(), material->labels.end(), texture.material);
    if (label == material->labels.end()) continue;
    pictures.textures[label - material->labels.begin()] = std::move(texture);
  }
  return pictures;
}

// Adds texture images and, per triangle, the number of its image.
void add_textures(BinaryMessage& message, const Object& object, const Folders& folders) {
  const auto [numbers, textures] = pictures_of(object.mesh());
  PictureSender sender(message, folders);
  std::vector<Index> sent;  // number of the image in the message, or 0 where it cannot be shown
  for (const MaterialTexture& texture : textures) sent.push_back(sender.send(texture));
  if (sender.count() == 0) return;
  std::vector<Index> pictures;
  for (const Index face : object.triangle_faces) {
    const double number = numbers == nullptr ? 0 : numbers->values[face];
    const bool is_known = number >= 0 && number < static_cast<double>(sent.size());
    pictures.push_back(is_known ? sent[static_cast<std::size_t>(number)] : 0);
  }
  message.add("pictures", pictures);
}

}  // namespace

std::vector<std::byte> mesh_frame(const Object& object, std::string_view role, const Folders& folders) {
  Json header = header_of(object);
  header["name"] = object.name;
  header["role"] = role;
  header["vertices"] = object.mesh().vertex_count();
  header["faces"] = object.mesh().face_count();
  BinaryMessage message(MessageKind::mesh, std::move(header));
  add_surface(message, object.mesh(), object.triangles, object.offset);
  add_corner_uv(message, object);
  add_textures(message, object, folders);
  return message.bytes();
}

std::vector<std::byte> loops_frame(const Object& object) {
  std::vector<Index> vertices, offsets{0};
  for (const std::vector<Index>& loop : object.loops) {
    vertices.insert(vertices.end(), loop.begin(), loop.end());
    offsets.push_back(static_cast<Index>(vertices.size()));
  }
  BinaryMessage message(MessageKind::loops, {{"mesh", object.id}});
  message.add("vertices", vertices);
  message.add("offsets", offsets);
  return message.bytes();
}

std::vector<Index> moving_vertices(const Object& base, const Region& region) {
  Flags moves(base.mesh().vertex_count(), region.whole ? 1 : 0);
  for (const Index v : region.vertices) moves[v] = 1;
  for (const Index v : region.fixed) moves[v] = 0;
  std::vector<Index> moving;
  for (Index v = 0; v < base.mesh().vertex_count(); ++v)
    if (moves[base.weld.of(v)] != 0) moving.push_back(v);
  return moving;
}

std::vector<std::byte> position_frame(const Object& base, const std::vector<Index>& moving,
                                      const LiveFrame& frame) {
  const Points& positions = *frame.positions;
  const Index vertices = base.mesh().vertex_count();  // more were solved for where the mesh was refined
  const bool all = 4 * moving.size() > 3 * static_cast<std::size_t>(vertices);
  Json header = header_of(base);
  header["pose"] = frame.pose;
  header["accuracy"] = to_string(frame.accuracy);
  header["seconds"] = frame.seconds;
  if (frame.error_rel) header["error_rel"] = *frame.error_rel;
  const auto count = all ? vertices : static_cast<Eigen::Index>(moving.size());
  Points sent(count, 3);
  for (Eigen::Index i = 0; i < count; ++i)
    sent.row(i) = positions.row(base.weld.of(all ? static_cast<Index>(i) : moving[i]));
  BinaryMessage bytes(MessageKind::frame, std::move(header));
  bytes.add("positions", relative_to(base.offset, sent));
  if (!all) bytes.add("vertices", moving);
  return bytes.bytes();
}

namespace {

struct Followers {
  std::vector<Index> vertices, rows;
};

// Returns all vertices of the mesh that are welded to one of `movers`, each with its row in `movers`.
Followers followers_of(const Object& base, const std::vector<Index>& movers) {
  std::vector<Index> row(base.mesh().vertex_count(), -1);
  for (std::size_t i = 0; i < movers.size(); ++i) row[movers[i]] = static_cast<Index>(i);
  Followers followers;
  for (Index v = 0; v < base.mesh().vertex_count(); ++v) {
    const Index of = row[base.weld.of(v)];
    if (of < 0) continue;
    followers.vertices.push_back(v);
    followers.rows.push_back(of);
  }
  return followers;
}

// Removes the data of the vertices from `count` on, which were added for the solve.
void keep_vertices_below(Index count, HandleBuffers& buffers) {
  std::vector<Index>& vertices = buffers.vertices;
  vertices.erase(std::lower_bound(vertices.begin(), vertices.end(), count), vertices.end());
  const auto rows = static_cast<Eigen::Index>(vertices.size());
  const auto shorten = [&](auto& matrix) {
    if (matrix.rows() > rows) matrix.conservativeResize(rows, Eigen::NoChange);
  };
  shorten(buffers.positions);
  shorten(buffers.normals);
  shorten(buffers.maps);
  shorten(buffers.blocks);
}

}  // namespace

std::vector<std::byte> weights_frame(const Object& base, const HandleBasis& basis) {
  HandleBuffers buffers = basis.buffers();
  keep_vertices_below(base.mesh().vertex_count(), buffers);
  const Eigen::RowVector3d& c = buffers.centre;
  Json header = {{"mesh", base.id}, {"offset", {c.x(), c.y(), c.z()}}, {"scale", buffers.scale}};
  header["width"] = buffers.blocks.cols();
  BinaryMessage message(MessageKind::weights, std::move(header));
  if (base.weld.empty()) {
    message.add("vertices", buffers.vertices);
  } else {
    const Followers followers = followers_of(base, buffers.vertices);
    message.add("vertices", followers.vertices);
    message.add("rows", followers.rows);
  }
  message.add("positions", numbers_of(buffers.positions));
  message.add("normals", numbers_of(buffers.normals));
  message.add("maps", numbers_of(buffers.maps));
  message.add("blocks", numbers_of(buffers.blocks));
  return message.bytes();
}

std::vector<std::byte> selection_frame(const Object& base, const std::vector<Index>& selection) {
  BinaryMessage message(MessageKind::selection, {{"mesh", base.id}});
  message.add("vertices", selection);
  return message.bytes();
}

std::vector<std::byte> roles_frame(const Object& base, const Region& region) {
  BinaryMessage message(MessageKind::roles, {{"mesh", base.id}, {"whole", region.whole}});
  message.add("region", region.vertices);
  message.add("fixed", region.fixed);
  for (const Handle& handle : region.handles) message.add("handle", handle.vertices, handle.name);
  return message.bytes();
}

}  // namespace meshgraft::editor
