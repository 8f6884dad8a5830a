#include "journal.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/script/edit_file.h>

#include "editor/facts.h"
#include "folders.h"
#include "io/file.h"
#include "script/json_value.h"
#include "script/sha256.h"
#include "server/utf8.h"

namespace meshgraft::editor {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

constexpr int most_sessions = 9;  // open at once on one model

void require_written(const std::error_code& error, const fs::path& path) {
  if (error) throw Error(facts::editor::JournalNotWritten{.reason = error.message()}, path);
}

fs::path numbered(const fs::path& stem, int number) {
  return number == 1 ? stem : fs::path(stem.string() + fmt::format("-{}", number));
}

// A reloaded page opens its session before the session of the old page has ended.
constexpr auto patience = 1s;

std::error_code lock_within(platform::File& file, std::chrono::milliseconds wait) {
  const auto until = std::chrono::steady_clock::now() + wait;
  for (;;) {
    const std::error_code error = file.try_lock();
    if (!error || std::chrono::steady_clock::now() >= until) return error;
    std::this_thread::sleep_for(10ms);
  }
}

// Returns the name of a line's change. Journals of earlier versions have blanks in it.
std::string change_of(const Json& line) {
  std::string change = line.at("label");
  std::replace(change.begin(), change.end(), ' ', '_');
  return change;
}

// Applies a line of a journal; returns false where it is not valid.
bool take_line(const Json& line, const fs::path& folder, std::optional<JournalContent>& content) {
  if (!content) {
    if (line.value("format", "") != "meshgraft-session" || line.at("version") != 1) return false;
    content = JournalContent{History(line.at("document").get<std::string>())};
    return true;
  }
  History& history = content->history;
  if (line.contains("saved")) {
    if (line.contains("edit"))
      content->saved_edit = {(folder / line.at("edit").get<std::string>()).lexically_normal(),
                             line.at("sha256"), history.current()};
    return content->saved = true;
  }
  if (line.contains("undo")) {
    if (!history.can_undo()) return false;
    history.undo();
    if (line.value("forget", false)) history.forget_undone();
  } else if (line.contains("redo")) {
    if (!history.can_redo()) return false;
    history.redo();
  } else if (line.contains("document")) {
    history.add(change_of(line), line.at("document"));
  } else {
    const Json current = json::parse(history.current(), {}, edit_file_depth_limit);
    const Json patched = current.patch(line.at("patch"));
    history.add(change_of(line), make_document(patched, {}).text);
  }
  ++content->changes;
  content->saved = false;
  return true;
}

}  // namespace

// The journal's name contains the model's name, so it is shortened to leave room for the suffixes within a
// file name.
fs::path journal_of(const fs::path& model) {
  constexpr std::size_t most_bytes = 200;
  const std::string name = model.filename().string();
  const std::string short_name = name.size() <= most_bytes
                                     ? name
                                     : whole_characters(name, most_bytes - 9) + "-" + sha256(name).substr(0, 8);
  return model.parent_path() / (short_name + ".meshgraft-session");
}

std::optional<JournalContent> read_journal(std::string_view text, const fs::path& folder) {
  std::optional<JournalContent> content;
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find('\n', begin)) != std::string_view::npos; begin = end + 1) {
    try {
      // A line holds a document in a string, or a patch, whose values lie two levels deeper than in a document.
      const std::string_view line = text.substr(begin, end - begin);
      if (line.size() > edit_file_size_limit) break;
      if (!take_line(json::parse(line, {}, edit_file_depth_limit + 2), folder, content)) break;
    } catch (const std::exception&) {  // the lines before a damaged one count
      break;
    }
    if (content) content->valid_bytes = end + 1;
  }
  return content;
}

Journal::Journal(const fs::path& path) : stem_(journal_of(path)) {
  if (!open(false)) return;
  const std::string text = read_file(path_);
  found_ = read_journal(text, path_.parent_path());
  if (!found_ && !text.empty()) {
    unreadable_ = set_aside();
    return;
  }
  if (found_ && found_->changes > 0 && !found_->saved) return;
  if (found_) require_written(file_.resize(0), path_);  // all of it is saved: it is removed with this session
  found_.reset();
  std::error_code ignored;
  fs::remove(path_.string() + ".running", ignored);
}

