#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/platform/file.h"
#include "document.h"
#include "folders.h"
#include "history.h"

namespace meshgraft::editor {

/// The edit file that a document was last saved in, and the document as it was then.
struct SavedEdit {
  std::filesystem::path file;
  std::string sha256;  ///< of the file as it was written
  std::string document;
};

/// The content of a journal: a history, and what of it is saved.
struct JournalContent {
  History history;
  bool saved = false;                   ///< whether the current state needs no journal
  std::optional<SavedEdit> saved_edit;  ///< the last one; nothing where no edit file was written
  std::size_t changes = 0;              ///< entries after the first document
  std::uintmax_t valid_bytes = 0;       ///< length of the valid lines; the rest is torn or damaged
};

/// Reads the lines of a journal up to the first one that is torn or invalid. Returns nothing where even the
/// first document is missing. `folder`: the journal's, which the paths of edit files are relative to.
std::optional<JournalContent> read_journal(std::string_view text, const std::filesystem::path& folder = {});

/// Returns the path of the first journal of a model or an edit file.
std::filesystem::path journal_of(const std::filesystem::path& model);

/// A file beside a model that records every change of a document at once: one JSON line per change, flushed
/// to disk before the call returns. The file is created by the first change and belongs to one session at a
/// time. A session deletes its journal at its end where all changes are saved. If it could not, the next
/// session deletes it.
class Journal {
 public:
  /// Opens the journal of the model or edit file at `path`: "NAME.meshgraft-session". A number is appended
  /// where another session holds that file for longer than a session takes to end.
  explicit Journal(const std::filesystem::path& path);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Changes that an earlier session left and that are not in an edit file.
  const std::optional<JournalContent>& found() const { return found_; }
  /// The new path of a journal that was found and put aside because not even its first line can be read, as
  /// that of a later version; empty if there was none.
  const std::filesystem::path& unreadable() const { return unreadable_; }
  /// Continues the journal that was found.
  void take_up();
  /// Renames the journal that was found, so that it is kept but no longer used. Returns its new path.
  std::filesystem::path set_aside();

  /// Copies a file that lasts no longer than the program to a folder beside the journal, which is deleted
  /// with the journal. Returns the copy. Throws Error(io).
  std::filesystem::path keep(const std::filesystem::path& file);
  /// Returns the file for the steps that run; empty where this session has no journal file yet.
  std::filesystem::path running_file() const;
  std::filesystem::path kept_folder() const { return path_.string() + std::string(kept_folder_suffix); }

  // Each of these throws Error(io) with the id editor.journal_not_written where writing fails.
  void add(const std::string& label, const std::string& before, const std::string& after);
  void undo();
  /// Undoes the last change so that it cannot be redone.
  void withdraw();
  void redo();
  /// Notes that the current state is saved. `edit`, `sha256`: the file that has it and its hash; empty for a
  /// model that was opened and has no changes left.
  void mark_saved(const std::filesystem::path& edit = {}, const std::string& sha256 = {});

 private:
  bool open(bool create);
  void start(const std::string& first);
  void write_line(const Json& line);

  std::filesystem::path stem_, path_, unreadable_;
  platform::File file_;
  bool started_ = false, saved_ = true;
  Json first_saved_;  ///< the line of `mark_saved` where that came before the first change; null: none
  std::optional<JournalContent> found_;
};

}  // namespace meshgraft::editor
