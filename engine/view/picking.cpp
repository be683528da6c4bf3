// SPDX-License-Identifier: MIT
#include "view/picking.h"

#include <Eigen/Geometry>
#include <cmath>

#include "render/glm_eigen.h"
#include "render/view.h"

namespace verisim::view {
namespace {

// Distance to a triangle seen from its outside, by Moeller and Trumbore 1997.
std::optional<double> meet_triangle(const Ray& ray, const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a;
  const Eigen::Vector3d p = ray.direction.cross(ac);
  const double determinant = ab.dot(p);
  if (!(determinant > 0)) return std::nullopt;  // from behind, or along its plane
  const Eigen::Vector3d from_a = ray.origin - a;
  const double u = from_a.dot(p);
  if (u < 0 || u > determinant) return std::nullopt;
  const Eigen::Vector3d q = from_a.cross(ab);
  const double v = ray.direction.dot(q);
  if (v < 0 || u + v > determinant) return std::nullopt;
  const double distance = ac.dot(q) / determinant;
  if (distance < 0) return std::nullopt;
  return distance;
}

bool meets_sphere(const Ray& ray, const Eigen::Vector3d& center, double radius) {
  const Eigen::Vector3d to_center = center - ray.origin;
  const double along = to_center.dot(ray.direction);
  const double aside_squared = to_center.squaredNorm() - along * along;
  return aside_squared <= radius * radius && along >= -radius;
}

}  // namespace

Ray ray_of_pixel(const render::Camera& camera, int width, int height,
                 const Eigen::Vector2d& pixel) {
  const render::View seen = render::make_view(camera, width, height);
  const glm::vec3 direction =
      seen.pixel_to_ray *
      glm::vec3(static_cast<float>(pixel.x()), static_cast<float>(height - pixel.y()), 1);
  return {camera.position, Eigen::Vector3d(direction.x, direction.y, direction.z).normalized()};
}

std::optional<Eigen::Vector2d> pixel_of_point(const render::Camera& camera, int width, int height,
                                              const Eigen::Vector3d& point) {
  const render::View seen = render::make_view(camera, width, height);
  const glm::vec4 clip = seen.world_to_clip * glm::vec4(render::to_glm(point), 1);
  if (!(clip.w > 0)) return std::nullopt;
  return Eigen::Vector2d((1 + clip.x / clip.w) * width / 2, (1 - clip.y / clip.w) * height / 2);
}

double bounding_radius(const shape::Mesh& mesh) {
  double squared = 0;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    squared = std::max(squared, vertex.squaredNorm());
  }
  return std::sqrt(squared);
}

std::optional<double> meet_mesh(const Ray& ray, const shape::Mesh& mesh) {
  std::optional<double> nearest;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto distance = meet_triangle(ray, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
    if (distance && (!nearest || *distance < *nearest)) nearest = distance;
  }
  return nearest;
}

std::optional<Pick> pick_body(const Ray& ray, std::span<const shape::Mesh> meshes,
                              std::span<const double> radii, std::span<const dem::Pose> poses) {
  std::optional<Pick> nearest;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!meets_sphere(ray, poses[i].position, radii[i])) continue;
    const Eigen::Quaterniond to_body = poses[i].orientation.conjugate();
    const Ray ray_b{to_body * (ray.origin - poses[i].position), to_body * ray.direction};
    const auto distance = meet_mesh(ray_b, meshes[i]);
    if (distance && (!nearest || *distance < nearest->distance)) {
      nearest = {static_cast<int>(i), *distance, ray.origin + *distance * ray.direction};
    }
  }
  return nearest;
}

}  // namespace verisim::view
