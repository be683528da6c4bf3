// SPDX-License-Identifier: MIT
// Scenes are read strictly: every error at once, with file, line, key, value and hint.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "scene/load_scene.h"

namespace {

using verisim::scene::load_scene;
using verisim::scene::Problem;
using verisim::scene::Scene;
using verisim::scene::SceneError;

constexpr const char* kGood = R"(schema: 1
name: good
duration_s: 2
materials:
  wood: {density_kg_m3: 700, restitution: 0.3}
  steel: {density_kg_m3: 7800}
bodies:
  - {name: base, shape: {box_m: [0.2, 0.3, 0.4]}, material: wood, position_m: [0, 0, 0.2], motion: fixed}
  - {name: ball, shape: {sphere_radius_m: 0.05}, material: steel, position_m: [0.3, 0, 0.5],
     velocity_m_s: [1, 0, 0], orientation_wxyz: [2, 0, 0, 0]}
ground: {plane: {normal: [0, 0, 2], offset_m: 0.1}, material: wood}
physics: {dt_s: 1e-4}
expect: {stands: [base]}
)";

// A scene file that lives as long as the test case.
struct File {
  explicit File(const std::string& text) {
    path = std::filesystem::temp_directory_path() /
           ("verisim_scene_test_" + std::to_string(counter++) + ".yaml");
    std::ofstream(path) << text;
  }
  ~File() { std::filesystem::remove(path); }
  std::filesystem::path path;
  static inline int counter = 0;
};

