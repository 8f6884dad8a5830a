#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace meshgraft::editor {

/// The steps that run at present, by their keys, in a file for as long as any runs. An engine that is ended by
/// a signal while it runs a step leaves the file, and the next one learns from it which step that was. May be
/// called from several threads.
class RunningSteps {
 public:
  /// A step that runs until this is destroyed.
  class Mark {
   public:
    Mark(RunningSteps& steps, std::string key);
    ~Mark();
    Mark(Mark&& from) noexcept : steps_(std::exchange(from.steps_, nullptr)), key_(std::move(from.key_)) {}
    Mark& operator=(Mark&& from) noexcept {
      std::swap(steps_, from.steps_);
      std::swap(key_, from.key_);
      return *this;
    }
    Mark(const Mark&) = delete;
    Mark& operator=(const Mark&) = delete;

   private:
    RunningSteps* steps_;
    std::string key_;
  };

  RunningSteps() = default;
  ~RunningSteps() { keep_in({}); }
  RunningSteps(const RunningSteps&) = delete;
  RunningSteps& operator=(const RunningSteps&) = delete;

  [[nodiscard]] Mark begin(std::string key) { return {*this, std::move(key)}; }

  /// Writes to this file from now on and deletes the earlier one; empty: writes to none. A file that cannot be
  /// written is no error: then no step is known to have run.
  void keep_in(const std::filesystem::path& file);

  /// Returns the keys that an engine left in a file; none where there is no such file, or it is not whole.
  static std::vector<std::string> left_in(const std::filesystem::path& file);

 private:
  void write() const;

  std::mutex mutex_;
  std::filesystem::path file_;
  std::vector<std::string> keys_;
};

}  // namespace meshgraft::editor
