// SPDX-License-Identifier: MIT
// From a scene to what the physics starts from: mass, inertia, particles, chosen parameters.
#include "scene/build_world.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "scene/load_scene.h"
#include "scene/problem.h"

namespace {

using verisim::scene::build_world;
using verisim::scene::BuiltScene;
using verisim::scene::load_scene;
using verisim::scene::SceneError;

constexpr const char* kScene = R"(schema: 1
name: world
duration_s: 1
materials:
  wood: {density_kg_m3: 700}
bodies:
  - {name: ball, shape: {sphere_radius_m: 0.05}, material: wood, position_m: [0, 0, 1]}
  - {name: box, shape: {box_m: [0.2, 0.4, 0.1]}, material: wood, position_m: [1, 0, 0.05]}
  - {name: fox, shape: {mesh: MESH, scale: 0.5}, material: wood, position_m: [3, 0, 1]}
ground: {plane: {normal: [0, 0, 1]}, material: wood}
physics: {method: seed}
)";

std::filesystem::path write_scene(const std::string& mesh) {
  std::string text = kScene;
  text.replace(text.find("MESH"), 4, mesh);
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / "verisim_build_world_test.yaml";
  std::ofstream(file) << text;
  return file;
}

BuiltScene build(const std::vector<std::string>& overrides = {}) {
  return build_world(
      load_scene(write_scene(VERISIM_SOURCE_DIR "/stimuli/meshes/fox.obj"), overrides));
}

}  // namespace

TEST_CASE("a_ball_is_one_particle_with_the_mass_of_a_sphere") {
  const BuiltScene built = build();
  const auto& ball = built.world.bodies[0];
  CHECK(ball.particle_offsets_b.size() == 1);
  CHECK(ball.particle_radius == 0.05);
  const double mass = 700 * 4.0 / 3 * std::numbers::pi * 0.05 * 0.05 * 0.05;
  CHECK(ball.mass == doctest::Approx(mass).epsilon(1e-14));
  CHECK(ball.inertia_b(0, 0) == doctest::Approx(0.4 * mass * 0.05 * 0.05).epsilon(1e-14));
}

TEST_CASE("mass_comes_from_the_shape_whatever_the_particle_size") {
  const BuiltScene coarse = build({"physics.particle_size_m=0.1"});
  const BuiltScene fine = build({"physics.particle_size_m=0.05"});
  CHECK(coarse.world.bodies[1].mass == doctest::Approx(700 * 0.2 * 0.4 * 0.1).epsilon(1e-14));
  CHECK(coarse.world.bodies[2].mass == fine.world.bodies[2].mass);
  CHECK(coarse.world.bodies[2].inertia_b == fine.world.bodies[2].inertia_b);
  CHECK(coarse.world.bodies[1].particle_offsets_b.size() == 2 * 4 * 1);
  CHECK(fine.world.bodies[1].particle_offsets_b.size() == 4 * 8 * 2);
}

TEST_CASE("meshes_are_drawn_around_their_centre_of_mass") {
  // The mean of the volume: doubling the mesh's scale about the centre of mass keeps it there.
  const BuiltScene built = build();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double volume = 0;
  const auto& mesh = built.meshes[2];
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]],
                          &c = mesh.vertices[t[2]];
    const double v = a.dot(b.cross(c)) / 6;  // tetrahedron with the origin
    volume += v;
    moment += v * (a + b + c) / 4;
  }
  CHECK((moment / volume).norm() < 1e-12);  // measured 5e-17 m
}

TEST_CASE("what_a_scene_names_is_used_and_the_rest_is_chosen") {
  const BuiltScene chosen = build();
  CHECK(chosen.world.dt > 0);
  CHECK(chosen.world.seed.stiffness > 0);
  const BuiltScene named =
      build({"physics={method: seed, dt_s: 1e-5, stiffness_n_m: 123, damping_ratio: 0.3, "
             "integrator: rkmk4}"});
  CHECK(named.world.dt == 1e-5);
  CHECK(named.world.seed.stiffness == 123);
  CHECK(named.world.seed.damping_ratio == 0.3);
  CHECK(named.world.integrator == verisim::dem::Integrator::kRkmk4);
}

