#include "mesh_writer.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "core/platform/file.h"
#include "io/file.h"

namespace meshgraft::distributed {

MeshWriter::MeshWriter(const Communicator& comm, std::filesystem::path output, bool in_chunks)
    : comm_(comm), output_(std::move(output)), in_chunks_(in_chunks) {
  comm.together([&] {
    if (comm.rank() != 0) return;
    const std::filesystem::path named = output_.has_filename() ? output_ : output_.parent_path();
    pending_ = follow_links(named);
    pending_ += ".part" + std::to_string(static_cast<long long>(MPI_Wtime() * 1e6));
    std::filesystem::remove(pending_);
    std::error_code error;
    if (in_chunks_) std::filesystem::create_directory(pending_, error);
    if (error) throw io::file_error(output_, facts::io::Action::create, error);
  });
  pending_ = comm.broadcast(pending_.string());
  if (in_chunks_) return;
  file_.emplace(comm.get(), pending_, MPI_MODE_CREATE | MPI_MODE_WRONLY, output_);
  comm.together([&] { file_->require_open(); });
}

MeshWriter::~MeshWriter() {
  file_.reset();
  std::error_code ignored;
  if (comm_.rank() == 0 && !pending_.empty()) std::filesystem::remove_all(pending_, ignored);
}

void MeshWriter::create(const std::filesystem::path& name) const {
  std::error_code error;
  const platform::File created(pending_ / name, platform::OpenMode::create, error);
  if (error) throw io::file_error(output_ / name, facts::io::Action::create, error);
}

void MeshWriter::write(const std::filesystem::path& name, std::uint64_t at, const char* bytes,
                       std::uint64_t size) {
  if (in_chunks_ && (!file_ || name != open_name_)) {
    close_chunk();
    file_.emplace(MPI_COMM_SELF, pending_ / name, MPI_MODE_WRONLY, output_ / name);
    file_->require_open();
    open_name_ = name;
  }
  file_->write(at, bytes, size);
}

void MeshWriter::write(const RecordTable& table, Number first, Number count, const char* bytes) {
  for (const RecordFile& file : table.files) {
    const Number begin = std::max(first, file.first), end = std::min(first + count, file.end());
    if (begin >= end) continue;
    write(file.path.filename(), table.byte_of(file, begin),
          bytes + table.size * static_cast<std::uint64_t>(begin - first),
          table.size * static_cast<std::uint64_t>(end - begin));
  }
}

void MeshWriter::close_chunk() {
  if (!file_) return;
  file_->finish();
  const SharedFile& file = *file_;
  file.require_finished();
  file_.reset();
}

void MeshWriter::appear() {
  if (!in_chunks_) {
    file_->finish();
    comm_.together([&] { file_->require_finished(); });
    file_.reset();
  } else {
    comm_.together([&] { close_chunk(); });
  }
  comm_.together([&] {
    if (comm_.rank() != 0) return;
    const std::filesystem::path named = output_.has_filename() ? output_ : output_.parent_path();
    if (in_chunks_) platform::flush_folder(pending_);
    std::error_code error;
    std::filesystem::rename(pending_, follow_links(named), error);
    if (error) throw io::file_error(output_, facts::io::Action::replace, error);
    pending_.clear();
  });
}

}  // namespace meshgraft::distributed
