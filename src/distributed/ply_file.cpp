#include "ply_file.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "core/memory_budget.h"
#include "core/platform/file.h"
#include "distributed/facts.h"
#include "io/binary_value.h"
#include "io/facts.h"
#include "io/file.h"
#include "io/number_text.h"

namespace meshgraft::distributed {

namespace {

/// Bytes that a rank reads or writes at once.
constexpr std::uint64_t block_bytes = std::uint64_t{16} << 20;

/// An open file of all ranks of a communicator.
class SharedFile {
 public:
  /// Opens `path`. Errors are about `named`.
  SharedFile(const Communicator& comm, const std::filesystem::path& path, int mode, std::filesystem::path named)
      : path_(std::move(named)) {
    const int status = MPI_File_open(comm.get(), path.c_str(), mode, MPI_INFO_NULL, &file_);
    comm.together([&] { require(status, facts::io::Action::open); });
  }
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;
  ~SharedFile() {
    if (file_ != MPI_FILE_NULL) MPI_File_close(&file_);
  }

  void read(std::uint64_t at, char* bytes, std::uint64_t size) const {
    MPI_Status status;
    require(
        MPI_File_read_at(file_, static_cast<MPI_Offset>(at), bytes, static_cast<int>(size), MPI_BYTE, &status),
        facts::io::Action::read);
    require_all(status, size, facts::io::Action::read);
  }
  void write(std::uint64_t at, const char* bytes, std::uint64_t size) const {
    MPI_Status status;
    require(
        MPI_File_write_at(file_, static_cast<MPI_Offset>(at), bytes, static_cast<int>(size), MPI_BYTE, &status),
        facts::io::Action::write);
    require_all(status, size, facts::io::Action::write);
  }
  /// Flushes and closes the file on all ranks.
  void finish(const Communicator& comm) {
    const int flushed = MPI_File_sync(file_);
    const int closed = MPI_File_close(&file_);
    comm.together([&] {
      require(flushed, facts::io::Action::flush);
      require(closed, facts::io::Action::write);
    });
  }

