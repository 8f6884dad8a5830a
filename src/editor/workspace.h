#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>

#include "document_actions.h"
#include "folders.h"
#include "graft_view.h"
#include "history.h"
#include "journal.h"
#include "live_view.h"
#include "protocol.h"

namespace meshgraft::editor {

/// What a page has open: a document with its history and journal, and what is shown of it. Used on one thread.
class Workspace {
 public:
  struct Source {
    std::string name;               ///< what the page calls it
    std::filesystem::path journal;  ///< the path that the journal is named after; empty: there is none
    std::filesystem::path edit;     ///< the edit file that it came from; empty: none
    std::string edit_sha256{};      ///< of that file, as it was read or written last
  };

  /// Opens a document and shows it. Throws what running the steps before the last throws.
  Workspace(Document document, Source source, const Folders& folders, const Numbers& numbers, Outbox outbox,
            const Context& context);

  /// From now on changes go to a journal. No other workspace of the session has one then.
  void keep_journal();

  /// Makes `changed` the document, or leaves all as it was and throws what is wrong with it.
  void change(const std::string& label, const Json& changed, const Context& context);
  void undo(const Context& context);
  void redo(const Context& context);
  void reset(const Context& context);

  /// Goes back to before the change whose set-up, or whose graft, goes on. Throws Error(usage) where none does.
  void leave_set_up(const Context& context);

  /// What an earlier session left, if there is any that was not yet taken or declined.
  std::optional<Json> offer() const;
  void restore(const Context& context);
  /// Returns where it was put.
  std::filesystem::path decline();

  /// What the document's steps leave, but for last ones that do nothing yet: the edit's output, and where its
  /// vertices were. What the view shows is not solved again. Throws what `run_edit` throws.
  struct Outcome {
    Mesh mesh;
    Points rest;
  };
  Outcome outcome(const Context& context);

  /// Has the document's steps run, or what is shown of them kept, for a document that goes on from there.
  void finish(const Context& context);

  /// `edit_sha256`: of the file as it is now.
  void mark_saved(const std::filesystem::path& edit, std::string edit_sha256);

  /// A file that lasts as long as the journal: the upload itself where there is none.
  std::filesystem::path kept_upload(const std::filesystem::path& upload);
  /// Where those are; empty: nowhere.
  std::filesystem::path kept_folder() const;

  const Document& document() const { return document_; }
  const History& history() const { return history_; }
  LiveView& view() { return view_; }
  const LiveView& view() const { return view_; }
  const Source& source() const { return source_; }
  /// Whether it is what is open, and all that was done is saved.
  bool is_saved(const std::filesystem::path& model) const;

  /// The page's selection, which lies on one object.
  struct PageSelection {
    std::shared_ptr<const Object> on;
    std::vector<Index> vertices;  ///< ascending
  };
  PageSelection selection;

  /// The model and the parts as the step in work finds them.
  const Stage& stage() const { return stage_; }
  /// The object of that name; empty: the model. Throws Error(input).
  const std::shared_ptr<const Object>& object(const std::string& name) const;

  /// Shows the graft that `changed` ends with, for now; where that is the document, for good. Returns its
  /// number, 0 where there is none.
  std::int64_t drag_graft(const Json& changed, const Context& context);
  /// The number of what shows the graft that was asked for last, and where a part stands that is dropped, if it
  /// is. Throws Error(input) for a place that is none.
  std::int64_t graft_number() const { return graft_number_; }
  std::optional<Eigen::Affine3d> placement_of_last_drop();

  /// The start of a pair of the graft that a step is, turned by an angle from where it was found or given.
  /// Throws Error(input) for a step or a pair that is none.
  Match twisted_start(std::size_t step, std::size_t pair, double by_deg, const Context& context);

  /// What stands in the way of editing these inputs, one sentence for each that is not sound; of all where none
  /// is named. `uploads`: the folder of files whose names are not people's.
  std::vector<std::string> defects(const std::string& name, const std::filesystem::path& uploads);

  /// What a page needs to know of it (the event `state`).
  Json summary() const;

 private:
  Document checked(Document document) const;
  void show_parts(const Stage& next);
  void show_graft(const Document& document, const Stage& stage, bool dragged);
  void learn_graft();
  void carry_selection();
  void note_whether_saved();
  bool show(Document next, const Context& context);
  std::optional<std::size_t> set_up_origin() const;
  Json set_up_label() const;
  template <class Step>
  void write(Step&& step);

  Source source_;
  const Folders& folders_;
  Outbox outbox_;
  Objects objects_;
  Stage stage_;
  LiveView view_;
  GraftView graft_view_;
  std::int64_t graft_number_ = 0;
  GraftJob last_graft_;
  std::optional<DropPlacement> placement_;
  Json placement_key_;
  Document document_;
  History history_;
  std::optional<std::size_t> before_set_up_;  ///< position in the history
  std::string saved_;                         ///< the document's bytes as they were saved last
  std::unique_ptr<Journal> journal_;          ///< last: another session may have it while the rest ends
};

}  // namespace meshgraft::editor
