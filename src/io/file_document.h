#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

#include "mesh/up_axis.h"

namespace meshgraft::io {

/// The data that every format remembers of a file.
struct FileDocument : UprightSource {
  std::filesystem::path path;

  /// Remembers the faces of the mesh, to decide later whether a mesh still belongs to this file.
  void remember_topology(const Mesh& mesh);
  bool has_topology_of(const Mesh& mesh) const;

  /// Returns the name of the format, as in `Format`.
  virtual std::string_view format() const = 0;

  /// Returns notes on the file's contents that neither the mesh nor its attributes hold, e.g. io.left_out. They
  /// are lost if the file is composed anew.
  virtual std::vector<Note> beside_the_mesh() const = 0;

  /// Returns the unit of length as the format spells it ("millimeter"). Returns an empty string if the file
  /// names none.
  virtual std::string unit() const { return {}; }

 private:
  /// A fingerprint of the faces, because a copy would take as much memory as the mesh itself. The hash has
  /// 128 bits, so two meshes do not match by chance.
  struct Topology {
    Index vertices = 0, faces = 0, corners = 0;
    std::array<std::uint64_t, 2> hash{};
    bool operator==(const Topology&) const = default;
  };
  static Topology topology_of(const Mesh& mesh);

  Topology topology_;
};

/// Returns the files behind a mesh, each once.
std::vector<const FileDocument*> documents_of(const Mesh& mesh);

/// Returns the file that the coordinates of a mesh come from: for a graft, the target's. Returns null where
/// they come from none, even if a part came from one.
const FileDocument* origin_of(const Mesh& mesh);

/// Returns the losses of a mesh that is composed anew: the notes of all files behind it.
std::vector<Note> left_out_notes(const Mesh& mesh);

}  // namespace meshgraft::io
