#include "journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "edit/sha256.h"
#include "folders.h"
#include "server/utf8.h"

namespace meshgraft::editor {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

constexpr int most_sessions = 9;  // that are open on one model

[[noreturn]] void fail(const fs::path& path) {
  throw Error(ErrorCode::io, "the journal cannot be written: " + std::generic_category().message(errno),
              path.string(), "Make room, or save to another place.");
}

fs::path numbered(const fs::path& stem, int number) {
  return number == 1 ? stem : fs::path(stem.string() + fmt::format("-{}", number));
}

// A page that is loaded again comes before the session of the old one has ended.
constexpr auto patience = 1s;

bool lock(int file, std::chrono::milliseconds wait) {
  const auto until = std::chrono::steady_clock::now() + wait;
  while (::flock(file, LOCK_EX | LOCK_NB) != 0) {
    if (std::chrono::steady_clock::now() >= until) return false;
    std::this_thread::sleep_for(10ms);
  }
  return true;
}

bool is_at(const fs::path& path, int file) {
  struct stat there{}, here{};
  return ::stat(path.c_str(), &there) == 0 && ::fstat(file, &here) == 0 && there.st_ino == here.st_ino &&
         there.st_dev == here.st_dev;
}

// Applies a line; false where it is none.
bool take_line(const Json& line, std::optional<JournalContent>& content) {
  if (!content) {
    if (line.value("format", "") != "meshgraft-session" || line.at("version") != 1) return false;
    content = JournalContent{History(line.at("document").get<std::string>())};
    return true;
  }
  History& history = content->history;
  if (line.contains("saved")) return content->saved = true;
  if (line.contains("undo")) {
    if (!history.can_undo()) return false;
    history.undo();
  } else if (line.contains("redo")) {
    if (!history.can_redo()) return false;
    history.redo();
  } else if (line.contains("document")) {
    history.add(line.at("label"), line.at("document"));
  } else {
    const Json patched = Json::parse(history.current()).patch(line.at("patch"));
    history.add(line.at("label"), make_document(patched, {}).text);
  }
  ++content->changes;
  content->saved = false;
  return true;
}

}  // namespace

// What is behind a model's name must find room in a file's, too, with what is put behind that.
fs::path journal_of(const fs::path& model) {
  constexpr std::size_t most_bytes = 200;
  const std::string name = model.filename().string();
  const std::string short_name = name.size() <= most_bytes
                                     ? name
                                     : whole_characters(name, most_bytes - 9) + "-" + sha256(name).substr(0, 8);
  return model.parent_path() / (short_name + ".meshgraft-session");
}

std::optional<JournalContent> read_journal(std::string_view text) {
  std::optional<JournalContent> content;
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find('\n', begin)) != std::string_view::npos; begin = end + 1) {
    try {
      if (!take_line(Json::parse(text.substr(begin, end - begin)), content)) break;
    } catch (const std::exception&) {  // whatever is wrong with a line, those before it count
      break;
    }
    if (content) content->valid_bytes = end + 1;
  }
  return content;
}

Journal::Journal(const fs::path& path) : stem_(journal_of(path)) {
  if (!open(false)) return;
  found_ = read_journal(read_file(path_));
  if (found_ && found_->changes > 0 && !found_->saved) return;
  if (found_ && ::ftruncate(file_, 0) != 0) fail(path_);  // all of it is saved: it goes with this session
  found_.reset();
}

Journal::~Journal() {
  if (file_ < 0) return;
  const bool needless = started_ ? saved_ : ::lseek(file_, 0, SEEK_END) == 0;
  if (needless) {
    std::error_code ignored;
    fs::remove_all(kept_folder(), ignored);
    ::unlink(path_.c_str());
  }
  ::close(file_);
}

// Takes the first file that no other session has.
bool Journal::open(bool create) {
  for (int number = 1; number <= most_sessions; ++number) {
    path_ = numbered(stem_, number);
    const int file = ::open(path_.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | (create ? O_CREAT : 0), 0600);
    if (file < 0) continue;
    const bool locked = lock(file, number == 1 ? patience : 0s);
    if (locked && is_at(path_, file)) {
      file_ = file;
      return true;
    }
    ::close(file);
    if (locked) --number;  // the session that had it took it away at its end: once more
  }
  if (create) fail(stem_);
  path_ = stem_;
  return false;
}

void Journal::take_up() {
  if (file_ < 0) return;
  const auto size = static_cast<std::uintmax_t>(::lseek(file_, 0, SEEK_END));
  if (size > found_->valid_bytes && read_file(path_).find('\n', found_->valid_bytes) != std::string::npos)
    fs::copy_file(path_, path_.string() + ".damaged", fs::copy_options::overwrite_existing);
  if (::ftruncate(file_, static_cast<off_t>(found_->valid_bytes)) != 0) fail(path_);
  ::lseek(file_, 0, SEEK_END);
  started_ = true;
  saved_ = false;
  found_.reset();
}

fs::path Journal::set_aside() {
  fs::path aside;
  for (int number = 1; aside.empty() || fs::exists(aside); ++number)
    aside = path_.string() + fmt::format(".aside-{}", number);
  fs::rename(path_, aside);
  if (fs::exists(kept_folder())) fs::rename(kept_folder(), aside.string() + ".parts");
  ::close(std::exchange(file_, -1));
  found_.reset();
  return aside;
}

fs::path Journal::keep(const fs::path& file) {
  if (file_ < 0) open(true);
  fs::create_directories(kept_folder());
  return copy_into(kept_folder(), file);
}

void Journal::start(const std::string& first) {
  if (file_ < 0) open(true);
  if (::ftruncate(file_, 0) != 0 || ::lseek(file_, 0, SEEK_SET) != 0) fail(path_);
  started_ = true;
  write_line({{"format", "meshgraft-session"}, {"version", 1}, {"document", first}});
}

void Journal::add(const std::string& label, const std::string& before, const std::string& after) {
  if (!started_) start(before);
  Json line = {{"label", label}, {"patch", Json::diff(Json::parse(before), Json::parse(after))}};
  if (line["patch"].dump().size() >= after.size()) line = {{"label", label}, {"document", after}};
  write_line(line);
}

void Journal::undo() {
  if (started_) write_line({{"undo", true}});
}

void Journal::redo() {
  if (started_) write_line({{"redo", true}});
}

void Journal::mark_saved() {
  if (!started_) return;
  write_line({{"saved", true}});
  saved_ = true;
}

void Journal::write_line(const Json& line) {
  const std::string text = line.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
  const off_t begin = ::lseek(file_, 0, SEEK_CUR);
  std::string_view left = text;
  while (!left.empty()) {
    const ssize_t written = ::write(file_, left.data(), left.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) break;
    left.remove_prefix(static_cast<std::size_t>(written));
  }
  if (!left.empty() || ::fsync(file_) != 0) {
    const int reason = errno;
    if (::ftruncate(file_, begin) == 0) ::lseek(file_, begin, SEEK_SET);
    errno = reason;
    fail(path_);
  }
  saved_ = false;
}

}  // namespace meshgraft::editor
