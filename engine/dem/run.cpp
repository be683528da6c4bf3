// SPDX-License-Identifier: MIT
// The loop around step: samples poses, collects metrics and events, and judges the run.
#include "dem/run.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dem/failures.h"
#include "dem/surface_contacts.h"

namespace verisim::dem {
namespace {

// A sample time this close to a step counts as on it (of a step; rounding of the sum of steps).
constexpr double kOnStep = 1e-6;

/// Steps that fill `duration` evenly, none longer than dt.
long steps_for(double duration, double dt) {
  return static_cast<long>(std::ceil(duration / dt - kOnStep));
}

void take_poses(const World& world, std::vector<Pose>& poses) {
  poses.clear();
  for (int b = 0; b < world.bodies.count(); ++b) poses.push_back(pose_of(world, b));
}

/// Pose at the share s of the way from a to b.
Pose between(const Pose& a, const Pose& b, double s) {
  return {a.position + s * (b.position - a.position), a.orientation.slerp(s, b.orientation),
          a.linear_velocity + s * (b.linear_velocity - a.linear_velocity),
          a.angular_velocity + s * (b.angular_velocity - a.angular_velocity)};
}

/// Logs poses at 0, 1, 2 ... sample intervals.
class Sampler {
 public:
  Sampler(const World& world, const RunOptions& options)
      : start_(world.time), interval_(options.sample_interval) {
    const double whole = options.duration / interval_;
    last_ = static_cast<long>(std::floor(whole + kOnStep));
    log_.names = world.names;
    take_poses(world, now_);
    add(start_);
  }

  /// Steps from the start until the next sample lies behind, or `end`.
  long steps_to_next(double dt, long end) const {
    if (next_ > last_) return end;
    const double steps = static_cast<double>(next_) * interval_ / dt;
    return std::min(end, static_cast<long>(std::ceil(steps - kOnStep)));
  }

  /// Logs the sample that lies in the last step done (`steps` in all), if there is one.
  bool sample(const World& world, const std::vector<Pose>& before, double dt, long steps) {
    const double at = static_cast<double>(next_) * interval_ / dt;
    if (next_ > last_ || at > static_cast<double>(steps) + kOnStep) return false;
    take_poses(world, now_);
    const double share = at - static_cast<double>(steps - 1);
    if (share < 1 - kOnStep) {
      for (std::size_t b = 0; b < now_.size(); ++b) {
        now_[b] = between(before[b], now_[b], std::max(share, 0.0));
      }
    }
    add(start_ + static_cast<double>(next_) * interval_);
    ++next_;
    return true;
  }

  PoseLog log() && { return std::move(log_); }

 private:
  void add(double time) {
    log_.times.push_back(time);
    log_.poses.insert(log_.poses.end(), now_.begin(), now_.end());
  }

  double start_, interval_;
  long next_ = 1, last_ = 0;
  std::vector<Pose> now_;
  PoseLog log_;
};

void check(const World& world, const RunOptions& options) {
  if (!(std::isfinite(options.duration) && options.duration >= 0)) {
    throw std::invalid_argument("run duration must be 0 s or more");
  }
  if (!(std::isfinite(options.sample_interval) && options.sample_interval > 0)) {
    throw std::invalid_argument("sample interval must be above 0 s");
  }
  for (const Expectation& expectation : options.expect) {
    for (const int b : expectation.stands) {
      if (b < 0 || b >= world.bodies.count()) {
        throw std::invalid_argument("no body " + std::to_string(b) + " to stand");
      }
    }
  }
}

}  // namespace

RunResult run(World& world, const RunOptions& options) {
  check(world, options);
  const double given_dt = world.parameters.dt;
  const long num_steps = steps_for(options.duration, given_dt);
  if (num_steps > 0) set_dt(world, options.duration / static_cast<double>(num_steps));
  const double dt = world.parameters.dt;

  RunResult result;
  Sampler sampler(world, options);
  FailureWatch watch(world, options.expect, options.duration);
  MomentKeeper keeper(options.keep_before_failure);
  const auto keep = [&] {
    if (options.keep_before_failure > 0) keeper.note(world);
  };
  keep();
  std::vector<Pose> before;
  bool goes_on = true;
  long done = 0;
  const auto advance = [&] {
    const StepReport report = step(world);
    const std::vector<ContactEvent>& events = world.contacts.events;
    result.events.insert(result.events.end(), events.begin(), events.end());
    if (watch.failures().empty()) keep();
    goes_on = watch.observe(world, report);
    if (world.surfaces) result.hardest.include(world.surfaces->hardest_contact());
    if (!world.halted) ++done;
  };
  while (goes_on && done < num_steps) {
    const double cpu_before = world.pool->cpu_seconds();
    const long target = sampler.steps_to_next(dt, num_steps);
    while (goes_on && done + 1 < target) advance();
    take_poses(world, before);
    if (goes_on) advance();
    result.cpu_s += world.pool->cpu_seconds() - cpu_before;
    if (world.halted) break;
    while (sampler.sample(world, before, dt, done)) {
      if (options.progress) options.progress(world.time);
    }
  }
  if (goes_on) watch.finish(world);

  set_dt(world, given_dt);
  result.log = std::move(sampler).log();
  result.metrics = metrics_of(world);
  result.failures = watch.failures();
  if (!result.failures.empty()) {
    result.failed = result.failures.front();
    result.last = std::move(keeper).take(world);
  }
  result.steps = world.surfaces ? world.surfaces->work().num_steps : done;
  result.dt =
      world.surfaces && world.surfaces->least_step() > 0 ? world.surfaces->least_step() : dt;
  return result;
}

}  // namespace verisim::dem
