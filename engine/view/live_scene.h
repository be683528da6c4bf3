// SPDX-License-Identifier: MIT
// A scene that runs while its parameters change. Every change is an override of the scene file, so
// that what is seen is what `--set` will give.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dem/failures.h"
#include "dem/world.h"
#include "scene/build_world.h"
#include "view/changes.h"

namespace verisim::view {

/// What a change does to the run.
enum class Effect { kGoesOn, kRestarts };

class LiveScene {
 public:
  /// scene: loaded with these overrides, prescribed motion filled. Throws SceneError.
  LiveScene(scene::Scene scene, const std::vector<std::string>& overrides);

  /// Sets a scene key. Parameters that the scene leaves open are chosen anew. Returns what is
  /// wrong, empty if nothing; then nothing has changed.
  std::string change(const std::string& path, const std::string& value, Effect effect);
  /// Back to the overrides of the start, and to time 0. Returns what is wrong, as change() does.
  std::string undo_changes();
  /// Back to time 0 with the changes kept. The scene file is read again.
  std::string restart();

  /// Steps until `seconds` more have been simulated, or for `budget` seconds of real time, and at
  /// least once. Returns the simulated seconds.
  double advance(double seconds, double budget);
  /// One time step.
  void step();
  /// Pulls a body, or lets it go. Method dem takes shorter steps meanwhile: a pull is held for a
  /// step.
  void hold(const std::optional<dem::Drag>& drag);

  const scene::Scene& scene() const { return scene_; }
  const scene::BuiltScene& built() const { return built_; }
  const dem::World& world() const { return world_; }
  /// s; the world's own is shorter while a body is held.
  double chosen_dt() const { return chosen_dt_; }
  const Changes& changes() const { return changes_; }
  const dem::StepReport& report() const { return report_; }
  /// The first of each code; live edits are not held against the run.
  const std::vector<dem::Failure>& failures() const { return watch_->failures(); }
  /// Not finite, or exploded: only restart() goes on.
  bool stopped() const { return stopped_; }
  /// The last advance() ended by its budget.
  bool fell_behind() const { return fell_behind_; }
  /// Counts restarts: bodies and particles may differ after one.
  int generation() const { return generation_; }
  std::vector<dem::Pose> poses() const;

 private:
  std::string rebuild(const Changes& changes, Effect effect);
  void start();

  std::vector<std::string> first_overrides_;
  Changes changes_;
  scene::Scene scene_;
  scene::BuiltScene built_;
  dem::World world_;
  dem::StepReport report_;
  std::optional<dem::FailureWatch> watch_;
  bool stopped_ = false;
  void set_step();

  double chosen_dt_ = 0;
  double owed_ = 0;  // s, of simulated time: less than a step
  bool fell_behind_ = false;
  int generation_ = 0;
};

}  // namespace verisim::view
