#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::io {

/// What every format remembers of a file.
struct FileDocument : SourceDocument {
  std::filesystem::path path;
  Faces faces;             ///< as read
  Index vertex_count = 0;  ///< as read

  /// Keeps the mesh's faces, to tell later whether a mesh still belongs to this file.
  void remember_topology(const Mesh& mesh);
  bool has_topology_of(const Mesh& mesh) const;

  /// What of the file neither the mesh nor its attributes hold, e.g. "3 'l' lines"; lost where a file is
  /// composed anew.
  virtual std::vector<std::string> beside_the_mesh() const = 0;

  /// What a length of 1 means, as the format spells it ("millimeter"); empty where the file does not tell.
  virtual std::string unit() const { return {}; }
};

/// The files behind a mesh, each once.
std::vector<const FileDocument*> documents_of(const Mesh& mesh);

/// For a mesh that is composed anew: what its files lose by that, a sentence each.
std::vector<std::string> left_out_notes(const Mesh& mesh);

}  // namespace meshgraft::io
