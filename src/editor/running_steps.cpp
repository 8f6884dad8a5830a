#include "running_steps.h"

#include <algorithm>
#include <exception>
#include <fstream>
#include <system_error>

#include "document.h"
#include "io/file.h"

namespace meshgraft::editor {

namespace fs = std::filesystem;

RunningSteps::Mark::Mark(RunningSteps& steps, std::string key) : steps_(&steps), key_(std::move(key)) {
  const std::lock_guard lock(steps_->mutex_);
  steps_->keys_.push_back(key_);
  steps_->write();
}

RunningSteps::Mark::~Mark() {
  if (steps_ == nullptr) return;
  const std::lock_guard lock(steps_->mutex_);
  steps_->keys_.erase(std::ranges::find(steps_->keys_, key_));
  steps_->write();
}

void RunningSteps::keep_in(const fs::path& file) {
  const std::lock_guard lock(mutex_);
  if (file == file_) return;
  std::error_code ignored;
  if (!file_.empty()) fs::remove(file_, ignored);
  file_ = file;
  write();
}

void RunningSteps::write() const {
  if (file_.empty()) return;
  std::error_code ignored;
  if (keys_.empty())
    fs::remove(file_, ignored);
  else
    std::ofstream(file_, std::ios::binary) << Json(keys_).dump();
}

std::vector<std::string> RunningSteps::left_in(const fs::path& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return {};
  try {
    return Json::parse(read_file(file)).get<std::vector<std::string>>();
  } catch (const std::exception&) {
    return {};
  }
}

}  // namespace meshgraft::editor
