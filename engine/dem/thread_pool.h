// SPDX-License-Identifier: MIT
// A small pool of threads that all run one function and meet again.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace verisim::dem {

/// `num_threads` threads, of which the caller is number 0. With one thread nothing is started.
class ThreadPool {
 public:
  explicit ThreadPool(int num_threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int num_threads() const { return num_threads_; }

  /// CPU time (s) that the calling thread and the pool's own have used since they began.
  double cpu_seconds();

  /// Calls work(t) for t = 0 .. num_threads - 1, each on its own thread, and waits for all.
  /// `work` must not throw. No allocation.
  template <class Work>
  void run(const Work& work) {
    if (num_threads_ == 1) {
      work(0);
      return;
    }
    dispatch([](const void* context, int t) { (*static_cast<const Work*>(context))(t); }, &work);
  }

  /// Splits [0, count) into one contiguous range per thread, cut at multiples of `block`, and calls
  /// work(begin, end). The result must not depend on the cuts.
  template <class Work>
  void run_ranges(int count, int block, const Work& work) {
    run([&](int t) {
      const int begin = range_begin(count, block, t);
      const int end = range_begin(count, block, t + 1);
      if (begin < end) work(begin, end);
    });
  }

  /// First index of thread t's range of [0, count); t = num_threads gives count.
  int range_begin(int count, int block, int t) const {
    const std::int64_t blocks = (static_cast<std::int64_t>(count) + block - 1) / block;
    const std::int64_t begin = blocks * t / num_threads_ * block;
    return static_cast<int>(begin < count ? begin : count);
  }

 private:
  using Call = void (*)(const void* context, int t);
  void dispatch(Call call, const void* context);
  void serve(int t);

  int num_threads_;
  Call call_ = nullptr;
  const void* context_ = nullptr;
  std::atomic<std::uint32_t> round_ = 0;
  std::atomic<int> unfinished_ = 0;
  std::atomic<bool> stopping_ = false;
  std::vector<std::thread> workers_;
};

}  // namespace verisim::dem
