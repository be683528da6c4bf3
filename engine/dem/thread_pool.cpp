// SPDX-License-Identifier: MIT
// A small pool of threads that all run one function and meet again.
#include "dem/thread_pool.h"

#include <pthread.h>
#include <time.h>

namespace verisim::dem {
namespace {

// Phases follow each other within microseconds, so a waiter looks this often before it sleeps.
// With more threads than cores a longer look only takes time from the one that works.
constexpr int kLooksBeforeSleep = 2000;

template <class Value>
void wait_while_equal(const std::atomic<Value>& variable, Value old) {
  for (int look = 0; look < kLooksBeforeSleep; ++look) {
    if (variable.load(std::memory_order_acquire) != old) return;
  }
  variable.wait(old, std::memory_order_acquire);
}

double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

ThreadPool::ThreadPool(int num_threads) : num_threads_(num_threads < 1 ? 1 : num_threads) {
  for (int t = 1; t < num_threads_; ++t) workers_.emplace_back([this, t] { serve(t); });
}

ThreadPool::~ThreadPool() {
  stopping_.store(true);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

double ThreadPool::cpu_seconds() {
  double seconds = seconds_of(CLOCK_THREAD_CPUTIME_ID);
  for (std::thread& worker : workers_) {
    clockid_t clock{};
    if (pthread_getcpuclockid(worker.native_handle(), &clock) == 0) seconds += seconds_of(clock);
  }
  return seconds;
}

void ThreadPool::dispatch(Call call, const void* context) {
  call_ = call;
  context_ = context;
  unfinished_.store(num_threads_ - 1, std::memory_order_relaxed);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  call(context, 0);
  for (int left = unfinished_.load(std::memory_order_acquire); left > 0;
       left = unfinished_.load(std::memory_order_acquire)) {
    wait_while_equal(unfinished_, left);
  }
}

void ThreadPool::serve(int t) {
  std::uint32_t seen = 0;
  while (true) {
    wait_while_equal(round_, seen);
    seen = round_.load(std::memory_order_acquire);
    if (stopping_.load()) return;
    call_(context_, t);
    if (unfinished_.fetch_sub(1, std::memory_order_acq_rel) == 1) unfinished_.notify_one();
  }
}

}  // namespace verisim::dem
