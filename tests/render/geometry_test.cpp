// SPDX-License-Identifier: MIT
// The renderer's geometry without a graphics context: normals, spheres, tiles, the sun's box.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "render/light.h"
#include "render/tile_mask.h"
#include "render/vertex_mesh.h"
#include "small_scene.h"

namespace verisim::render {
namespace {

/// Area that triangles cover, with overlaps counted as often as they occur.
float covered_area(const std::vector<glm::vec2>& corners) {
  float area = 0;
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const glm::vec2 u = corners[i + 1] - corners[i], v = corners[i + 2] - corners[i];
    area += (u.x * v.y - u.y * v.x) / 2;
  }
  return area;
}

}  // namespace

TEST_CASE("a_box_keeps_sharp_edges_and_a_sphere_is_smooth") {
  const VertexMesh box = with_normals(box_mesh({1, 2, 3}), {0, 0, 0});
  CHECK(box.vertices.size() == 24);  // each corner three times, once per face
  CHECK(box.indices.size() == 36);

  const VertexMesh unit = geodesic_sphere(4);
  TriangleMesh sphere;
  for (const Vertex& vertex : unit.vertices)
    sphere.positions.push_back(vertex.normal.cast<double>());
  for (std::size_t i = 0; i < unit.indices.size(); i += 3) {
    sphere.triangles.push_back({static_cast<int>(unit.indices[i]),
                                static_cast<int>(unit.indices[i + 1]),
                                static_cast<int>(unit.indices[i + 2])});
  }
  const VertexMesh smooth = with_normals(sphere, {0, 0, 0});
  CHECK(smooth.vertices.size() == sphere.positions.size());
  for (const Vertex& vertex : smooth.vertices) {
    CHECK(vertex.normal.dot(vertex.position.normalized()) > 0.999F);  // measured 0.99995
  }
}

TEST_CASE("geodesic_spheres_are_closed_and_face_outwards") {
  for (const int frequency : {1, 2, 5}) {
    const VertexMesh sphere = geodesic_sphere(frequency);
    CHECK(sphere.indices.size() == 60U * frequency * frequency);
    CHECK(sphere.vertices.size() == 10U * frequency * frequency + 2);  // Euler
    for (std::size_t i = 0; i < sphere.indices.size(); i += 3) {
      const auto point = [&](std::size_t k) {
        return sphere.vertices[sphere.indices[i + k]].position;
      };
      const Eigen::Vector3f normal = (point(1) - point(0)).cross(point(2) - point(0));
      CHECK(normal.dot(point(0) + point(1) + point(2)) > 0);
    }
  }
}

TEST_CASE("overlapping_outlines_are_covered_once") {
  TileMask mask(320, 180);
  const std::array<glm::vec2, 4> square{{{20, 20}, {60, 20}, {60, 60}, {20, 60}}};
  mask.mark(square);
  const float once = covered_area(mask.triangles());
  CHECK(once == 3 * 3 * 256);  // tiles 1..3 each way
  mask.mark(square);
  CHECK(covered_area(mask.triangles()) == once);
  const std::array<glm::vec2, 3> outside{{{400, 20}, {500, 20}, {450, 90}}};
  mask.mark(outside);
  CHECK(covered_area(mask.triangles()) == once);
  mask.clear();
  CHECK(mask.triangles().empty());
}

TEST_CASE("tiles_hold_every_point_of_their_outline") {
  TileMask mask(640, 360);
  const std::array<glm::vec2, 3> triangle{{{-50, 30}, {700, 100}, {300, 400}}};
  mask.mark(triangle);
  const std::vector<glm::vec2> corners = mask.triangles();
  const auto is_covered = [&](const glm::vec2& p) {
    for (std::size_t i = 0; i < corners.size(); i += 6) {
      if (p.x >= corners[i].x && p.x <= corners[i + 2].x && p.y >= corners[i].y &&
          p.y <= corners[i + 2].y) {
        return true;
      }
    }
    return false;
  };
  for (int i = 0; i <= 40; ++i) {
    for (int j = 0; i + j <= 40; ++j) {
      const glm::vec2 p = triangle[0] + (triangle[1] - triangle[0]) * (static_cast<float>(i) / 40) +
                          (triangle[2] - triangle[0]) * (static_cast<float>(j) / 40);
      if (p.x >= 0 && p.x < 640 && p.y >= 0 && p.y < 360) CHECK(is_covered(p));
    }
  }
}

TEST_CASE("the_suns_box_holds_bodies_and_their_shadows") {
  const Still still = empty_still();
  const View view = make_view(still.scene.camera, 320, 180);
  const std::vector<BoundingSphere> spheres{{{0, 0, 0.1F}, 0.17F}, {{0.2F, 0.1F, 0.4F}, 0.05F}};
  const Light light = fit_light(still.scene, view, spheres);
  const Eigen::Vector3d& sun = still.scene.sun.direction;
  for (const BoundingSphere& sphere : spheres) {
    const float reach = sphere.center.z / static_cast<float>(sun.z());
    const glm::vec3 to_sun(sun.x(), sun.y(), sun.z());
    for (const glm::vec3& point : {sphere.center, sphere.center - to_sun * reach}) {
      const glm::vec3 at = light.world_to_sun * glm::vec4(point, 1);
      CHECK(std::min({at.x, at.y, at.z}) > 0);
      CHECK(std::max({at.x, at.y, at.z}) < 1);
    }
  }
}

TEST_CASE("shadow_texels_stay_put_while_bodies_move") {
  const Still still = empty_still();
  const View view = make_view(still.scene.camera, 320, 180);
  const auto texel_of = [&](float x) {
    const std::vector<BoundingSphere> spheres{{{x, 0, 0.1F}, 0.1F}};
    const Light light = fit_light(still.scene, view, spheres);
    const glm::vec3 at = light.world_to_sun * glm::vec4(0, 0, 0, 1);
    return glm::vec3(at.x * static_cast<float>(light.width),
                     at.y * static_cast<float>(light.height), light.texel);
  };
  const glm::vec3 before = texel_of(0), after = texel_of(0.0137F);
  REQUIRE(before.z == after.z);
  for (int axis = 0; axis < 2; ++axis) {
    const float moved = after[axis] - before[axis];
    CHECK(std::abs(moved - std::round(moved)) < 1e-2F);  // measured 1e-6 texels
  }
}

}  // namespace verisim::render
