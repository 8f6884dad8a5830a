#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/platform/file.h"
#include "document.h"
#include "history.h"

namespace meshgraft::editor {

/// What a journal tells: a history, and whether its state is in an edit file.
struct JournalContent {
  History history;
  bool saved = false;
  std::size_t changes = 0;         ///< entries behind the first document
  std::uintmax_t valid_bytes = 0;  ///< the lines that were told; behind them is a torn one, or damage
};

/// What the lines of a journal amount to, up to the first one that is torn or not a journal's; absent where not
/// even the first document is there.
std::optional<JournalContent> read_journal(std::string_view text);

/// Where the first journal of a model or an edit file lies.
std::filesystem::path journal_of(const std::filesystem::path& model);

/// A file beside a model that has every change of a document as soon as it is made: one JSON line each, on the
/// disk before the call returns. It is there from the first change on, belongs to one session at a time, and
/// goes with it where all is saved. One that an earlier session could not take away, though all was saved, goes
/// with the next.
class Journal {
 public:
  /// For the model or edit file at `path`; "NAME.meshgraft-session", or with a number behind where another
  /// session has that for longer than it takes to end one.
  explicit Journal(const std::filesystem::path& path);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// What an earlier session left that is not in an edit file.
  const std::optional<JournalContent>& found() const { return found_; }
  /// Goes on behind what was found.
  void take_up();
  /// Renames what was found, so that it is out of the way and not lost. Returns its new path.
  std::filesystem::path set_aside();

  /// Copies a file that lasts no longer than the program to a folder beside the journal, which goes with it.
  /// Returns the copy. Throws Error(io).
  std::filesystem::path keep(const std::filesystem::path& file);
  std::filesystem::path kept_folder() const { return path_.string() + ".parts"; }

  // Each throws Error(io) where the disk does not take it.
  void add(const std::string& label, const std::string& before, const std::string& after);
  void undo();
  void redo();
  void mark_saved();

 private:
  bool open(bool create);
  void start(const std::string& first);
  void write_line(const Json& line);

  std::filesystem::path stem_, path_;
  platform::File file_;
  bool started_ = false, saved_ = true;
  std::optional<JournalContent> found_;
};

}  // namespace meshgraft::editor
