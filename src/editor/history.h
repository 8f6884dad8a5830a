#pragma once

#include <string>
#include <utility>
#include <vector>

namespace meshgraft::editor {

/// A document's states, each with what led to it. They are kept as their bytes, so the first one comes back as
/// it was.
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
  /// The state before and after the current one.
  const Entry& before() const { return entries_[position_ - 1]; }
  const Entry& after() const { return entries_[position_ + 1]; }
  const std::string& label() const { return entries_[position_].label; }

  /// What had been undone goes.
  void add(std::string label, std::string document) {
    entries_.resize(position_ + 1);
    entries_.push_back({std::move(label), std::move(document)});
    ++position_;
  }
  /// How many changes led to the current state; what the one that led to another was.
  std::size_t position() const { return position_; }
  std::size_t size() const { return entries_.size(); }
  const Entry& at(std::size_t position) const { return entries_[position]; }

  void undo() { --position_; }
  void redo() { ++position_; }

 private:
  std::vector<Entry> entries_;
  std::size_t position_ = 0;
};

}  // namespace meshgraft::editor