std::vector<Problem> problems_of(const std::string& text,
                                 const std::vector<std::string>& overrides = {}) {
  const File file(text);
  try {
    load_scene(file.path, overrides);
  } catch (const SceneError& error) {
    return error.problems;
  }
  return {};
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("a_good_scene_is_read_with_units_and_defaults") {
  const File file(kGood);
  const Scene scene = load_scene(file.path);
  CHECK(scene.name == "good");
  CHECK(scene.frame_rate == 60);
  CHECK(scene.gravity.z() == -9.81);
  REQUIRE(scene.bodies.size() == 2);
  CHECK(scene.bodies[0].motion == verisim::dem::Motion::kFixed);
  CHECK(scene.bodies[0].shape.box.y() == 0.3);
  CHECK(scene.bodies[1].initial.orientation.w() == 1);  // normalised
  CHECK(scene.materials[scene.bodies[1].material].density == 7800);
  CHECK(scene.ground->normal.z() == 1);
  CHECK(*scene.physics.dt == 1e-4);
  CHECK(!scene.physics.stiffness);
  CHECK(scene.stands == std::vector<int>{0});
}

TEST_CASE("every_error_is_reported_at_once_with_its_line") {
  std::string text = replaced(kGood, "duration_s: 2", "duration_s: 2 s");
  text = replaced(text, "density_kg_m3: 700", "density_g_cm3: 0.7");
  text = replaced(text, "sphere_radius_m: 0.05", "sphere_radius_m: -0.05");
  text = replaced(text, "motion: fixed", "motion: static");
  const std::vector<Problem> problems = problems_of(text);
  REQUIRE(problems.size() == 5);  // the unknown density key also leaves the right one missing
  CHECK(problems[0].key == "duration_s");
  CHECK(problems[0].where.ends_with(":3"));
  CHECK(problems[0].seen == "2 s");
  CHECK(problems[0].allowed == "a number > 0 and <= 3600");
  CHECK(problems[1].key == "materials.wood.density_g_cm3");
  CHECK(problems[1].where.ends_with(":5"));
  CHECK(problems[1].hint.find("density_kg_m3") != std::string::npos);
  CHECK(problems[2].key == "materials.wood.density_kg_m3");
  CHECK(problems[3].key == "bodies.base.motion");
  CHECK(problems[3].allowed.find("free, fixed") != std::string::npos);
  CHECK(problems[4].key == "bodies.ball.shape.sphere_radius_m");
  CHECK(problems[4].where.ends_with(":9"));
}

TEST_CASE("meaning_is_checked_after_form") {
  std::string text = replaced(kGood, "material: steel", "material: stel");
  text = replaced(text, "stands: [base]", "stands: [bass]");
  text = replaced(text, "orientation_wxyz: [2, 0, 0, 0]", "orientation_wxyz: [0, 0, 0, 0]");
  const std::vector<Problem> problems = problems_of(text);
  REQUIRE(problems.size() == 3);
  CHECK(problems[0].key == "bodies.ball.material");
  CHECK(problems[0].allowed == "one of: wood, steel");
  CHECK(problems[1].key == "bodies.ball.orientation_wxyz");
  CHECK(problems[2].key == "expect.stands");
}

TEST_CASE("a_key_of_the_other_method_is_refused") {
  const std::vector<Problem> of_seed = problems_of(replaced(
      kGood, "{dt_s: 1e-4}", "{particle_size_m: 0.1, damping_ratio: 1, integrator: seed}"));
  REQUIRE(of_seed.size() == 3);
  CHECK(of_seed[0].key == "physics.integrator");
  CHECK(of_seed[0].allowed == "one of: hybrid, explicit (method dem)");
  CHECK(of_seed[1].key == "physics.particle_size_m");
  CHECK(of_seed[1].allowed == "only with method: seed");
  CHECK(of_seed[2].key == "physics.damping_ratio");
  const std::vector<Problem> of_dem = problems_of(replaced(
      kGood, "{dt_s: 1e-4}", "{method: seed, max_penetration_m: 1e-4, integrator: hybrid}"));
  REQUIRE(of_dem.size() == 2);
  CHECK(of_dem[0].allowed == "one of: seed, rkmk4 (method seed)");
  CHECK(of_dem[1].allowed == "only with method: dem");
}

TEST_CASE("what_method_xpbd_does_not_model_is_refused") {
  const std::string text =
      replaced(kGood, "{dt_s: 1e-4}",
               "{method: xpbd, substeps: 40, integrator: hybrid, stiffness_n_m: 1e5, "
               "max_penetration_m: 1e-4}") +
      "modules:\n  wind: {velocity_m_s: [3, 0, 0]}\n"
      "  tethers:\n    - {body: ball, anchor_m: [0.3, 0, 1]}\n";
  const std::vector<Problem> problems = problems_of(text);
  REQUIRE(problems.size() == 4);
  CHECK(problems[0].key == "physics.integrator");
  CHECK(problems[1].key == "physics.max_penetration_m");
  CHECK(problems[1].allowed == "only with method: dem");
  CHECK(problems[2].key == "physics.stiffness_n_m");
  CHECK(problems[3].key == "modules.tethers");
  const File file(replaced(kGood, "{dt_s: 1e-4}", "{method: xpbd, substeps: 40}"));
  const Scene scene = load_scene(file.path);
  CHECK(scene.physics.method == verisim::dem::Method::kXpbd);
  CHECK(scene.physics.substeps == 40);
  const std::vector<Problem> of_dem =
      problems_of(replaced(kGood, "{dt_s: 1e-4}", "{substeps: 40}"));
  REQUIRE(of_dem.size() == 1);
  CHECK(of_dem[0].allowed == "only with method: xpbd");
}

TEST_CASE("modules_and_laws_are_read_by_name") {
  const std::string text =
      replaced(kGood, "{dt_s: 1e-4}", "{contact_law: linear, tangential_law: rigid_stick}") +
      "modules:\n  wind: {velocity_m_s: [3, 0, 0], drag_coefficient: 1.2}\n"
      "  tethers:\n    - {body: ball, anchor_m: [0.3, 0, 1], length_m: 0.6}\n"
      "    - {bodies: [ball, base], attach_m: [0, 0, -0.05]}\n";
  const File file(text);
  const Scene scene = load_scene(file.path, {});
  CHECK(scene.physics.contact_law == verisim::dem::NormalLaw::kLinear);
  CHECK(scene.physics.tangential_law == verisim::dem::TangentialLaw::kRigidStick);
  REQUIRE(scene.wind.has_value());
  CHECK(scene.wind->velocity == Eigen::Vector3d(3, 0, 0));
  CHECK(scene.wind->density == 1.2);
  CHECK(scene.wind->drag_coefficient == 1.2);
  REQUIRE(scene.tethers.size() == 2);
  CHECK(scene.tethers[0].body == 1);
  CHECK(scene.tethers[0].other == -1);
  CHECK(scene.tethers[0].length == 0.6);
  CHECK(scene.tethers[1].other == 0);
  CHECK(scene.tethers[1].length < 0);
}

TEST_CASE("a_tether_names_one_body_and_an_anchor_or_two_bodies") {
  const std::vector<Problem> problems = problems_of(
      std::string(kGood) +
      "modules:\n  tethers:\n    - {anchor_m: [0, 0, 1]}\n    - {body: boll, anchor_m: [0, 0, 1]}\n"
      "    - {body: ball}\n    - {bodies: [ball]}\n");
  REQUIRE(problems.size() == 4);
  CHECK(problems[0].key == "modules.tethers.0");
  CHECK(problems[0].allowed == "body, or bodies with two names");
  CHECK(problems[1].key == "modules.tethers.1.body");
  CHECK(problems[2].key == "modules.tethers.2.anchor_m");
  CHECK(problems[3].key == "modules.tethers.3");
}

TEST_CASE("hertz_and_mindlin_ask_for_spheres_and_moduli") {
  const std::vector<Problem> problems = problems_of(
      replaced(replaced(kGood, "{dt_s: 1e-4}", "{contact_law: hertz_mindlin}"),
               "steel: {density_kg_m3: 7800}",
               "steel: {density_kg_m3: 7800, young_modulus_pa: 2e11, poisson_ratio: 0.3}"));
  REQUIRE(problems.size() == 3);
  CHECK(problems[0].key == "physics.contact_law");
  CHECK(problems[0].hint.find("base") != std::string::npos);
  CHECK(problems[1].key == "materials.wood.young_modulus_pa");
  CHECK(problems[2].key == "materials.wood.poisson_ratio");
}

TEST_CASE("modules_belong_to_method_dem") {
  const std::vector<Problem> problems =
      problems_of(replaced(kGood, "{dt_s: 1e-4}", "{method: seed, contact_law: linear}") +
                  "modules: {wind: {velocity_m_s: [1, 0, 0]}}\n");
  REQUIRE(problems.size() == 2);
  CHECK(problems[0].key == "physics.contact_law");
  CHECK(problems[1].key == "modules");
}

TEST_CASE("a_key_written_twice_is_an_error") {
  const std::vector<Problem> problems =
      problems_of(replaced(kGood, "duration_s: 2", "duration_s: 2\nduration_s: 3"));
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].where.ends_with(":4"));
}

