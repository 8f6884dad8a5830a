#pragma once

#include <future>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

#include "worker.h"

namespace meshgraft::editor {

/// Destroys workers on a thread of its own, because the server's thread has other pages to serve.
class Retirement {
 public:
  void take(std::unique_ptr<Worker> worker);

 private:
  std::mutex mutex_;
  std::vector<std::future<void>> ending_;
};

/// A page's session.
class Session : public PageSession {
 public:
  Session(std::shared_ptr<Channel> channel, Shared& shared, Retirement& retirement)
      : retirement_(retirement), worker_(std::make_unique<Worker>(std::move(channel), shared)) {}
  ~Session() override { retirement_.take(std::move(worker_)); }
  void receive(std::string_view text) override { worker_->receive(text); }

 private:
  Retirement& retirement_;
  std::unique_ptr<Worker> worker_;
};

}  // namespace meshgraft::editor
