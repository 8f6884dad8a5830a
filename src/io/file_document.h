#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::io {

/// What every format remembers of a file.
struct FileDocument : SourceDocument {
  std::filesystem::path path;

  /// Remembers which faces the mesh has, to tell later whether a mesh still belongs to this file.
  void remember_topology(const Mesh& mesh);
  bool has_topology_of(const Mesh& mesh) const;

  /// What of the file neither the mesh nor its attributes hold, e.g. "3 'l' lines"; lost where a file is
  /// composed anew.
  virtual std::vector<std::string> beside_the_mesh() const = 0;

  /// What a length of 1 means, as the format spells it ("millimeter"); empty where the file does not tell.
  virtual std::string unit() const { return {}; }

 private:
  /// Stands for the faces, which would be as much as the mesh itself: two of 128 bits do not come to be equal
  /// by chance.
  struct Topology {
    Index vertices = 0, faces = 0, corners = 0;
    std::array<std::uint64_t, 2> hash{};
    bool operator==(const Topology&) const = default;
  };
  static Topology topology_of(const Mesh& mesh);

  Topology topology_;
};

/// The files behind a mesh, each once.
std::vector<const FileDocument*> documents_of(const Mesh& mesh);

/// For a mesh that is composed anew: what its files lose by that, a sentence each.
std::vector<std::string> left_out_notes(const Mesh& mesh);

}  // namespace meshgraft::io
