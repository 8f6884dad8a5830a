#pragma once

#include <mpi.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include <meshgraft/core/error.h>
#include <meshgraft/distributed.h>
#include <meshgraft/script/run_edit.h>

namespace meshgraft::distributed {

/// The files and the settings of a distributed run of an edit file.
struct RunRequest {
  std::filesystem::path edit, output, report;  ///< an empty report is not requested
  SettingsOverrides overrides;
  Preconditioner preconditioner = Preconditioner::blended;
  double tolerance = DistributedOptions{}.tolerance;
  bool force = false;  ///< the output may replace the input
  /// Throws if an output cannot be written, or would replace another file of the edit, whose mesh is in
  /// `input`. Every rank calls it before the work, because errors of the program itself cannot be sent to other
  /// ranks.
  std::function<void(const std::filesystem::path& input)> check_outputs;
};

/// Runs an edit file of one deform step on a binary PLY file or a mesh in chunks, and writes the result as
/// `meshgraft deform` does. All ranks call it together. The report is in the words of `wording`. Where one rank
/// fails, all ranks throw the same error, and no output is left behind.
void run_distributed(MPI_Comm comm, const RunRequest& request, const Wording& wording);

}  // namespace meshgraft::distributed
