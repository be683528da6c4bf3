// SPDX-License-Identifier: MIT
#include "view/live_scene.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "scene/load_scene.h"
#include "scene/problem.h"

namespace verisim::view {
namespace {

// Poses of prescribed bodies come from outside of the scene file; a reload keeps them by name.
void keep_prescribed(const scene::Scene& from, scene::Scene& to) {
  for (scene::Body& body : to.bodies) {
    if (body.motion != dem::Motion::kPrescribed) continue;
    for (const scene::Body& known : from.bodies) {
      if (known.name != body.name || known.poses_file != body.poses_file) continue;
      body.prescribed = known.prescribed;
      body.initial = known.initial;
    }
    if (body.prescribed.times.empty()) {
      throw std::invalid_argument("body " + body.name + " has a new pose log, " +
                                  body.poses_file.string() + "; start the viewer again");
    }
  }
}

// Longest step (s) of method dem while a body is held: the spring of the hand swings at 20 rad/s
// and turns a cube held at its corner at 45.
constexpr double kStepInHand = 1.0 / 240;

void set_parameters(dem::World& world, const dem::WorldDefinition& definition) {
  dem::set_gravity(world, definition.gravity);
  const bool is_dem = definition.method == dem::Method::kDem;
  dem::set_stiffness(world, is_dem ? definition.dem.stiffness : definition.seed.stiffness);
  dem::set_damping_ratio(world, definition.seed.damping_ratio);
  dem::set_tangential_damping_ratio(world, definition.seed.tangential_damping_ratio);
  dem::set_integrator(world, definition.integrator);
}

}  // namespace

LiveScene::LiveScene(scene::Scene scene, const std::vector<std::string>& overrides)
    : first_overrides_(overrides),
      changes_(overrides),
      scene_(std::move(scene)),
      built_(scene::build_world(scene_)) {
  start();
}

void LiveScene::start() {
  world_ = dem::make_world(built_.world);
  chosen_dt_ = built_.world.dt;
  watch_.emplace(world_, std::vector<dem::Expectation>{}, scene_.duration);
  report_ = {};
  owed_ = 0;
  stopped_ = false;
  fell_behind_ = false;
  ++generation_;
}

std::string LiveScene::rebuild(const Changes& changes, Effect effect) {
  try {
    scene::Scene scene = scene::load_scene(scene_.file, changes.overrides());
    keep_prescribed(scene_, scene);
    scene::BuiltScene built = scene::build_world(scene);
    if (effect == Effect::kRestarts) {
      dem::make_world(built.world);  // refuses what cannot run before anything is replaced
      scene_ = std::move(scene);
      built_ = std::move(built);
      start();
    } else {
      set_parameters(world_, built.world);
      chosen_dt_ = built.world.dt;
      set_step();
      scene_.gravity = scene.gravity;
      scene_.physics = scene.physics;
    }
    changes_ = changes;
    return "";
  } catch (const scene::SceneError& error) {
    return error.what();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

std::string LiveScene::change(const std::string& path, const std::string& value, Effect effect) {
  Changes changes = changes_;
  changes.set(path, value);
  return rebuild(changes, effect);
}

std::string LiveScene::undo_changes() {
  return rebuild(Changes(first_overrides_), Effect::kRestarts);
}

std::string LiveScene::restart() { return rebuild(changes_, Effect::kRestarts); }

double LiveScene::advance(double seconds, double budget) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const double time_before = world_.time;
  owed_ += seconds;
  fell_behind_ = false;
  while (!stopped_ && owed_ >= world_.parameters.dt) {
    step();
    owed_ -= world_.parameters.dt;
    if (std::chrono::duration<double>(Clock::now() - start).count() > budget) {
      // What is still owed is dropped: time runs slower, the window stays awake.
      fell_behind_ = owed_ >= world_.parameters.dt;
      if (fell_behind_) owed_ = 0;
      break;
    }
  }
  return world_.time - time_before;
}

void LiveScene::step() {
  if (stopped_) return;
  report_ = dem::step(world_);
  stopped_ = !watch_->observe(world_, report_);
}

void LiveScene::set_step() {
  const bool is_short = world_.drag && world_.surfaces;
  dem::set_dt(world_, is_short ? std::min(chosen_dt_, kStepInHand) : chosen_dt_);
}

void LiveScene::hold(const std::optional<dem::Drag>& drag) {
  dem::set_drag(world_, drag);
  set_step();
}

std::vector<dem::Pose> LiveScene::poses() const {
  std::vector<dem::Pose> poses;
  for (int i = 0; i < world_.bodies.count(); ++i) poses.push_back(dem::pose_of(world_, i));
  return poses;
}

}  // namespace verisim::view
