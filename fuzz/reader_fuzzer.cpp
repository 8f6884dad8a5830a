// Reads arbitrary bytes as a mesh file of the format MESHGRAFT_FUZZ_FORMAT. A mesh that can be read must
// survive the checks that commands make first, be written back byte for byte if unchanged, and survive an
// edit.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/topology.h>

#include "core/memory_budget.h"
#include "io/format.h"

namespace {

using meshgraft::Mesh;

const meshgraft::io::Format& format() {
  for (const meshgraft::io::Format& format : meshgraft::io::formats())
    if (format.name == MESHGRAFT_FUZZ_FORMAT) return format;
  std::abort();
}

void require(bool condition) {
  if (!condition) std::abort();
}

Mesh read(const std::string& content, const std::string& name) {
  meshgraft::MemoryBudget budget{meshgraft::Context{}};
  budget.charge(content.size());
  return format().read(content, name, budget, {});
}

std::string written(const Mesh& mesh, const std::string& name) {
  return format().write(mesh, name, {}, {}).content;
}

void try_to_write_edited(Mesh mesh, const std::string& name) {
  mesh.positions.array() *= 1.5;
  try {
    const Mesh again = read(written(mesh, name), name);
    require(again.face_count() == mesh.face_count());
  } catch (const meshgraft::Error&) {
    // The format's numbers cannot hold the edited coordinates.
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string content(reinterpret_cast<const char*>(data), size);
  // The signature tells which of glTF's two containers the content is.
  const bool has_signature = format().has_signature != nullptr && format().has_signature(content);
  const std::string name =
      "/fuzz/in" + std::string(has_signature ? format().extensions.front() : format().extensions.back());
  Mesh mesh;
  try {
    mesh = read(content, name);
  } catch (const meshgraft::Error&) {
    return 0;
  }
  meshgraft::check_mesh(mesh);
  meshgraft::summarise_topology(mesh);
  meshgraft::boundary_loops(mesh);
  require(written(mesh, name) == content);
  try_to_write_edited(std::move(mesh), name);
  return 0;
}
