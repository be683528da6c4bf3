// SPDX-License-Identifier: MIT
// A bounded queue between the thread that renders and the thread that encodes.
#include "clip/frame_queue.h"

namespace verisim::clip {

FrameQueue::FrameQueue(Encoder& encoder) : encoder_(encoder), thread_([this] { encode_all(); }) {}

FrameQueue::~FrameQueue() {
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
    waiting_.clear();
  }
  changed_.notify_all();
  thread_.join();
}

std::vector<std::uint8_t> FrameQueue::take_buffer(std::size_t size) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return num_in_flight_ < kMaxFrames || error_; });
  rethrow();
  ++num_in_flight_;
  if (spare_.empty()) return std::vector<std::uint8_t>(size);
  std::vector<std::uint8_t> buffer = std::move(spare_.front());
  spare_.pop_front();
  return buffer;
}

void FrameQueue::push(std::vector<std::uint8_t> rgba) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(rgba));
  }
  changed_.notify_all();
}

void FrameQueue::drain() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return num_in_flight_ == 0 || error_; });
  rethrow();
}

void FrameQueue::rethrow() {
  if (error_) std::rethrow_exception(error_);
}

void FrameQueue::encode_all() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return !waiting_.empty() || is_closed_; });
    if (waiting_.empty()) return;
    std::vector<std::uint8_t> rgba = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    try {
      encoder_.add(rgba);
      lock.lock();
    } catch (...) {
      lock.lock();
      error_ = std::current_exception();
      changed_.notify_all();
      return;
    }
    spare_.push_back(std::move(rgba));
    --num_in_flight_;
    changed_.notify_all();
  }
}

}  // namespace verisim::clip
