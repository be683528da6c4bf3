// SPDX-License-Identifier: MIT
#include "scene/build_world.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>

#include "dem/defaults.h"
#include "dem/tether_definition.h"
#include "scene/contact_geometry.h"
#include "scene/drag_patches.h"
#include "scene/problem.h"
#include "shape/check_mesh.h"
#include "shape/extents.h"
#include "shape/fill_particles.h"
#include "shape/load_mesh.h"
#include "shape/mass_properties.h"
#include "shape/primitives.h"

namespace verisim::scene {
namespace {

constexpr int kSphereSubdivisions = 4;     // 5120 triangles: round at 1280x720
constexpr double kLongestStep = 1.0 / 60;  // s, of methods dem and xpbd
constexpr double kParticlesPerExtent = 4;  // default particle size: a quarter of the body

// A shape with everything bodies share that have it. Frame: body axes, origin at the centre of
// mass.
struct Solid {
  shape::MassProperties mass;  // unit density
  shape::Mesh mesh;
  double smallest_extent = 0;              // m
  dem::CollisionShape shape;               // methods dem and xpbd
  std::vector<Eigen::Vector3d> particles;  // m
  std::vector<dem::DragPatch> patches;     // where there is wind
  double particle_radius = 0;              // m
};

shape::Mesh load_solid_mesh(const ShapeSpec& spec) {
  shape::Mesh mesh = shape::load_mesh(spec.mesh);
  shape::require_solid(mesh, spec.mesh.string());
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex *= spec.scale;
  return mesh;
}

void set_particles(shape::ParticleFill particles, Solid& solid) {
  solid.particles = std::move(particles.centers);
  solid.particle_radius = particles.radius;
}

std::shared_ptr<const dem::MeshSurface> surface_of(const shape::Mesh& mesh_from_com) {
  return std::make_shared<const dem::MeshSurface>(
      make_mesh_surface(mesh_from_com, default_sample_spacing(mesh_from_com)));
}

Solid make_sphere(double radius) {
  Solid solid;
  solid.mass = shape::sphere_mass_properties(radius);
  solid.mesh = shape::sphere_mesh(radius, kSphereSubdivisions);
  solid.smallest_extent = 2 * radius;
  solid.shape = dem::SphereShape{radius};
  solid.particles = {Eigen::Vector3d::Zero()};
  solid.particle_radius = radius;
  return solid;
}

Solid make_box(const Eigen::Vector3d& edges, const Physics& physics, bool meets_meshes) {
  Solid solid;
  solid.mass = shape::box_mass_properties(edges);
  solid.mesh = shape::box_mesh(edges);
  solid.smallest_extent = edges.minCoeff();
  if (dem::has_surfaces(physics.method)) {
    dem::BoxShape box{0.5 * edges, nullptr};
    if (meets_meshes) box.surface = surface_of(solid.mesh);
    solid.shape = box;
    return solid;
  }
  const double size = physics.particle_size.value_or(solid.smallest_extent / kParticlesPerExtent);
  set_particles(shape::fill_box(edges, size), solid);
  return solid;
}

Solid make_mesh_solid(const ShapeSpec& spec, const Physics& physics) {
  Solid solid;
  solid.mesh = load_solid_mesh(spec);
  solid.mass = shape::mesh_mass_properties(solid.mesh);
  solid.smallest_extent = shape::smallest_extent(solid.mesh);
  if (dem::has_surfaces(physics.method)) {
    for (Eigen::Vector3d& vertex : solid.mesh.vertices) vertex -= solid.mass.center_of_mass;
    solid.shape = dem::MeshShape{surface_of(solid.mesh)};
    return solid;
  }
  const double size = physics.particle_size.value_or(solid.smallest_extent / kParticlesPerExtent);
  shape::ParticleFill particles = shape::fill_mesh(solid.mesh, size);
  if (particles.centers.empty()) {
    throw shape::MeshError("no particle of " + std::to_string(size) +
                           " m has its centre inside; choose a smaller physics.particle_size_m");
  }
  for (Eigen::Vector3d& center : particles.centers) center -= solid.mass.center_of_mass;
  for (Eigen::Vector3d& vertex : solid.mesh.vertices) vertex -= solid.mass.center_of_mass;
  set_particles(std::move(particles), solid);
  return solid;
}

Solid make_solid(const ShapeSpec& spec, const Physics& physics, bool meets_meshes) {
  switch (spec.kind) {
    case ShapeKind::kSphere:
      return make_sphere(spec.radius);
    case ShapeKind::kBox:
      return make_box(spec.box, physics, meets_meshes);
    case ShapeKind::kMesh:
      break;
  }
  return make_mesh_solid(spec, physics);
}

std::string key_of(const ShapeSpec& spec) {
  if (spec.kind == ShapeKind::kMesh) return spec.mesh.string() + "*" + std::to_string(spec.scale);
  std::string key = spec.kind == ShapeKind::kBox ? "box" : "sphere";
  for (double value : {spec.box.x(), spec.box.y(), spec.box.z(), spec.radius}) {
    key += " " + std::to_string(std::bit_cast<std::uint64_t>(value));
  }
  return key;
}

dem::BodyDefinition body_definition(const Body& body, const Solid& solid, double density) {
  dem::BodyDefinition definition;
  definition.name = body.name;
  definition.motion = body.motion;
  definition.mass = density * solid.mass.volume;
  definition.inertia_b = density * solid.mass.inertia;
  definition.initial = body.initial;
  definition.material = body.material;
  definition.shape = solid.shape;
  definition.particle_offsets_b = solid.particles;
  definition.particle_radius = solid.particle_radius;
  definition.size = solid.smallest_extent;
  definition.prescribed = body.prescribed;
  definition.drag_patches = solid.patches;
  return definition;
}

double pair_mean(double a, double b) { return std::sqrt(a * b); }

dem::MaterialPairs material_pairs(const Scene& scene) {
  dem::MaterialPairs pairs;
  pairs.count = static_cast<int>(scene.materials.size());
  for (const Material& a : scene.materials) {
    for (const Material& b : scene.materials) {
      pairs.restitution.push_back(pair_mean(a.restitution, b.restitution));
      pairs.friction.push_back(pair_mean(a.friction, b.friction));
      pairs.rolling_friction.push_back(pair_mean(a.rolling_friction, b.rolling_friction));
    }
    if (scene.physics.contact_law != dem::NormalLaw::kHertzMindlin) continue;
    pairs.young_modulus.push_back(*a.young_modulus);
    pairs.poisson_ratio.push_back(*a.poisson_ratio);
  }
  for (const MaterialPair& own : scene.material_pairs) {
    for (const std::size_t k : {pairs.at(own.a, own.b), pairs.at(own.b, own.a)}) {
      if (own.restitution) pairs.restitution[k] = *own.restitution;
      if (own.friction) pairs.friction[k] = *own.friction;
      if (own.rolling_friction) pairs.rolling_friction[k] = *own.rolling_friction;
    }
  }
  return pairs;
}

void choose_parameters(const Physics& physics, dem::WorldDefinition& world) {
  world.method = physics.method;
  if (physics.method == dem::Method::kDem) {
    world.integrator = dem::Integrator::kRkmk4;
    world.dem.rests_implicitly = physics.integrator != "explicit";
    world.dem.contact_law = physics.contact_law;
    world.dem.tangential_law = physics.tangential_law;
    world.dem.max_penetration = physics.max_penetration.value_or(0);
    world.dem.stiffness = physics.stiffness.value_or(0);
    if (physics.steps_per_contact) world.dem.steps_per_contact = *physics.steps_per_contact;
    world.dt = physics.dt.value_or(kLongestStep);
    return;
  }
  if (physics.method == dem::Method::kXpbd) {
    world.integrator = dem::Integrator::kRkmk4;
    if (physics.substeps) world.xpbd.substeps = *physics.substeps;
    world.dt = physics.dt.value_or(kLongestStep);
    return;
  }
  world.integrator =
      physics.integrator == "rkmk4" ? dem::Integrator::kRkmk4 : dem::Integrator::kSeed;
  world.seed = dem::default_seed_settings(world);
  if (physics.stiffness) world.seed.stiffness = *physics.stiffness;
  world.seed.damping_ratio = physics.damping_ratio;
  world.seed.tangential_damping_ratio = physics.tangential_damping_ratio;
  world.dt = physics.dt ? *physics.dt : dem::default_dt(world);
}

}  // namespace

BuiltScene build_world(const Scene& scene) {
  BuiltScene built;
  std::vector<Problem> problems;
  std::map<std::string, Solid> solids;
  built.world.gravity = scene.gravity;
  built.world.wind = scene.wind;
  built.world.tethers = scene.tethers;
  built.world.material_pairs = material_pairs(scene);
  const bool has_mesh = std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) {
    return body.shape.kind == ShapeKind::kMesh;
  });
  for (const Body& body : scene.bodies) {
    const std::string key = key_of(body.shape);
    if (!solids.contains(key)) {
      try {
        solids[key] = make_solid(body.shape, scene.physics, has_mesh);
        const bool feels_patches = scene.wind && body.shape.kind != ShapeKind::kSphere;
        if (feels_patches) solids[key].patches = make_drag_patches(solids[key].mesh);
      } catch (const shape::MeshError& error) {
        problems.push_back({scene.file.string(), "bodies." + body.name + ".shape", error.what(),
                            "a closed, solid shape", ""});
        solids[key] = make_sphere(1);
      } catch (const shape::FillError& error) {
        problems.push_back({scene.file.string(), "bodies." + body.name + ".shape", error.what(),
                            "particles that fit", "choose another physics.particle_size_m"});
        solids[key] = make_sphere(1);
      }
    }
    const Solid& solid = solids[key];
    built.world.bodies.push_back(
        body_definition(body, solid, scene.materials[body.material].density));
    built.meshes.push_back(solid.mesh);
  }
  for (std::size_t t = 0; t < scene.tethers.size(); ++t) {
    const std::string fault = dem::fault_of_tether(scene.tethers[t], built.world.bodies);
    if (fault.empty()) continue;
    problems.push_back({scene.file.string(), "modules.tethers." + std::to_string(t), fault,
                        "a line as long as its ends are apart or longer",
                        "leave length_m out to take the distance at the start"});
  }
  if (!problems.empty()) throw SceneError(std::move(problems));
  if (scene.ground) {
    built.world.planes.push_back(
        {scene.ground->normal, scene.ground->offset, scene.ground->material});
  }
  choose_parameters(scene.physics, built.world);
  return built;
}

}  // namespace verisim::scene