TEST_CASE("a_shape_is_exactly_one_of_its_kinds") {
  const std::vector<Problem> problems = problems_of(
      replaced(kGood, "{sphere_radius_m: 0.05}", "{sphere_radius_m: 1, box_m: [1, 1, 1]}"));
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].allowed == "exactly one of: box_m, sphere_radius_m, mesh");
}

TEST_CASE("quoted_numbers_and_non_finite_numbers_are_refused") {
  CHECK(problems_of(replaced(kGood, "duration_s: 2", "duration_s: '2'")).size() == 1);
  CHECK(problems_of(replaced(kGood, "duration_s: 2", "duration_s: .inf")).size() == 1);
  CHECK(problems_of(replaced(kGood, "duration_s: 2", "duration_s: nan")).size() == 1);
  CHECK(problems_of(replaced(kGood, "duration_s: 2", "duration_s: 1e999")).size() == 1);
}

TEST_CASE("a_missing_mesh_names_where_it_was_looked_for") {
  const std::vector<Problem> problems =
      problems_of(replaced(kGood, "{sphere_radius_m: 0.05}", "{mesh: meshes/no_such.obj}"));
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].key == "bodies.ball.shape.mesh");
  CHECK(problems[0].hint.find("no_such.obj") != std::string::npos);
}

TEST_CASE("overrides_reach_bodies_by_name_and_by_index") {
  const File file(kGood);
  const Scene scene =
      load_scene(file.path, {"bodies.ball.position_m=[0, 0, 2]", "bodies.0.shape.box_m=[1, 1, 1]",
                             "physics.dt_s=2e-5", "physics.stiffness_n_m=500", "seed=7"});
  CHECK(scene.bodies[1].initial.position.z() == 2);
  CHECK(scene.bodies[0].shape.box.x() == 1);
  CHECK(*scene.physics.dt == 2e-5);
  CHECK(*scene.physics.stiffness == 500);
  CHECK(scene.seed == 7);
}

TEST_CASE("an_override_can_add_a_whole_map_and_replace_a_shape") {
  const File file(kGood);
  const Scene scene =
      load_scene(file.path, {"camera.position_m=[1, 1, 1]", "camera.look_at_m=[0,0,0]",
                             "bodies.ball.shape={box_m: [1, 2, 3]}"});
  CHECK(scene.camera->position.x() == 1);
  CHECK(scene.bodies[1].shape.kind == verisim::scene::ShapeKind::kBox);
}

TEST_CASE("a_bad_override_is_named_as_such") {
  const std::vector<Problem> wrong_value = problems_of(kGood, {"physics.dt_s=fast"});
  REQUIRE(wrong_value.size() == 1);
  CHECK(wrong_value[0].where == "--set physics.dt_s=fast");
  const std::vector<Problem> wrong_name = problems_of(kGood, {"bodies.cat.position_m=[0,0,0]"});
  REQUIRE(wrong_name.size() == 1);
  CHECK(wrong_name[0].allowed.find("base, ball") != std::string::npos);
  CHECK(problems_of(kGood, {"physics.dt_s"}).size() == 1);
}

TEST_CASE("broken_yaml_and_missing_files_name_the_file") {
  const std::vector<Problem> broken = problems_of("schema: 1\nname: [a\n");
  REQUIRE(broken.size() == 1);
  CHECK(broken[0].where.find(".yaml:") != std::string::npos);
  CHECK_THROWS_AS(load_scene("no_such_scene.yaml"), SceneError);
  CHECK(problems_of("just text").size() == 1);
  CHECK(problems_of("").size() == 1);
}
