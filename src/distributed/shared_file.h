#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>

#include "io/facts.h"

namespace meshgraft::distributed {

/// Bytes that a rank reads or writes at once.
constexpr std::uint64_t block_bytes = std::uint64_t{16} << 20;

/// A file that is open by MPI-IO on all ranks of an MPI communicator. Throws Error(io).
class SharedFile {
 public:
  /// Opens `path`, on all ranks of `comm` together. Errors are about `named`. Another rank than that of the
  /// error does not throw; `require_open` tells it.
  SharedFile(MPI_Comm comm, const std::filesystem::path& path, int mode, std::filesystem::path named);
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;
  ~SharedFile();

  /// Throws if the file could not be opened.
  void require_open() const { require(opened_, facts::io::Action::open); }
  void read(std::uint64_t at, char* bytes, std::uint64_t size) const;
  void write(std::uint64_t at, const char* bytes, std::uint64_t size) const;
  /// Flushes and closes the file, on all ranks together. `require_finished` throws if that failed.
  void finish();
  void require_finished() const;

 private:
  void require(int status, facts::io::Action action) const;
  void require_all(const MPI_Status& status, std::uint64_t size, facts::io::Action action) const;

  std::filesystem::path path_;
  MPI_File file_ = MPI_FILE_NULL;
  int opened_ = MPI_SUCCESS, flushed_ = MPI_SUCCESS, closed_ = MPI_SUCCESS;
};

}  // namespace meshgraft::distributed
