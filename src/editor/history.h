#pragma once

#include <string>
#include <utility>
#include <vector>

namespace meshgraft::editor {

/// The states of a document, each with the label of the change that led to it. States are kept as bytes, so
/// that undoing restores them exactly.
class History {
 public:
  explicit History(std::string first) { entries_.push_back({"", std::move(first)}); }

  struct Entry {
    std::string label, document;
  };

  const std::string& current() const { return entries_[position_].document; }
  const std::string& first() const { return entries_.front().document; }
  bool can_undo() const { return position_ > 0; }
  bool can_redo() const { return position_ + 1 < entries_.size(); }
  /// The states before and after the current one.
  const Entry& before() const { return entries_[position_ - 1]; }
  const Entry& after() const { return entries_[position_ + 1]; }
  const std::string& label() const { return entries_[position_].label; }

  /// Adds a state and drops the undone ones.
  void add(std::string label, std::string document) {
    entries_.resize(position_ + 1);
    entries_.push_back({std::move(label), std::move(document)});
    ++position_;
  }
  /// `position()` is the number of changes that led to the current state; `at()` returns any state with its
  /// label.
  std::size_t position() const { return position_; }
  std::size_t size() const { return entries_.size(); }
  const Entry& at(std::size_t position) const { return entries_[position]; }

  /// Drops the undone states.
  void forget_undone() { entries_.resize(position_ + 1); }

  void undo() { --position_; }
  void redo() { ++position_; }

 private:
  std::vector<Entry> entries_;
  std::size_t position_ = 0;
};

}  // namespace meshgraft::editor
