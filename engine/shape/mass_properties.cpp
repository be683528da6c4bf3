// SPDX-License-Identifier: MIT
// Integrates volume, centre of mass and inertia over closed meshes, boxes and balls.
#include "shape/mass_properties.h"

#include <Eigen/Geometry>
#include <numbers>

namespace verisim::shape {
namespace {

Eigen::Vector3d mean_vertex(const Mesh& mesh) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& vertex : mesh.vertices) sum += vertex;
  return sum / static_cast<double>(mesh.vertices.size());
}

}  // namespace

MassProperties mesh_mass_properties(const Mesh& mesh) {
  const Eigen::Vector3d origin = mean_vertex(mesh);
  double volume6 = 0;                                   // 6 x volume
  Eigen::Vector3d first24 = Eigen::Vector3d::Zero();    // 24 x integral of r
  Eigen::Matrix3d second120 = Eigen::Matrix3d::Zero();  // 120 x integral of r r^T
  for (const auto& triangle : mesh.triangles) {
    // Tetrahedron (0, a, b, c) with s = a + b + c and det = a.(b x c):
    //   integral of 1 = det/6, of r = det/24 s, of r r^T = det/120 (s s^T + a a^T + b b^T + c c^T).
    const Eigen::Vector3d a = mesh.vertices[triangle[0]] - origin;
    const Eigen::Vector3d b = mesh.vertices[triangle[1]] - origin;
    const Eigen::Vector3d c = mesh.vertices[triangle[2]] - origin;
    const Eigen::Vector3d s = a + b + c;
    const double det = a.dot(b.cross(c));
    volume6 += det;
    first24 += det * s;
    second120 +=
        det * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  const double volume = volume6 / 6;
  const Eigen::Vector3d offset = first24 / (24 * volume);
  const Eigen::Matrix3d second = second120 / 120 - volume * offset * offset.transpose();
  return {volume, origin + offset, second.trace() * Eigen::Matrix3d::Identity() - second};
}

double signed_volume(const Mesh& mesh) {
  const Eigen::Vector3d origin = mean_vertex(mesh);
  double volume6 = 0;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[triangle[0]] - origin;
    const Eigen::Vector3d b = mesh.vertices[triangle[1]] - origin;
    const Eigen::Vector3d c = mesh.vertices[triangle[2]] - origin;
    volume6 += a.dot(b.cross(c));
  }
  return volume6 / 6;
}

MassProperties box_mass_properties(const Eigen::Vector3d& edges) {
  const double volume = edges.prod();
  const Eigen::Vector3d squares = edges.cwiseAbs2();
  const Eigen::Vector3d diagonal =
      volume / 12 * (Eigen::Vector3d::Constant(squares.sum()) - squares);
  return {volume, Eigen::Vector3d::Zero(), diagonal.asDiagonal()};
}

MassProperties sphere_mass_properties(double radius) {
  const double volume = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  return {volume, Eigen::Vector3d::Zero(),
          0.4 * volume * radius * radius * Eigen::Matrix3d::Identity()};
}

}  // namespace verisim::shape
