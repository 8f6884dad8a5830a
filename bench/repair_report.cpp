// Prints the table of dirty scans in docs/repair.md as Markdown. Given a folder, also writes the scans before
// and after.

#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/repair.h>

#include "support/defects.h"

int main(int argc, char** argv) {
  using namespace meshgraft;
  fmt::print(
      "| scan | damage | deforms as it is | what was changed | deforms repaired |\n|---|---|---|---|---|\n");
  int before = 0, after = 0, all = 0;
  for (const test::DirtyScan& scan : test::dirty_scans()) {
    const RepairResult result = repair(scan.mesh);
    const test::Trial given = test::try_deform(scan.mesh), repaired = test::try_deform(result.mesh);
    std::string changes;
    for (const RepairChange& change : result.changes)
      changes += fmt::format("{}{} {}", changes.empty() ? "" : ", ", change.count, name_of(change.kind));
    fmt::print("| {} | {} | {} | {} | {} |\n", scan.name, scan.damage,
               given.works ? "yes" : "no: " + given.reason, changes,
               repaired.works ? "yes" : "no: " + repaired.reason);
    std::fflush(stdout);
    before += given.works;
    after += repaired.works;
    ++all;
    if (argc > 1) {
      write_mesh(scan.mesh, std::filesystem::path(argv[1]) / (scan.name + ".ply"));
      write_mesh(result.mesh, std::filesystem::path(argv[1]) / (scan.name + "-repaired.ply"));
    }
  }
  fmt::print("\n{} of {} deform as they are, {} repaired.\n", before, all, after);
  return 0;
}
