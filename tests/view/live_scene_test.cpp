// SPDX-License-Identifier: MIT
// A running scene whose parameters change, the overrides that repeat it, and the saved scene.
#include "view/live_scene.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "dem/surface_contacts.h"
#include "scene/load_scene.h"
#include "view/grip.h"
#include "view/save_scene.h"
#include "view/view_error.h"

using namespace verisim;
namespace fs = std::filesystem;

namespace {

constexpr const char* kScene = R"(schema: 1
name: two
duration_s: 1
frame_rate_hz: 60
materials:
  wood: {density_kg_m3: 500}
bodies:
  - {name: ball, shape: {sphere_radius_m: 0.1}, material: wood, position_m: [0, 0, 1]}
  - {name: box, shape: {box_m: [0.2, 0.2, 0.2]}, material: wood, position_m: [1, 0, 0.12]}
ground: {plane: {normal: [0, 0, 1], offset_m: 0}, material: wood}
physics: {method: seed}
)";

/// A scene file in a folder of its own, gone at the end.
struct SceneFolder {
  fs::path folder = fs::temp_directory_path() / ("verisim_view_test_" + std::to_string(rand()));
  fs::path file = folder / "two.yaml";
  SceneFolder() {
    fs::create_directories(folder);
    std::ofstream(file) << kScene;
  }
  ~SceneFolder() { fs::remove_all(folder); }
  view::LiveScene live(const std::vector<std::string>& overrides = {}) const {
    return {scene::load_scene(file, overrides), overrides};
  }
};

}  // namespace

TEST_CASE("a_live_change_is_what_its_override_gives") {
  // The scene leaves stiffness and time step open: both follow from the changed gravity.
  const SceneFolder scene;
  view::LiveScene live = scene.live();
  live.advance(0.05, 10);
  const double time = live.world().time;
  CHECK(live.change("gravity_m_s2", "[0, 0, -30]", view::Effect::kGoesOn) == "");
  CHECK(live.change("physics.damping_ratio", "0.25", view::Effect::kGoesOn) == "");
  CHECK(live.world().time == time);

  const auto loaded =
      scene::build_world(scene::load_scene(scene.file, live.changes().overrides())).world;
  const dem::Parameters& now = live.world().parameters;
  CHECK(now.gravity == Eigen::Vector3d(0, 0, -30));
  CHECK(now.gravity == loaded.gravity);
  CHECK(now.dt == loaded.dt);
  CHECK(now.seed.stiffness == loaded.seed.stiffness);
  CHECK(now.seed.damping_ratio == 0.25);
  CHECK(now.dt != scene.live().world().parameters.dt);
}

TEST_CASE("a_change_that_the_scene_refuses_changes_nothing") {
  const SceneFolder scene;
  view::LiveScene live = scene.live();
  const std::string problem = live.change("physics.dt_s", "-1", view::Effect::kGoesOn);
  CHECK(problem.find("physics.dt_s") != std::string::npos);
  CHECK(live.changes().empty());
  CHECK(live.world().parameters.dt > 0);
}

TEST_CASE("another_particle_size_restarts_with_other_particles") {
  const SceneFolder scene;
  view::LiveScene live = scene.live();
  live.advance(0.05, 10);
  const int before = live.world().particles.count();
  CHECK(live.change("physics.particle_size_m", "0.025", view::Effect::kRestarts) == "");
  CHECK(live.world().time == 0);
  CHECK(live.generation() == 2);
  CHECK(live.world().particles.count() == 1 + 8 * 8 * 8);
  CHECK(before < live.world().particles.count());
}

TEST_CASE("undo_returns_to_the_overrides_of_the_start") {
  const SceneFolder scene;
  view::LiveScene live = scene.live({"physics.damping_ratio=0.5"});
  live.change("physics.damping_ratio", "0.1", view::Effect::kGoesOn);
  CHECK(live.undo_changes() == "");
  CHECK(live.world().parameters.seed.damping_ratio == 0.5);
  CHECK(live.changes().command_line() == "--set physics.damping_ratio=0.5");
}

TEST_CASE("advance_simulates_what_was_asked_and_no_more") {
  const SceneFolder scene;
  view::LiveScene live = scene.live();
  const double dt = live.world().parameters.dt;
  double asked = 0;
  for (int i = 0; i < 20; ++i, asked += 0.0103) live.advance(0.0103, 10);
  CHECK(live.world().time <= asked + 1e-12);
  CHECK(live.world().time > asked - dt - 1e-12);
  CHECK_FALSE(live.fell_behind());
}

TEST_CASE("advance_gives_up_when_its_budget_is_spent_and_says_so") {
  const SceneFolder scene;
  view::LiveScene live = scene.live();
  const double simulated = live.advance(1000, 0.005);
  CHECK(simulated > 0);
  CHECK(simulated < 1000);
  CHECK(live.fell_behind());
  // What was missed is not made up for.
  const double time = live.world().time;
  live.advance(live.world().parameters.dt, 10);
  CHECK(live.world().time < time + 2.5 * live.world().parameters.dt);
}

TEST_CASE("a_dragged_body_comes_to_the_hand") {
  const SceneFolder scene;
  view::LiveScene live = scene.live();
  const dem::Pose pose = dem::pose_of(live.world(), 0);
  dem::Drag drag = view::grip_body({0, 1, pose.position}, pose, live.world().bodies.mass[0]);
  drag.target = {0.3, 0.2, 1.2};
  live.hold(drag);
  live.advance(1.5, 10);
  // It hangs below the hand by g / omega^2 = 9.81 / (6 pi)^2 = 0.0276 m.
  const Eigen::Vector3d rest = drag.target - Eigen::Vector3d(0, 0, 0.0276);
  CHECK((dem::pose_of(live.world(), 0).position - rest).norm() < 2e-3);  // m, measured 1e-5
  live.hold(std::nullopt);
  live.advance(0.2, 10);
  CHECK(dem::pose_of(live.world(), 0).position.z() < 1.1);
}

