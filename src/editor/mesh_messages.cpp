#include "mesh_messages.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numeric>
#include <ranges>
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

/// Reads texture images for a message, within a size limit of one image and of all.
class PictureReader {
 public:
  explicit PictureReader(const Folders& folders) : folders_(folders) {}

  /// Returns the image's bytes, and none where it must not be read, cannot be read, or exceeds a limit.
  std::string read(const MaterialTexture& texture) {
    try {
      std::string bytes = texture.file.empty() ? *texture.bytes : read(texture.file);
      budget_.charge(bytes.size());
      return bytes;
    } catch (const std::exception&) {
      return {};  // the surface is shown without it
    }
  }

 private:
  std::string read(const std::filesystem::path& file) const {
    MemoryBudget one(most_bytes_of_one);
    return read_file(folders_.inside(file), one);
  }

  static constexpr std::uint64_t most_bytes_of_one = std::uint64_t{1} << 28,
                                 most_bytes = std::uint64_t{1} << 29;

  const Folders& folders_;
  MemoryBudget budget_{most_bytes};
};

bool is_same_picture(const MaterialTexture& a, const MaterialTexture& b) {
  const bool same_bytes = a.bytes == b.bytes || (a.bytes && b.bytes && *a.bytes == *b.bytes);
  return a.file == b.file && same_bytes;
}

// Returns the number of an image among others, from 1; 0 where it is not there.
Index number_in(const std::vector<MaterialTexture>& pictures, const MaterialTexture& picture) {
  const auto found =
      std::ranges::find_if(pictures, [&](const auto& one) { return is_same_picture(one, picture); });
  return found == pictures.end() ? 0 : static_cast<Index>(found - pictures.begin()) + 1;
}

// The texture images of a mesh, each once though several materials show it. The attribute `values` holds an
// index into `numbers` per face; null: 0 for all faces.
struct Pictures {
  const Attribute* values = nullptr;
  std::vector<Index> numbers;  ///< of images, from 1; 0: none
  std::vector<MaterialTexture> all;

  void add(const MaterialTexture& texture) {
    if (texture.file.empty() && !texture.bytes) return numbers.push_back(0);
    if (number_in(all, texture) == 0) all.push_back(texture);
    numbers.push_back(number_in(all, texture));
  }
  Index number_of(Index face) const {
    const double value = values == nullptr ? 0 : values->values[face];
    const bool is_known = value >= 0 && value < static_cast<double>(numbers.size());
    return is_known ? numbers[static_cast<std::size_t>(value)] : 0;
  }
};

Pictures pictures_of(const Mesh& mesh) {
  Pictures pictures;
  const std::vector<MaterialTexture> textures = textures_of(mesh);
  pictures.values = mesh.find_attribute(Domain::face, "material");
  if (pictures.values == nullptr) {
    pictures.values = mesh.find_attribute(Domain::face, "texnumber");
    for (const MaterialTexture& texture : textures) pictures.add(texture);
    return pictures;
  }
  for (const std::string& label : pictures.values->labels) {
    const auto of_label = [&](const MaterialTexture& texture) { return texture.material == label; };
    const auto last = std::find_if(textures.rbegin(), textures.rend(), of_label);
    pictures.add(last == textures.rend() ? MaterialTexture{} : *last);
  }
  return pictures;
}

void add_numbers(BinaryMessage& message, const Pictures& pictures, const std::vector<Index>& faces) {
  std::vector<Index> numbers;
  for (const Index face : faces) numbers.push_back(pictures.number_of(face));
  message.add("pictures", numbers);
}

// Adds texture images and, per triangle, the number of its image.
void add_textures(BinaryMessage& message, const Object& object, const Folders& folders) {
  Pictures pictures = pictures_of(object.mesh());
  PictureReader reader(folders);
  bool has_any = false;
  for (std::size_t i = 0; i < pictures.all.size(); ++i) {
    const auto number = static_cast<Index>(i) + 1;
    const std::string bytes = reader.read(pictures.all[i]);
    if (bytes.empty()) std::ranges::replace(pictures.numbers, number, 0);
    if (bytes.empty()) continue;
    has_any = true;
    const auto* begin = reinterpret_cast<const std::uint8_t*>(bytes.data());
    message.add("picture", std::span(begin, bytes.size()), number);
  }
  if (has_any) add_numbers(message, pictures, object.triangle_faces);
}

}  // namespace

void add_corner_uv(BinaryMessage& message, const Mesh& mesh, const Triangles& triangles,
                   const std::vector<Index>& faces) {
  const Attribute* uv = mesh.find_attribute(Domain::corner, "uv");
  if (uv == nullptr || uv->components != 2) return;
  std::vector<float> numbers;
  numbers.reserve(2 * static_cast<std::size_t>(triangles.size()));
  for (Index t = 0; t < triangles.rows(); ++t) {
    const Index face = faces[t];
    const auto corners = mesh.faces[face];
    for (int k = 0; k < 3; ++k) {
      const auto corner = std::find(corners.begin(), corners.end(), triangles(t, k)) - corners.begin();
      const auto at = static_cast<std::size_t>(2 * (mesh.faces.first_corner(face) + corner));
      for (std::size_t i = 0; i < 2; ++i)
        numbers.push_back(std::isfinite(uv->values[at + i]) ? static_cast<float>(uv->values[at + i]) : 0.0F);
    }
  }
  message.add("corner_uv", numbers);
}

void add_shared_pictures(BinaryMessage& message, const Mesh& mesh, const std::vector<Index>& faces,
                         std::initializer_list<const Object*> senders) {
  const Pictures pictures = pictures_of(mesh);
  if (pictures.all.empty()) return;
  std::map<Index, std::vector<Index>> shared;  // the mesh and its number of each image
  for (const Object* sender : senders) {
    const Pictures sent = pictures_of(sender->mesh());
    for (std::size_t i = 0; i < pictures.all.size(); ++i)
      if (const Index number = number_in(sent.all, pictures.all[i]); number > 0)
        shared.try_emplace(static_cast<Index>(i) + 1, std::vector<Index>{sender->id, number});
  }
  for (const auto& [number, from] : shared) message.add("shared_picture", from, number);
  if (!shared.empty()) add_numbers(message, pictures, faces);
}

std::vector<std::byte> mesh_frame(const Object& object, std::string_view role, const Folders& folders) {
  Json header = header_of(object);
  header["name"] = object.name;
  header["role"] = role;
  header["vertices"] = object.mesh().vertex_count();
  header["faces"] = object.mesh().face_count();
  BinaryMessage message(MessageKind::mesh, std::move(header));
  add_surface(message, object.mesh(), object.triangles, object.offset);
  add_corner_uv(message, object.mesh(), object.triangles, object.triangle_faces);
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