 private:
  void require(int status, facts::io::Action action) const {
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
  void require_all(const MPI_Status& status, std::uint64_t size, facts::io::Action action) const {
    int count = 0;
    MPI_Get_count(&status, MPI_BYTE, &count);
    if (static_cast<std::uint64_t>(count) == size) return;
    if (action == facts::io::Action::write)
      throw io::file_error(path_, action, std::make_error_code(std::errc::no_space_on_device));
    throw Error(facts::distributed::FileShrank{}, path_);
  }

  std::filesystem::path path_;
  MPI_File file_ = MPI_FILE_NULL;
};

/// Returns the beginning of the file with its header, and sets the size of the file.
std::string read_beginning(const std::filesystem::path& path, std::uint64_t& file_bytes) {
  std::error_code error;
  platform::File file(path, platform::OpenMode::read, error);
  if (error) throw io::file_error(path, facts::io::Action::open, error);
  const platform::File::Status status = file.status(error);
  if (error) throw io::file_error(path, facts::io::Action::read, error);
  if (status.type == std::filesystem::file_type::directory) throw Error(facts::io::IsFolder{}, path);
  file_bytes = status.bytes;
  constexpr std::size_t longest = std::size_t{16} << 20, step = std::size_t{64} << 10;
  std::string beginning;
  while (beginning.size() < longest && beginning.find("end_header") == std::string::npos) {
    const std::size_t size = beginning.size();
    beginning.resize(size + step);
    const std::size_t got = file.read(beginning.data() + size, step, error);
    beginning.resize(size + got);
    if (error) throw io::file_error(path, facts::io::Action::read, error);
    if (got == 0) break;
  }
  return beginning;
}

std::vector<Number> equal_shares(Number count, int ranks) {
  std::vector<Number> starts(static_cast<std::size_t>(ranks) + 1);
  for (int rank = 0; rank <= ranks; ++rank)
    starts[static_cast<std::size_t>(rank)] = count / ranks * rank + std::min<Number>(rank, count % ranks);
  return starts;
}

std::uint64_t offset_of(const io::PlyElement& element, std::size_t property, std::uint64_t corners) {
  std::uint64_t offset = 0;
  for (std::size_t p = 0; p < property; ++p) {
    const io::PlyProperty& before = element.properties[p];
    offset += before.is_list ? io::size_of(before.count_type) + corners * io::size_of(before.type)
                             : io::size_of(before.type);
  }
  return offset;
}

/// Returns the properties of these names, or nothing if one is missing or a list.
std::optional<VertexProperties> find_properties(const io::PlyElement& element,
                                                const std::array<const char*, 3>& names) {
  VertexProperties found;
  for (const char* name : names) {
    const auto property = std::ranges::find(element.properties, name, &io::PlyProperty::name);
    if (property == element.properties.end() || property->is_list) return {};
    found.offset.push_back(
        offset_of(element, static_cast<std::size_t>(property - element.properties.begin()), 0));
    found.type.push_back(property->type);
  }
  return found;
}

}  // namespace

PlyFile::PlyFile(const Communicator& comm, std::filesystem::path path) : comm_(comm), path_(std::move(path)) {
  std::string beginning;
  comm.together([&] {
    if (comm.rank() == 0) beginning = read_beginning(path_, bytes_);
  });
  beginning = comm.broadcast(std::move(beginning));
  bytes_ = static_cast<std::uint64_t>(comm.largest(static_cast<Number>(bytes_)));
  comm.together([&] { read_header(beginning, bytes_); });
  vertex_starts_ = equal_shares(vertices_.count, comm.size());
  face_starts_ = equal_shares(faces_.count, comm.size());
}

/// Finds the records. The header's counts fit the file, because its parser compares them.
void PlyFile::read_header(const std::string& beginning, std::uint64_t file_bytes) {
  MemoryBudget budget{Context{}};
  const io::PlyHeader header = io::parse_ply_header(beginning, path_.string(), budget, file_bytes);
  if (header.encoding == io::PlyEncoding::ascii) throw Error(facts::distributed::NotBinary{}, path_);
  swap_ = io::needs_swap(header.encoding);
  std::uint64_t at = header.size;
  constexpr std::uint64_t triangle = 3;
  for (const io::PlyElement& element : header.elements) {
    const auto list = std::ranges::find_if(element.properties, &io::PlyProperty::is_list);
    const bool is_face = element.name == "face";
    const auto lists = std::ranges::count_if(element.properties, &io::PlyProperty::is_list);
    if (lists > (is_face ? 1 : 0)) {
      if (vertices_.count > 0 && faces_.count > 0) return;  // what follows is copied as it is
      throw Error(facts::distributed::RecordsOfDifferentSize{.element = element.name}, path_);
    }
    const RecordRange range{at, offset_of(element, element.properties.size(), triangle),
                            static_cast<Number>(element.count)};
    at = range.end();
    if (at > file_bytes)
      throw Error(facts::io::TooShort{.element = element.name, .count = element.count}, path_);
    if (is_face && list != element.properties.end()) {
      faces_ = range;
      corners_offset_ =
          offset_of(element, static_cast<std::size_t>(list - element.properties.begin()), triangle);
      count_type_ = list->count_type;
      corner_type_ = list->type;
    }
    if (element.name != "vertex") continue;
    vertices_ = range;
    const auto positions = find_properties(element, {"x", "y", "z"});
    if (!positions)
      throw Error(facts::io::MissingProperty{.element = element.name, .property = "x, y, z"}, path_);
    positions_ = *positions;
    normals_ = find_properties(element, {"nx", "ny", "nz"});
  }
  if (faces_.count == 0) throw Error(facts::core::NoFaces{}, path_);
  if (at < file_bytes) throw Error(facts::io::TrailingData{.element = header.elements.back().name}, path_);
}

/// Reads records `first` to `end` in blocks, and calls body(bytes, first record, number of records, byte).
template <class Body>
void PlyFile::for_each_block(const RecordRange& range, Number first, Number end, const Body& body) const {
  const SharedFile file(comm_, path_, MPI_MODE_RDONLY, path_);
  comm_.together([&] {
    const auto at_once = static_cast<Number>(std::max<std::uint64_t>(1, block_bytes / range.size));
    std::vector<char> bytes;
    for (Number record = first; record < end; record += at_once) {
      const Number count = std::min(at_once, end - record);
      const std::uint64_t at = range.begin + range.size * static_cast<std::uint64_t>(record);
      bytes.resize(range.size * static_cast<std::uint64_t>(count));
      file.read(at, bytes.data(), bytes.size());
      body(bytes.data(), record, count, at);
    }
  });
}

Points PlyFile::read(const VertexProperties& properties) const {
  const Number first = vertex_starts_[comm_.rank()], end = vertex_starts_[comm_.rank() + 1];
  Points values(end - first, 3);
  for_each_block(vertices_, first, end, [&](char* bytes, Number record, Number count, std::uint64_t) {
    for (std::size_t k = 0; k < 3; ++k)
      io::load_binary_column({bytes + properties.offset[k], vertices_.size, properties.type[k], swap_},
                             static_cast<std::size_t>(count), values.data() + 3 * (record - first) + k, 3);
  });
  return values;
}

std::vector<NumberedTriangle> PlyFile::read_triangles() const {
  const Number first = face_starts_[comm_.rank()], end = face_starts_[comm_.rank() + 1];
  std::vector<NumberedTriangle> triangles;
  triangles.reserve(end - first);
  const auto read_face = [&](const char* record, Number face) {
    const char* at = record + corners_offset_;
    const Location location = Location(path_) / Location::place("face " + std::to_string(face));
    if (io::load_binary(at, count_type_, swap_) != 3) throw Error(facts::distributed::NotATriangle{}, location);
    std::array<Index, 3> corners{};
    if (!io::load_binary_corners(at + io::size_of(count_type_), corner_type_, swap_, corners))
      throw Error(facts::distributed::FaceOfNoVertex{.count = vertices_.count}, location);
    if (std::ranges::any_of(corners, [&](Index v) { return v < 0 || v >= vertices_.count; }))
      throw Error(facts::distributed::FaceOfNoVertex{.count = vertices_.count}, location);
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) return;
    triangles.push_back({face, {corners[0], corners[1], corners[2]}});
  };
  for_each_block(faces_, first, end, [&](const char* bytes, Number record, Number count, std::uint64_t) {
    for (Number k = 0; k < count; ++k)
      read_face(bytes + faces_.size * static_cast<std::uint64_t>(k), record + k);
  });
  return triangles;
}

void PlyFile::write(const std::filesystem::path& output, const Changes& changes) const {
  std::filesystem::path pending;
  comm_.together([&] {
    if (comm_.rank() == 0) {
      pending = follow_links(output);
      pending += ".part" + std::to_string(static_cast<long long>(MPI_Wtime() * 1e6));
      std::filesystem::remove(pending);
    }
  });
  pending = comm_.broadcast(pending.string());
  try {
    SharedFile to(comm_, pending, MPI_MODE_CREATE | MPI_MODE_WRONLY, output);
    const Number first = vertex_starts_[comm_.rank()], end = vertex_starts_[comm_.rank() + 1];
    for_each_block(vertices_, first, end, [&](char* bytes, Number record, Number count, std::uint64_t at) {
      const auto patch = [&](const VertexProperties& properties, const Points& before, const Points& after) {
        for (Number k = 0; k < count; ++k)
          for (std::size_t c = 0; c < 3; ++c) {
            const double value = after(record - first + k, static_cast<Eigen::Index>(c));
            if (value == before(record - first + k, static_cast<Eigen::Index>(c))) continue;
            io::store_binary(bytes + vertices_.size * static_cast<std::uint64_t>(k) + properties.offset[c],
                             value, properties.type[c], swap_);
          }
      };
      patch(positions_, changes.positions_before, changes.positions_after);
      if (normals_) patch(*normals_, changes.normals_before, changes.normals_after);
      to.write(at, bytes, vertices_.size * static_cast<std::uint64_t>(count));
    });
    const auto copy_share = [&](std::uint64_t begin, std::uint64_t size) {
      const std::vector<Number> share = equal_shares(static_cast<Number>(size), comm_.size());
      for_each_block({begin, 1, static_cast<Number>(size)}, share[comm_.rank()], share[comm_.rank() + 1],
                     [&](const char* bytes, Number, Number count, std::uint64_t at) {
                       to.write(at, bytes, static_cast<std::uint64_t>(count));
                     });
    };
    copy_share(0, vertices_.begin);
    copy_share(vertices_.end(), bytes_ - vertices_.end());
    to.finish(comm_);
    comm_.together([&] {
      if (comm_.rank() == 0) std::filesystem::rename(pending, follow_links(output));
    });
  } catch (...) {
    std::error_code ignored;
    if (comm_.rank() == 0) std::filesystem::remove(pending, ignored);
    throw;
  }
}

}  // namespace meshgraft::distributed