TEST_CASE("a_dragged_body_of_dem_comes_to_the_hand_held_at_its_corner_too") {
  const SceneFolder scene;
  view::LiveScene live = scene.live({"physics={}"});
  CHECK(live.chosen_dt() == doctest::Approx(1.0 / 60));
  for (const int body : {0, 1}) {
    const dem::Pose pose = dem::pose_of(live.world(), body);
    const Eigen::Vector3d grip = pose.position + Eigen::Vector3d(0.09, 0.09, 0.09);
    dem::Drag drag = view::grip_body({body, 1, grip}, pose, live.world().bodies.mass[body]);
    drag.target = {0.3, 0.2, 1.2};
    live.hold(drag);
    CHECK(live.world().parameters.dt < live.chosen_dt());
    live.advance(20, 10);
    const Eigen::Vector3d rest = drag.target - Eigen::Vector3d(0, 0, 0.0276);
    const Eigen::Vector3d end = view::grip_point(drag, dem::pose_of(live.world(), body));
    CHECK((end - rest).norm() < 5e-3);  // m, measured 1.0e-3 and 2.4e-3: still swinging a little
    live.hold(std::nullopt);
    CHECK(live.world().parameters.dt == live.chosen_dt());
    live.advance(1, 10);
    CHECK(dem::pose_of(live.world(), body).position.z() < 0.9);
  }
  CHECK(live.failures().empty());
}

TEST_CASE("dem_takes_its_own_keys_live_or_by_a_restart") {
  const SceneFolder scene;
  view::LiveScene live = scene.live({"physics={}"});
  live.advance(0.1, 10);
  CHECK(live.change("physics.dt_s", "0.005", view::Effect::kGoesOn) == "");
  CHECK(live.world().parameters.dt == 0.005);
  CHECK(live.world().time > 0);
  CHECK(live.change("physics.max_penetration_m", "1e-5", view::Effect::kRestarts) == "");
  CHECK(live.change("physics.steps_per_contact", "20", view::Effect::kRestarts) == "");
  CHECK(live.change("physics.integrator", "explicit", view::Effect::kRestarts) == "");
  CHECK(live.world().time == 0);
  CHECK(live.world().surfaces->chosen().max_penetration == 1e-5);
  CHECK_FALSE(live.world().parameters.dem.rests_implicitly);
  CHECK(live.change("physics.damping_ratio", "1", view::Effect::kGoesOn).find("method: seed") !=
        std::string::npos);
}

TEST_CASE("a_failed_run_names_code_body_and_step") {
  const SceneFolder scene;
  view::LiveScene live = scene.live();
  live.change("physics.stiffness_n_m", "1", view::Effect::kGoesOn);
  live.advance(1, 10);
  REQUIRE_FALSE(live.failures().empty());
  CHECK(live.failures().front().code == "penetration");
  CHECK_FALSE(live.failures().front().body.empty());
  CHECK(live.failures().front().step > 0);
  live.change("physics.stiffness_n_m", "1000", view::Effect::kRestarts);
  CHECK(live.failures().empty());
}

TEST_CASE("changes_are_shown_as_a_shell_takes_them") {
  view::Changes changes({"physics.dt_s=1e-4"});
  changes.set("gravity_m_s2", "[0, 0, -1.62]");
  changes.set("physics.dt_s", view::number_text(0.00012345678));
  CHECK(changes.command_line() ==
        "--set physics.dt_s=0.0001235 --set 'gravity_m_s2=[0, 0, -1.62]'");
  CHECK(changes.overrides().size() == 2);
}

TEST_CASE("a_saved_scene_loads_with_the_changed_values") {
  const SceneFolder scene;
  const fs::path saved =
      view::save_scene(scene.file, {"gravity_m_s2=[0, 0, -1.62]", "physics.stiffness_n_m=1234"});
  CHECK(saved == scene.folder / "two_changed.yaml");
  const scene::Scene loaded = scene::load_scene(saved);
  CHECK(loaded.gravity == Eigen::Vector3d(0, 0, -1.62));
  CHECK(*loaded.physics.stiffness == 1234);
  CHECK(loaded.bodies.size() == 2);
  CHECK(scene::load_scene(scene.file).gravity.z() == -9.81);
}

TEST_CASE("saving_again_overwrites_nothing_and_leaves_no_scraps") {
  const SceneFolder scene;
  view::save_scene(scene.file, {"physics.stiffness_n_m=1"});
  CHECK(view::save_scene(scene.file, {"physics.stiffness_n_m=2"}).filename() ==
        "two_changed_2.yaml");
  CHECK(*scene::load_scene(scene.folder / "two_changed.yaml").physics.stiffness == 1);
  CHECK(std::distance(fs::directory_iterator(scene.folder), {}) == 3);
}

TEST_CASE("a_name_that_cannot_be_written_is_refused_and_leaves_no_scraps") {
  // The file's own name is as long as names may be, so the saved one would be too long.
  const SceneFolder scene;
  const fs::path file = scene.folder / (std::string(250, 'x') + ".yaml");
  std::ofstream(file) << kScene;
  CHECK_THROWS_AS(view::save_scene(file, {}), view::ViewError);
  CHECK(std::distance(fs::directory_iterator(scene.folder), {}) == 2);
}
