#include "shared_file.h"

#include <string>
#include <system_error>
#include <utility>

#include <meshgraft/core/error.h>

#include "distributed/facts.h"
#include "io/file.h"

namespace meshgraft::distributed {

SharedFile::SharedFile(MPI_Comm comm, const std::filesystem::path& path, int mode, std::filesystem::path named)
    : path_(std::move(named)) {
  opened_ = MPI_File_open(comm, path.c_str(), mode, MPI_INFO_NULL, &file_);
}

SharedFile::~SharedFile() {
  if (file_ != MPI_FILE_NULL) MPI_File_close(&file_);
}

void SharedFile::read(std::uint64_t at, char* bytes, std::uint64_t size) const {
  MPI_Status status;
  require(
      MPI_File_read_at(file_, static_cast<MPI_Offset>(at), bytes, static_cast<int>(size), MPI_BYTE, &status),
      facts::io::Action::read);
  require_all(status, size, facts::io::Action::read);
}

void SharedFile::write(std::uint64_t at, const char* bytes, std::uint64_t size) const {
  MPI_Status status;
  require(
      MPI_File_write_at(file_, static_cast<MPI_Offset>(at), bytes, static_cast<int>(size), MPI_BYTE, &status),
      facts::io::Action::write);
  require_all(status, size, facts::io::Action::write);
}

void SharedFile::finish() {
  flushed_ = MPI_File_sync(file_);
  closed_ = MPI_File_close(&file_);
}

void SharedFile::require_finished() const {
  require(flushed_, facts::io::Action::flush);
  require(closed_, facts::io::Action::write);
}

void SharedFile::require(int status, facts::io::Action action) const {
  if (status == MPI_SUCCESS) return;
  int kind = MPI_SUCCESS, length = 0;
  char text[MPI_MAX_ERROR_STRING];
  MPI_Error_class(status, &kind);
  MPI_Error_string(status, text, &length);
  const auto fail = [&](std::errc code) { throw io::file_error(path_, action, std::make_error_code(code)); };
  if (kind == MPI_ERR_NO_SPACE || kind == MPI_ERR_QUOTA) fail(std::errc::no_space_on_device);
  if (kind == MPI_ERR_NO_SUCH_FILE) fail(std::errc::no_such_file_or_directory);
  if (kind == MPI_ERR_ACCESS) fail(std::errc::permission_denied);
  throw Error(facts::io::FileFailed{.action = action, .reason = std::string(text, length)}, path_);
}

void SharedFile::require_all(const MPI_Status& status, std::uint64_t size, facts::io::Action action) const {
  int count = 0;
  MPI_Get_count(&status, MPI_BYTE, &count);
  if (static_cast<std::uint64_t>(count) == size) return;
  if (action == facts::io::Action::write)
    throw io::file_error(path_, action, std::make_error_code(std::errc::no_space_on_device));
  throw Error(facts::distributed::FileShrank{}, path_);
}

}  // namespace meshgraft::distributed
