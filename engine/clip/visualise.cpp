// SPDX-License-Identifier: MIT
#include "clip/visualise.h"

#include <numbers>

#include "shape/extents.h"

namespace verisim::clip {
namespace {

render::Pattern pattern_of(const scene::ShapeSpec& spec, const shape::Mesh& mesh) {
  switch (spec.kind) {
    case scene::ShapeKind::kBox:
      return render::box_pattern(spec.box);
    case scene::ShapeKind::kSphere:
      return render::sphere_pattern(spec.radius);
    case scene::ShapeKind::kMesh:
      break;
  }
  const Eigen::AlignedBox3d box = shape::bounding_box(mesh);
  return render::mesh_pattern(box.min(), box.max());
}

void set_surface(const scene::ShapeSpec& spec, const shape::Mesh& mesh, render::VisualBody& body) {
  if (spec.kind == scene::ShapeKind::kSphere) {
    body.spheres = {{Eigen::Vector3d::Zero(), spec.radius}};
  } else {
    body.mesh = {mesh.vertices, mesh.triangles};
  }
}

void set_particles(const dem::BodyDefinition& definition, render::VisualBody& body) {
  for (const Eigen::Vector3d& offset : definition.particle_offsets_b) {
    body.spheres.push_back({offset, definition.particle_radius});
  }
}

// Looks at the bodies' start from the front right, somewhat above, with room around them.
render::Camera camera_for(const scene::BuiltScene& built) {
  constexpr double kRoom = 1.3;
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < built.meshes.size(); ++i) {
    const dem::Pose& pose = built.world.bodies[i].initial;
    for (const Eigen::Vector3d& vertex : built.meshes[i].vertices) {
      box.extend(pose.position + pose.orientation * vertex);
    }
  }
  render::Camera camera;
  camera.look_at = box.center();
  const double half_angle = camera.fov_deg / 2 * std::numbers::pi / 180;
  const double distance = kRoom * box.diagonal().norm() / 2 / std::sin(half_angle);
  camera.position = box.center() + distance * Eigen::Vector3d(0.55, -0.75, 0.35).normalized();
  return camera;
}

}  // namespace

render::VisualScene visualise(const scene::Scene& scene, const scene::BuiltScene& built,
                              Show show) {
  render::VisualScene look;
  if (scene.camera) {
    look.camera = {scene.camera->position, scene.camera->look_at, scene.camera->fov_deg};
  } else {
    look.camera = camera_for(built);
  }
  look.sun = render::sun_behind_camera(look.camera);
  look.ground.present = scene.ground.has_value();
  if (scene.ground) {
    look.ground.normal = scene.ground->normal;
    look.ground.offset = scene.ground->offset;
  }
  look.ground.checker_size = scene.look.ground_checker;
  std::size_t num_coloured = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const scene::Body& source = scene.bodies[i];
    render::VisualBody body;
    body.name = source.name;
    body.colour = source.motion == dem::Motion::kFixed ? render::fixed_body_colour()
                                                       : render::palette_colour(num_coloured++);
    body.pattern = pattern_of(source.shape, built.meshes[i]);
    if (scene.look.skin == "plain") body.pattern.kind = render::PatternKind::kPlain;
    if (show == Show::kParticles && built.world.method == dem::Method::kSeed) {
      set_particles(built.world.bodies[i], body);
    } else {
      set_surface(source.shape, built.meshes[i], body);
    }
    look.bodies.push_back(std::move(body));
  }
  return look;
}

}  // namespace verisim::clip
