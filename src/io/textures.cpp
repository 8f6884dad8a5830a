#include <meshgraft/io/textures.h>

#include <iterator>
#include <utility>

#include <meshgraft/mesh/join.h>

#include "gltf/images.h"
#include "obj/materials.h"

namespace meshgraft {

namespace {

std::vector<MaterialTexture> textures_in(const SourceDocument* source) {
  if (const auto* obj = dynamic_cast<const io::ObjDocument*>(source)) return io::textures_of(*obj);
  if (const auto* gltf = dynamic_cast<const io::GltfDocument*>(source)) return io::textures_of(*gltf);
  return {};
}

}  // namespace

std::vector<MaterialTexture> textures_of(const Mesh& mesh) {
  std::vector<MaterialTexture> textures;
  const auto sources = sources_of(mesh);
  if (!sources) return textures;
  for (const JoinedSources::Part& part : sources->parts)
    for (MaterialTexture& texture : textures_in(part.source.get()))
      for (const auto& [in_file, now] : part.materials)
        if (in_file == texture.material) textures.push_back({now, texture.file, texture.bytes});
  return textures;
}

}  // namespace meshgraft