Journal::~Journal() {
  if (!file_.is_open()) return;
  std::error_code error;
  const bool needless = started_ ? saved_ : file_.status(error).bytes == 0 && !error;
  if (!needless) return;
  fs::remove_all(kept_folder(), error);
  fs::remove(path_, error);
}

// Opens the first journal file that no other session has locked.
bool Journal::open(bool create) {
  std::error_code error;
  for (int number = 1; number <= most_sessions; ++number) {
    path_ = numbered(stem_, number);
    platform::File file(path_, create ? platform::OpenMode::append_or_create : platform::OpenMode::append,
                        error);
    if (error) continue;
    error = lock_within(file, number == 1 ? patience : 0s);
    if (error) continue;
    if (file.is_at(path_)) {
      file_ = std::move(file);
      return true;
    }
    --number;  // its session deleted it meanwhile: try again
  }
  if (create) require_written(error, stem_);
  path_ = stem_;
  return false;
}

fs::path Journal::running_file() const {
  return file_.is_open() && (started_ || found_) ? fs::path(path_.string() + ".running") : fs::path();
}

void Journal::take_up() {
  if (!file_.is_open()) return;
  std::error_code error;
  const std::uintmax_t size = file_.status(error).bytes;
  require_written(error, path_);
  if (size > found_->valid_bytes && read_file(path_).find('\n', found_->valid_bytes) != std::string::npos)
    fs::copy_file(path_, path_.string() + ".damaged", fs::copy_options::overwrite_existing);
  require_written(file_.resize(found_->valid_bytes), path_);
  started_ = true;
  saved_ = false;
  found_.reset();
}

fs::path Journal::set_aside() {
  std::error_code ignored;
  fs::remove(path_.string() + ".running", ignored);
  fs::path aside;
  for (int number = 1; aside.empty() || fs::exists(aside); ++number)
    aside = path_.string() + fmt::format(".aside-{}", number);
  fs::rename(path_, aside);
  if (fs::exists(kept_folder())) fs::rename(kept_folder(), aside.string() + std::string(kept_folder_suffix));
  file_ = platform::File();
  found_.reset();
  return aside;
}

fs::path Journal::keep(const fs::path& file) {
  if (!file_.is_open()) open(true);
  fs::create_directories(kept_folder());
  return copy_into(kept_folder(), file);
}

void Journal::start(const std::string& first) {
  if (!file_.is_open()) open(true);
  require_written(file_.resize(0), path_);
  started_ = true;
  write_line({{"format", "meshgraft-session"}, {"version", 1}, {"document", first}});
  if (!first_saved_.is_null()) write_line(first_saved_);
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

void Journal::withdraw() {
  if (started_) write_line({{"undo", true}, {"forget", true}});
}

void Journal::redo() {
  if (started_) write_line({{"redo", true}});
}

void Journal::mark_saved(const fs::path& edit, const std::string& sha256) {
  Json line = {{"saved", true}};
  if (!edit.empty()) {
    const fs::path relative = edit.lexically_relative(stem_.parent_path());  // still right where both are moved
    line["edit"] = relative.empty() ? edit.string() : relative.string();
    line["sha256"] = sha256;
  }
  if (!started_) {
    first_saved_ = std::move(line);
    return;
  }
  write_line(line);
  saved_ = true;
}

void Journal::write_line(const Json& line) {
  const std::string text = line.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
  std::error_code error;
  const std::uint64_t begin = file_.status(error).bytes;
  require_written(error, path_);
  error = file_.write(text);
  if (!error) error = file_.flush();
  if (error) file_.resize(begin);  // leaves no torn line, if possible
  require_written(error, path_);
  saved_ = false;
}

}  // namespace meshgraft::editor
