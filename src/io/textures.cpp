#include "textures.h"

#include <filesystem>
#include <iterator>
#include <system_error>
#include <utility>

#include "gltf/images.h"
#include "mesh/join.h"
#include "obj/materials.h"
#include "ply/document.h"

namespace meshgraft {

namespace {

std::vector<MaterialTexture> textures_in(const SourceDocument* source) {
  if (const auto* obj = dynamic_cast<const io::ObjDocument*>(source)) return io::textures_of(*obj);
  if (const auto* gltf = dynamic_cast<const io::GltfDocument*>(source)) return io::textures_of(*gltf);
  return {};
}

// Returns the textures of a PLY file, which has no materials: one for all faces, or those that `texnumber`
// counts.
std::vector<MaterialTexture> textures_without_material(const SourceDocument* source) {
  std::vector<MaterialTexture> textures;
  const auto* ply = dynamic_cast<const io::PlyDocument*>(source);
  if (ply == nullptr) return textures;
  for (const std::filesystem::path& file : io::texture_files(*ply)) {
    std::error_code ignored;
    textures.push_back(
        {{}, std::filesystem::is_regular_file(file, ignored) ? file : std::filesystem::path(), {}});
  }
  return textures;
}

}  // namespace

std::vector<MaterialTexture> textures_of(const Mesh& mesh) {
  std::vector<MaterialTexture> textures = textures_without_material(mesh.source.get());
  const auto sources = sources_of(mesh);
  if (!sources) return textures;
  for (const JoinedSources::File& source : sources->files)
    for (MaterialTexture& texture : textures_in(source.document.get()))
      for (const auto& [in_file, now] : source.materials)
        if (in_file == texture.material) textures.push_back({now, texture.file, texture.bytes});
  return textures;
}

}  // namespace meshgraft
