// SPDX-License-Identifier: MIT
// What the C++ drivers share: the scene as read, the timed loop of frames, poses and result
// written. A driver is a program that takes one folder: scene.json in, poses.bin and result.json
// out.
#pragma once

#include <time.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace peer {

using Vec3 = std::array<double, 3>;
using Quat = std::array<double, 4>;  // w first, principal frame of the body to world

constexpr size_t kRehearseUpTo = 200;  // bodies; a step of more takes longer than what it warms
constexpr double kRehearsalS = 0.02;   // of the processor; a page fault or a lazy symbol takes 1e-6

enum class Kind { box, sphere, mesh, spheres };

struct Body {
  bool is_free;
  Kind kind;
  Vec3 half_extents;                          // m, of a box
  double radius;                              // m, of a sphere; of each of `spheres`
  std::vector<Vec3> vertices;                 // of a convex mesh
  std::vector<std::array<int, 3>> triangles;  // of its hull, outward
  std::vector<Vec3> centres;                  // of spheres
  int material;
  double mass;                                       // kg
  Vec3 inertia;                                      // kg m2, diagonal
  Vec3 position, linear_velocity, angular_velocity;  // world
  Quat orientation;
};

struct Plane {
  Vec3 normal;
  double offset;  // m; solid below normal . x = offset
  int material;
};

struct Scene {
  std::string config;
  Vec3 gravity;
  double dt;  // s
  int steps_per_frame, num_frames, warm_up_frames;
  double time_limit_s;  // wall clock of the stepping
  std::vector<Plane> planes;
  std::vector<Body> bodies;
  std::vector<std::vector<double>> restitution, friction;  // by pair of materials

  bool any_restitution() const {
    for (const auto& row : restitution)
      for (double value : row)
        if (value > 0) return true;
    return false;
  }
};

/// One body's state in the world, as the pose log has it.
struct State {
  Vec3 position;
  Quat orientation;
  Vec3 linear_velocity, angular_velocity;
};

inline Kind kind_of(const std::string& name) {
  if (name == "box") return Kind::box;
  if (name == "sphere") return Kind::sphere;
  if (name == "mesh") return Kind::mesh;
  if (name == "spheres") return Kind::spheres;
  throw std::runtime_error("unknown shape " + name);
}

inline Scene read_scene(const std::string& file) {
  std::ifstream stream(file);
  const nlohmann::json data = nlohmann::json::parse(stream);
  Scene scene;
  data.at("config").get_to(scene.config);
  data.at("gravity").get_to(scene.gravity);
  data.at("dt_s").get_to(scene.dt);
  data.at("steps_per_frame").get_to(scene.steps_per_frame);
  data.at("num_frames").get_to(scene.num_frames);
  data.at("warm_up_frames").get_to(scene.warm_up_frames);
  data.at("time_limit_s").get_to(scene.time_limit_s);
  data.at("restitution").get_to(scene.restitution);
  data.at("friction").get_to(scene.friction);
  for (const auto& item : data.at("planes"))
    scene.planes.push_back({item.at("normal").get<Vec3>(), item.at("offset").get<double>(),
                            item.at("material").get<int>()});
  for (const auto& item : data.at("bodies")) {
    const auto& shape = item.at("shape");
    Body body;
    body.is_free = item.at("motion") == "free";
    body.kind = kind_of(shape.at("kind").get<std::string>());
    shape.at("half_extents").get_to(body.half_extents);
    shape.at("radius").get_to(body.radius);
    shape.at("vertices").get_to(body.vertices);
    shape.at("triangles").get_to(body.triangles);
    shape.at("centres").get_to(body.centres);
    item.at("material").get_to(body.material);
    item.at("mass").get_to(body.mass);
    item.at("inertia").get_to(body.inertia);
    item.at("position").get_to(body.position);
    item.at("orientation_wxyz").get_to(body.orientation);
    item.at("linear_velocity").get_to(body.linear_velocity);
    item.at("angular_velocity").get_to(body.angular_velocity);
    scene.bodies.push_back(std::move(body));
  }
  return scene;
}

inline double cpu_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

inline bool is_finite(const State& state) {
  double sum = 0;
  for (double value : state.position) sum += value;
  for (double value : state.orientation) sum += value;
  for (double value : state.linear_velocity) sum += value;
  for (double value : state.angular_velocity) sum += value;
  return std::isfinite(sum);
}

/// Steps a world that is thrown away, so that the timed one finds code and libraries loaded.
template <class World>
void rehearse(const Scene& scene) {
  World world(scene);
  const double end = cpu_seconds() + kRehearsalS;
  const int num_steps = scene.num_frames * scene.steps_per_frame;
  for (int step = 0; step < num_steps && cpu_seconds() < end; ++step) world.step();
}

/// Steps a world through the scene and writes what came of it.
/// World: constructor from a Scene, step(), state(body), version(), failure() (empty if none).
/// The processor's clock is read where the warm-up ends and after the last frame, so the time holds
/// the stepping and the copies of the poses of each frame, which cost far less.
template <class World>
void run(const Scene& scene, const std::string& folder) {
  World world(scene);
  const size_t num_bodies = scene.bodies.size();
  std::vector<State> states(num_bodies * static_cast<size_t>(scene.num_frames + 1));
  for (size_t i = 0; i < num_bodies; ++i) {
    const Body& body = scene.bodies[i];
    states[i] = {body.position, body.orientation, body.linear_velocity, body.angular_velocity};
  }
  std::string failed;
  int frame = 0;
  const auto started = std::chrono::steady_clock::now();
  double cpu_start = cpu_seconds();
  while (frame < scene.num_frames && failed.empty()) {
    if (frame == scene.warm_up_frames) cpu_start = cpu_seconds();
    for (int step = 0; step < scene.steps_per_frame; ++step) world.step();
    bool finite = true;
    State* row = &states[num_bodies * static_cast<size_t>(frame + 1)];
    for (size_t i = 0; i < num_bodies; ++i) {
      row[i] = scene.bodies[i].is_free ? world.state(i) : states[i];
      finite = finite && is_finite(row[i]);
    }
    failed = world.failure();
    if (!finite) failed = "numbers that are not finite";
    if (failed.empty()) ++frame;
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - started;
    if (failed.empty() && frame < scene.num_frames && wall.count() > scene.time_limit_s)
      failed = "time limit of " + nlohmann::json(scene.time_limit_s).dump() + " s";
  }
  const double cpu = cpu_seconds() - cpu_start;
  const double frame_s = scene.dt * scene.steps_per_frame;
  if (!failed.empty()) failed += " at " + nlohmann::json(frame * frame_s).dump() + " s";

  std::ofstream poses(folder + "/poses.bin", std::ios::binary);
  static_assert(sizeof(State) == 13 * sizeof(double));
  poses.write(
      reinterpret_cast<const char*>(states.data()),
      static_cast<std::streamsize>(sizeof(State) * num_bodies * static_cast<size_t>(frame + 1)));
  nlohmann::json result = {{"cpu_s", frame > scene.warm_up_frames ? cpu : 0.0},
                           {"simulated_s", std::max(0, frame - scene.warm_up_frames) * frame_s},
                           {"version", world.version()},
                           {"failed", nullptr}};
  if (!failed.empty()) result["failed"] = failed;
  poses.close();
  std::ofstream(folder + "/result.json") << result << "\n";
}

template <class World>
int run_main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
    return 2;
  }
  try {
    const Scene scene = read_scene(std::string(argv[1]) + "/scene.json");
    if (scene.bodies.size() <= kRehearseUpTo) rehearse<World>(scene);
    run<World>(scene, argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}

}  // namespace peer
