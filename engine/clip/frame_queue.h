// SPDX-License-Identifier: MIT
// Hands pictures to an encoder on a thread of its own, a few at a time.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "clip/encoder.h"

namespace verisim::clip {

/// Pictures in, encoded on another thread in the same order. An error there is thrown here.
class FrameQueue {
 public:
  explicit FrameQueue(Encoder& encoder);
  ~FrameQueue();
  FrameQueue(const FrameQueue&) = delete;
  FrameQueue& operator=(const FrameQueue&) = delete;

  /// A buffer of this many bytes to draw into; waits while kMaxFrames are on their way.
  std::vector<std::uint8_t> take_buffer(std::size_t size);
  void push(std::vector<std::uint8_t> rgba);
  /// Waits until all pictures are encoded. Throws what the encoder threw.
  void drain();

 private:
  static constexpr std::size_t kMaxFrames = 4;  // more gains nothing: the renderer is the slow one

  void encode_all();
  void rethrow();

  Encoder& encoder_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::vector<std::uint8_t>> waiting_, spare_;
  std::size_t num_in_flight_ = 0;
  bool is_closed_ = false;
  std::exception_ptr error_;
  std::thread thread_;
};

}  // namespace verisim::clip
