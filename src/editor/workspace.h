#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/orientation.h>

#include "defects.h"
#include "document_actions.h"
#include "folders.h"
#include "graft_view.h"
#include "history.h"
#include "journal.h"
#include "live_view.h"
#include "protocol.h"
#include "running_steps.h"

namespace meshgraft::editor {

/// An open document with its history, its journal and its view. Call it from one thread only.
class Workspace {
 public:
  struct Source {
    std::string name;               ///< name that the page shows
    std::filesystem::path journal;  ///< path that the journal is named after; empty: no journal
    std::filesystem::path edit;     ///< the edit file that was opened; empty: none
    std::string edit_sha256{};      ///< hash of that file when it was last read or written
  };

  /// Opens a document and shows it. Throws what running the steps before the last one throws.
  Workspace(Document document, Source source, const Folders& folders, const Numbers& numbers, Outbox outbox,
            const Context& context);
  ~Workspace();

  /// Writes changes to a journal from now on. No other workspace of the session may have one then.
  void keep_journal();

  /// Makes `changed` the document. Where it is invalid, throws and leaves everything unchanged.
  void change(const std::string& label, const Json& changed, const Context& context);
  /// Like `change`, but takes the place of the last change, so that undo takes both back.
  void extend_change(const std::string& label, const Json& changed, const Context& context);
  void undo(const Context& context);
  /// Undoes the last change so that it cannot be redone.
  void withdraw(const Context& context);
  void redo(const Context& context);
  void reset(const Context& context);

  /// Returns to the state before the change whose set-up or graft is still running. Throws Error(usage) where
  /// none is running.
  void leave_set_up(const Context& context);

  /// Tells the page the stage of the set-up, until that is final.
  void poll();

  /// Describes the unsaved changes of an earlier session, unless they were already restored or declined.
  std::optional<Json> offer() const;
  /// Restores the earlier session. If its engine was ended by a signal while it ran a step, leaves out this
  /// step and those after it, as a change that can be undone, and tells the page.
  void restore(const Context& context);
  /// Declines to restore the earlier session. Returns the new path of its journal.
  std::filesystem::path decline();

  /// The output of the edit, without last steps that do nothing yet, and the rest positions of its vertices.
  /// A result that the view shows is not solved again. Throws what `run_edit` throws.
  struct Outcome {
    Mesh mesh;
    Points rest;
  };
  Outcome outcome(const Context& context);
  /// The same of an object of that name. An empty name is that of the model.
  Outcome outcome_for(const std::string& object, const Context& context);

  /// Stores the shown result of the last step, so that a following step can start from it without a new
  /// solve.
  void finish(const Context& context);

  /// `edit_sha256`: hash of the file as it is now.
  void mark_saved(const std::filesystem::path& edit, std::string edit_sha256);

  /// Returns a copy of an upload that lasts as long as the journal; without a journal, the upload itself.
  std::filesystem::path kept_upload(const std::filesystem::path& upload);
  /// Returns the folder of these copies; empty without a journal.
  std::filesystem::path kept_folder() const;

  const Document& document() const { return document_; }
  /// Returns the document with the steps that are set aside while a graft is edited again. Throws what
  /// `make_document` throws.
  Document whole_document() const;
  /// Returns the steps that are set aside.
  std::vector<Json> steps_set_aside() const;
  const History& history() const { return history_; }
  LiveView& view() { return view_; }
  const LiveView& view() const { return view_; }
  const Source& source() const { return source_; }
  /// Returns whether this model is open and all changes are saved.
  bool is_saved(const std::filesystem::path& model) const;

  /// The page's selection, which lies on one object.
  struct PageSelection {
    std::shared_ptr<const Object> on;
    std::vector<Index> vertices;  ///< ascending
  };
  PageSelection selection;

  /// The model and the parts in the state before the current step.
  const StepInputs& stage() const { return stage_; }
  /// Returns the object of that name; empty: the model. Throws Error(input).
  const std::shared_ptr<const Object>& object(const std::string& name) const;

  /// Shows the graft at the end of `changed` temporarily; where `changed` is the document, permanently.
  /// Returns its number, or 0 where there is no graft.
  std::int64_t drag_graft(const Json& changed, const Context& context);
  /// `graft_number` is the number of the graft that was requested last. `placement_of_last_drop` is the
  /// placement of its source where it is a drop; throws Error(input) for an invalid location.
  std::int64_t graft_number() const { return graft_number_; }
  std::optional<Eigen::Affine3d> placement_of_last_drop();

  /// Returns the start of a pair of an earlier graft, turned by an angle from the start that was found or
  /// given. Throws Error(input) for a step that is no such graft, and for an unknown pair.
  Match twisted_start(std::size_t step, std::size_t pair, double by_deg, const Context& context);

  /// Returns notes on the file of the input `name` or, where it is empty, on those of all inputs. `uploads`:
  /// the folder of files whose names are generated.
  std::vector<FileNote> notes_on_inputs(const std::string& name, const std::filesystem::path& uploads);

  /// Returns the fields of the event `state`.
  Json summary() const;

 private:
  Document checked(Document document) const;
  void show_parts(const StepInputs& next);
  void show_graft(const Document& document, const StepInputs& stage, bool dragged);
  void learn_graft();
  void carry_selection();
  void note_whether_saved();
  void learn_saved(SavedEdit saved);
  bool show(Document next, const Context& context);
  std::optional<bool> show_changed(const Json& changed, const Context& context);
  void record(const std::string& label, bool begins);
  void show_before(const Context& context);
  void end_set_up();
  std::optional<std::size_t> step_that_ended(const Document& document) const;
  std::optional<std::size_t> set_up_origin() const;
  Json set_up_label() const;
  std::string file_of_model() const;
  template <class Step>
  void write(Step&& step);

  Source source_;
  const Folders& folders_;
  Outbox outbox_;
  RunningSteps running_;
  std::vector<std::string> ended_in_;         ///< keys of the steps that ran when the earlier session ended
  std::optional<RunningSteps::Mark> set_up_;  ///< of the current step
  Objects objects_;
  StepInputs stage_;
  LiveView view_;
  GraftView graft_view_;
  std::int64_t graft_number_ = 0;
  GraftJob last_graft_;
  std::optional<DropPlacement> placement_;
  Json placement_key_;
  Document document_;
  History history_;
  std::optional<std::size_t> before_set_up_;  ///< position in the history
  Orientation shown_as_;                      ///< of the model at opening
  std::string saved_;                         ///< bytes of the document when it was last saved
  std::unique_ptr<Journal> journal_;          ///< last member: released to other sessions first
};

}  // namespace meshgraft::editor