TEST_CASE("a_scene_that_names_no_method_has_surfaces_and_no_particles") {
  using namespace verisim::dem;
  const WorldDefinition world = build({"physics={}"}).world;
  CHECK(world.method == Method::kDem);
  CHECK(world.dem.rests_implicitly);
  CHECK(world.dem.steps_per_contact == 40);
  CHECK(world.dem.max_penetration == 0);  // chosen when the world is made
  for (const BodyDefinition& body : world.bodies) {
    CHECK((body.particle_offsets_b.empty() || body.shape.index() == 1));
  }
  CHECK(std::get<SphereShape>(world.bodies[0].shape).radius == 0.05);
  CHECK(std::get<BoxShape>(world.bodies[1].shape).half == Eigen::Vector3d(0.1, 0.2, 0.05));
  // A box meets the mesh by its surface points, in a scene with a mesh.
  CHECK(std::get<BoxShape>(world.bodies[1].shape).surface != nullptr);
  CHECK(std::get<MeshShape>(world.bodies[2].shape).surface != nullptr);

  const WorldDefinition named =
      build({"physics={integrator: explicit, max_penetration_m: 1e-5, steps_per_contact: 20}"})
          .world;
  CHECK_FALSE(named.dem.rests_implicitly);
  CHECK(named.dem.max_penetration == 1e-5);
  CHECK(named.dem.steps_per_contact == 20);
}

TEST_CASE("a_pair_of_materials_has_the_geometric_mean_unless_the_scene_says_otherwise") {
  const std::vector<std::string> two = {
      "physics={}",
      "materials={wood: {density_kg_m3: 700, restitution: 0.9, friction: 0.2},"
      " ice: {density_kg_m3: 900, restitution: 0.4, friction: 0.05}}"};
  const auto pairs = build(two).world.material_pairs;
  REQUIRE(pairs.count == 2);
  CHECK(pairs.restitution[pairs.at(0, 0)] == doctest::Approx(0.9));
  CHECK(pairs.restitution[pairs.at(0, 1)] == doctest::Approx(0.6));
  CHECK(pairs.friction[pairs.at(1, 0)] == doctest::Approx(0.1));
  std::vector<std::string> own = two;
  own.emplace_back("material_pairs=[{materials: [ice, wood], restitution: 0.1}]");
  const auto named = build(own).world.material_pairs;
  CHECK(named.restitution[named.at(0, 1)] == 0.1);
  CHECK(named.restitution[named.at(1, 0)] == 0.1);
  CHECK(named.friction[named.at(0, 1)] == doctest::Approx(0.1));
}

TEST_CASE("a_scene_without_wind_has_no_drag_patches_and_one_with_wind_has_those_of_its_surfaces") {
  const std::vector<std::string> dem{"physics={}"};
  for (const auto& body : build(dem).world.bodies) CHECK(body.drag_patches.empty());
  const BuiltScene windy = build({"physics={}", "modules={wind: {velocity_m_s: [1, 0, 0]}}"});
  CHECK(windy.world.bodies[0].drag_patches.empty());
  double area = 0;
  for (const auto& patch : windy.world.bodies[1].drag_patches) area += patch.area;
  CHECK(area == doctest::Approx(2 * (0.2 * 0.4 + 0.4 * 0.1 + 0.1 * 0.2)).epsilon(1e-12));
  CHECK_FALSE(windy.world.bodies[2].drag_patches.empty());
}

TEST_CASE("a_line_shorter_than_its_ends_are_apart_is_refused") {
  try {
    build({"physics={}", "modules={tethers: [{body: ball, anchor_m: [0, 0, 2], length_m: 0.9}]}"});
    FAIL("not refused");
  } catch (const SceneError& error) {
    REQUIRE(error.problems.size() == 1);
    CHECK(error.problems[0].key == "modules.tethers.0");
  }
}

TEST_CASE("a_mesh_that_is_no_solid_names_the_body_and_the_fault") {
  const std::filesystem::path mesh =
      std::filesystem::temp_directory_path() / "verisim_open_mesh_test.obj";
  std::ofstream(mesh) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n";
  try {
    build_world(load_scene(write_scene(mesh.string())));
    FAIL("an open mesh was accepted");
  } catch (const SceneError& error) {
    REQUIRE(error.problems.size() == 1);
    CHECK(error.problems[0].key == "bodies.fox.shape");
    CHECK(std::string(error.what()).find("verisim_open_mesh_test.obj") != std::string::npos);
  }
}

TEST_CASE("a_particle_size_that_would_exhaust_memory_is_refused") {
  CHECK_THROWS_AS(build({"physics.particle_size_m=1e-6"}), SceneError);
}
