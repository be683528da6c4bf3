// SPDX-License-Identifier: MIT
// The parts of method dem alone: damping, block matrices, contact of boxes, points over time.
#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "dem/block_cholesky.h"
#include "dem/contact_tracking.h"
#include "dem/restitution.h"
#include "dem/rotation.h"
#include "dem/surface_contact.h"
#include "verify_worlds.h"

using namespace verisim::dem;
using namespace verisim::dem::testing;

namespace {

// --- Block matrices.

/// Positive definite: a chain of blocks with some more edges, coupled at random.
VERISIM_OUT_OF_LINE BlockMatrix random_matrix(int size, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  BlockMatrix matrix;
  matrix.diagonal.resize(std::size_t(size));
  for (int i = 1; i < size; ++i) {
    matrix.edges.push_back({i, i - 1});
    if (i % 3 == 0) matrix.edges.push_back({i, i / 3});
  }
  std::set<std::pair<int, int>> seen;
  std::erase_if(matrix.edges, [&](const BlockMatrix::Edge& edge) {
    return !seen.insert({edge.row, edge.column}).second;
  });
  matrix.off.resize(matrix.edges.size());
  for (Matrix6& block : matrix.diagonal) block.setZero();
  for (Matrix6& block : matrix.off) block.setZero();
  for (std::size_t e = 0; e < matrix.edges.size(); ++e) {
    // One spring of random direction: adds J^T J to both bodies, so the whole stays semi-definite.
    Eigen::Matrix<double, 3, 6> a, b;
    for (int n = 0; n < 18; ++n) {
      a.data()[n] = uniform(rng);
      b.data()[n] = uniform(rng);
    }
    matrix.diagonal[std::size_t(matrix.edges[e].row)] += a.transpose() * a;
    matrix.diagonal[std::size_t(matrix.edges[e].column)] += b.transpose() * b;
    matrix.off[e] = a.transpose() * b;
  }
  for (Matrix6& block : matrix.diagonal) block += 0.1 * Matrix6::Identity();
  return matrix;
}

VERISIM_OUT_OF_LINE Eigen::MatrixXd dense(const BlockMatrix& matrix) {
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(6 * matrix.size(), 6 * matrix.size());
  for (int i = 0; i < matrix.size(); ++i) {
    whole.block<6, 6>(6 * i, 6 * i) = matrix.diagonal[std::size_t(i)];
  }
  for (std::size_t e = 0; e < matrix.edges.size(); ++e) {
    const auto [row, column] = matrix.edges[e];
    whole.block<6, 6>(6 * row, 6 * column) = matrix.off[e];
    whole.block<6, 6>(6 * column, 6 * row) = matrix.off[e].transpose();
  }
  return whole;
}

VERISIM_OUT_OF_LINE Eigen::VectorXd joined(const std::vector<Vector6>& parts) {
  Eigen::VectorXd whole(6 * Eigen::Index(parts.size()));
  for (std::size_t i = 0; i < parts.size(); ++i) whole.segment<6>(6 * Eigen::Index(i)) = parts[i];
  return whole;
}

// --- Two boxes.

struct BoxAt {
  CollisionShape shape;
  BodyState state;
};

VERISIM_OUT_OF_LINE BodyState state_of(const CollisionShape& shape, const Vector3d& position,
                                       const Eigen::Quaterniond& q, double reach) {
  BodyState state;
  state.shape = &shape;
  state.position = position;
  state.orientation = q;
  state.reach = reach;
  state.motion = Motion::kFree;
  state.mass = 1;
  state.inverse_mass = 1;
  state.inertia_b = state.inverse_inertia_b = Eigen::Matrix3d::Identity();
  state.size = 0.1;
  refresh(state);
  return state;
}

VERISIM_OUT_OF_LINE Found contact_of(const Vector3d& half_a, const Vector3d& at_a,
                                     const Eigen::Quaterniond& q_a, const Vector3d& half_b,
                                     const Vector3d& at_b, const Eigen::Quaterniond& q_b,
                                     double margin = 0, int last_axis = -1) {
  const CollisionShape a = BoxShape{half_a, nullptr}, b = BoxShape{half_b, nullptr};
  Found found;
  find_points(state_of(a, at_a, q_a, half_a.norm()), state_of(b, at_b, q_b, half_b.norm()), margin,
              last_axis, found);
  return found;
}

const Eigen::Quaterniond kStraight = Eigen::Quaterniond::Identity();

}  // namespace

TEST_CASE("the_damping_factor_solves_hunt_and_crossleys_relation") {
  double worst = 0;
  for (double e = 0.05; e < 1; e += 0.05) {
    const double d = hunt_crossley_factor(e);
    worst = std::max(worst, std::abs(std::log((1 + d) / (1 - e * d)) / (d * (1 + e)) - 1));
  }
  tell("relation of the damping factor", worst);
  CHECK(worst < 1e-9);  // measured 2.3e-10, at 0.95 where both sides are near 0
  CHECK(hunt_crossley_factor(0.9) == doctest::Approx(0.1665).epsilon(1e-3));
  CHECK(hunt_crossley_factor(0.5) == doctest::Approx(1.4328).epsilon(1e-4));
  CHECK(hunt_crossley_factor(0.2) == doctest::Approx(4.919).epsilon(1e-4));
  CHECK(hunt_crossley_factor(1) == 0);
}

TEST_CASE("the_calibrated_factor_makes_the_discrete_impact_exact") {
  double worst = 0;
  for (const int steps : {20, 40, 80}) {
    for (double e = 0.05; e < 1; e += 0.05) {
      worst =
          std::max(worst, std::abs(discrete_restitution(calibrated_factor(e, steps), steps) - e));
    }
  }
  tell("discrete restitution", worst);
  CHECK(worst < 1e-12);  // measured 7e-17
  // Coarse steps have a least restitution: as near as they come.
  CHECK(discrete_restitution(calibrated_factor(0.02, 20), 20) < 0.025);  // measured 0.0247
  CHECK(std::abs(discrete_restitution(calibrated_factor(0.1, 10), 10) - 0.1) < 1e-12);
  CHECK(discrete_restitution(calibrated_factor(0.05, 10), 10) < 0.1);  // measured 0.096
  // Many steps: the continuous law.
  CHECK(calibrated_factor(0.5, 4000) == doctest::Approx(hunt_crossley_factor(0.5)).epsilon(1e-3));
}

TEST_CASE("an_edge_across_a_face_is_held_where_it_crosses_both_rims") {
  // A long box lies with an edge down across the top of a cube, a hair aslant, so that two pairs of
  // edges overlap a little less than the face: held by one of them alone, it would rock on it.
  for (const double slant : {-1e-4, 1e-4}) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(slant, Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(std::numbers::pi / 4, Vector3d::UnitX()));
    const double height = 0.1 + 0.05 * std::numbers::sqrt2 - 1e-4;
    const Found found = contact_of({0.3, 0.05, 0.05}, {0, 0, height}, turn, {0.1, 0.1, 0.1},
                                   Vector3d::Zero(), kStraight);
    REQUIRE(found.points.size() == 2);
    CHECK(found.points[0].place.x() * found.points[1].place.x() == doctest::Approx(-0.01));
    for (const FoundPoint& point : found.points) {
      CHECK(std::abs(point.depth - (1e-4 + slant * point.place.x())) < 1e-7);  // measured 4e-10
      CHECK(point.normal.z() > 1 - 1e-6);
    }
  }
}

TEST_CASE("block_cholesky_and_gradients_solve_as_a_dense_solver_does") {
  double worst_product = 0, worst_direct = 0, worst_gradients = 0;
  for (const int size : {1, 2, 7, 25}) {
    const BlockMatrix matrix = random_matrix(size, 17u + unsigned(size));
    const Eigen::MatrixXd whole = dense(matrix);
    const std::size_t count = static_cast<std::size_t>(size);
    std::vector<Vector6> b(count), x(count), product(count);
    for (std::size_t i = 0; i < b.size(); ++i) {
      for (int n = 0; n < 6; ++n) b[i][n] = std::sin(3.0 * double(i) + n);
    }
    matrix.multiply(b, product);
    const Eigen::VectorXd right = joined(b), exact = whole.llt().solve(right);
    worst_product =
        std::max(worst_product, (joined(product) - whole * right).norm() / (whole * right).norm());
    BlockCholesky cholesky;
    cholesky.analyse(matrix);
    cholesky.factorise(matrix);
    cholesky.solve(b, x);
    worst_direct = std::max(worst_direct, (joined(x) - exact).norm() / exact.norm());
    std::vector<Vector6> in_place = b;
    cholesky.solve(in_place, in_place);
    CHECK(joined(in_place) == joined(x));
    BlockGradients gradients;
    const int steps = gradients.solve(matrix, b, 1e-13, 6 * size + 20, x);
    CHECK(steps <= 6 * size + 20);
    worst_gradients = std::max(worst_gradients, (joined(x) - exact).norm() / exact.norm());
  }
  tell("block matrix: product, Cholesky, gradients", worst_product, worst_direct, worst_gradients);
  CHECK(worst_product < 1e-14);    // measured 2e-16
  CHECK(worst_direct < 1e-12);     // measured 2.6e-15
  CHECK(worst_gradients < 1e-10);  // measured 7e-14
}

TEST_CASE("stacked_boxes_touch_in_the_four_corners_of_their_common_face") {
  const Found found = contact_of({0.05, 0.04, 0.03}, {0.01, 0, 0.0799}, kStraight,
                                 {0.06, 0.06, 0.05}, {0, 0, 0}, kStraight);
  REQUIRE(found.points.size() == 4);
  Vector3d sum = Vector3d::Zero();
  for (const FoundPoint& point : found.points) {
    CHECK(point.depth == doctest::Approx(1e-4).epsilon(1e-9));
    CHECK((point.normal - Vector3d::UnitZ()).norm() < 1e-15);
    CHECK(std::abs(std::abs(point.place.y()) - 0.04) < 1e-12);
    sum += point.place;
  }
  CHECK((sum / 4 - Vector3d(0.01, 0, 0.04995)).norm() < 1e-12);
  std::set<std::uint64_t> names;
  for (const FoundPoint& point : found.points) names.insert(point.id);
  CHECK(names.size() == 4);
}

TEST_CASE("crossing_planks_touch_in_the_corners_of_the_square_they_share") {
  const Found found = contact_of({0.5, 0.05, 0.01}, {0, 0, 0.0195}, kStraight, {0.5, 0.05, 0.01},
                                 {0, 0, 0}, turned(90, Vector3d::UnitZ()));
  REQUIRE(found.points.size() == 4);
  for (const FoundPoint& point : found.points) {
    CHECK(std::abs(std::abs(point.place.x()) - 0.05) < 1e-12);
    CHECK(std::abs(std::abs(point.place.y()) - 0.05) < 1e-12);
    CHECK(point.depth == doctest::Approx(5e-4).epsilon(1e-9));
  }
}

TEST_CASE("the_depth_of_crossing_edges_is_the_distance_of_their_lines") {
  // Two boxes on edge, one along x, the other along y: edges meet at half a diagonal each.
  const double reach = 0.05 * std::sqrt(2.0), depth = 1e-3;
  const Found found =
      contact_of({0.2, 0.05, 0.05}, {0.03, 0, 2 * reach - depth}, turned(45, Vector3d::UnitX()),
                 {0.05, 0.2, 0.05}, {0, -0.02, 0}, turned(45, Vector3d::UnitY()));
  REQUIRE(found.points.size() == 1);
  CHECK(found.points[0].depth == doctest::Approx(depth).epsilon(1e-10));
  CHECK((found.points[0].normal - Vector3d::UnitZ()).norm() < 1e-12);
  CHECK((found.points[0].place - Vector3d(0, 0, reach - 0.5 * depth)).norm() < 1e-12);
  const Found apart =
      contact_of({0.2, 0.05, 0.05}, {0, 0, 2 * reach + depth}, turned(45, Vector3d::UnitX()),
                 {0.05, 0.2, 0.05}, {0, 0, 0}, turned(45, Vector3d::UnitY()));
  CHECK(apart.points.empty());
  CHECK(apart.gap == doctest::Approx(depth).epsilon(1e-10));
}

TEST_CASE("no_point_of_two_boxes_is_deeper_than_they_overlap_and_edges_know_corners_nearby") {
  std::mt19937 rng(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  const Vector3d half(0.05, 0.05, 0.05);
  double deepest = 0;
  int num_touching = 0, num_edges = 0, num_with_corners = 0;
  for (int trial = 0; trial < 100000; ++trial) {
    const Eigen::Quaterniond q =
        Eigen::Quaterniond(normal(rng), normal(rng), normal(rng), normal(rng)).normalized();
    const Vector3d way = Vector3d(normal(rng), normal(rng), normal(rng)).normalized();
    const Found found = contact_of(half, (0.1 + 0.07 * uniform(rng)) * way, q, half,
                                   Vector3d::Zero(), kStraight, 0.01);
    if (found.gap >= -1e-6 || found.gap < -2e-3) continue;
    REQUIRE(!found.points.empty());
    ++num_touching;
    num_edges += found.axis >= 6;
    num_with_corners += found.axis >= 6 && found.points.size() > 1;
    for (const FoundPoint& point : found.points) {
      deepest = std::max(deepest, point.depth / -found.gap);
    }
  }
  tell("boxes: deepest point over overlap", deepest, num_touching, num_edges, num_with_corners);
  CHECK(num_edges > 500);
  CHECK(num_with_corners > 0.3 * num_edges);  // measured 346 of 955
  CHECK(deepest < 1.05);                      // measured 1.039
}

TEST_CASE("edges_that_met_go_on_beside_corners_and_by_the_name_of_theirs") {
  std::mt19937 rng(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-0.3, 0.3);
  const Vector3d half(0.25, 0.25, 0.25);
  int num_faces = 0, num_edges = 0, num_named = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Eigen::Quaterniond q =
        rotation_of(0.02 * Vector3d(normal(rng), normal(rng), normal(rng)));
    Vector3d place(uniform(rng), uniform(rng), 0.5);
    place.z() -= 5e-5 + contact_of(half, place, q, half, Vector3d::Zero(), kStraight, 0.1).gap;
    const auto look = [&](int last_axis) {
      return contact_of(half, place, q, half, Vector3d::Zero(), kStraight, 0, last_axis);
    };
    const Found faces = look(-1);
    if (faces.points.empty() || faces.axis >= 6) continue;
    ++num_faces;
    for (int axis = 6; axis < 15; ++axis) {
      const Found edges = look(axis);
      if (edges.axis != axis) continue;
      ++num_edges;
      const std::uint64_t name = edges.points.back().id;
      num_named += std::any_of(faces.points.begin(), faces.points.end(),
                               [&](const FoundPoint& point) { return point.id == name; });
    }
  }
  tell("boxes: faces, edges that go on, those of a corner's name", num_faces, num_edges, num_named);
  CHECK(num_edges > 5000);  // measured 10050
  CHECK(num_named > 5000);  // measured 10026
}

TEST_CASE("stiffening_keeps_every_force_and_returns_the_energy_that_it_takes") {
  ContactPair pair;
  pair.stiffness = 1000;
  pair.points.resize(3);
  pair.points[0].depth = 2e-3;
  pair.points[1].depth = 1e-3;
  pair.points[1].offset = 4e-4;
  pair.points[1].weight = 0.5;
  pair.points[1].stretch_b = {1e-4, -2e-4, 0};
  pair.points[2].depth = -1e-3;
  const auto force = [&](const ContactPoint& p) {
    return pair.stiffness * p.weight * std::max(0.0, p.depth - p.offset);
  };
  const auto shear = [&](const ContactPoint& p) {
    return Vector3d(0.8 * pair.stiffness * p.weight * p.stretch_b);
  };
  const auto energies = [&] {
    std::pair<double, double> sum{0, 0};
    for (const ContactPoint& p : pair.points) {
      sum.first += 0.5 * force(p) * std::max(0.0, p.depth - p.offset);
      sum.second += 0.5 * shear(p).dot(p.stretch_b);
    }
    return sum;
  };
  const double before[3] = {force(pair.points[0]), force(pair.points[1]), force(pair.points[2])};
  const Vector3d shear_before = shear(pair.points[1]);
  const auto [normal_before, shear_energy_before] = energies();
  const double loss = stiffen(pair, 7000);
  const auto [normal_after, shear_energy_after] = energies();
  CHECK(pair.stiffness == 7000);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(force(pair.points[i]) == doctest::Approx(before[i]).epsilon(1e-13));
  }
  CHECK((shear(pair.points[1]) - shear_before).norm() < 1e-13 * shear_before.norm());
  CHECK(loss == doctest::Approx(normal_before - normal_after).epsilon(1e-12));
  // The tangential spring shortens as it stiffens: its energy falls by the same factor.
  CHECK(shear_energy_after < shear_energy_before);
  // Never softer.
  CHECK(stiffen(pair, 10) == 0);
  CHECK(pair.stiffness == 7000);
}

namespace {

/// A box on a plane, pressed in by 1 mm at one edge and level with it at the other.
struct BoxOnPlane {
  CollisionShape box = BoxShape{{0.05, 0.05, 0.05}, nullptr}, plane = PlaneShape{};
  std::vector<BodyState> bodies;
  LocalPair local;

  BoxOnPlane() {
    bodies.push_back(state_of(box, {0, 0, 0.049}, kStraight, 0.087));
    bodies.push_back(state_of(plane, {0, 0, 0}, kStraight, 0));
    bodies[1].motion = Motion::kFixed;
    local.b = 1;
    local.pair.stiffness = 1000;
    local.pair.is_touching = true;
  }
};

}  // namespace

TEST_CASE("springs_survive_a_corner_that_got_another_name") {
  BoxOnPlane scene;
  look_at(scene.local, scene.bodies, 1e-3);
  REQUIRE(scene.local.pair.points.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    ContactPoint& point = scene.local.pair.points[i];
    point.id += 1000;  // as if other features had met here
    point.stretch_b = {1e-5 * double(i + 1), 0, 0};
    point.offset = 1e-4 * double(i);
    point.load = 1 + double(i);
  }
  const std::vector<ContactPoint> before = scene.local.pair.points;
  scene.bodies[0].position.x() += 1e-5;  // moves a little, too
  look_at(scene.local, scene.bodies, 1e-3);
  REQUIRE(scene.local.pair.points.size() == 4);
  for (const ContactPoint& old : before) {
    int kept = 0;
    for (const ContactPoint& point : scene.local.pair.points) {
      if ((point.place - old.place).norm() > 1e-4) continue;
      ++kept;
      CHECK(point.id != old.id);
      CHECK(point.stretch_b == old.stretch_b);
      CHECK(point.offset == old.offset);
      CHECK(point.load == old.load);
    }
    CHECK(kept == 1);
  }
}

TEST_CASE("points_that_replace_all_others_share_their_load_without_gain_of_energy") {
  BoxOnPlane scene;
  look_at(scene.local, scene.bodies, 1e-3);
  std::vector<ContactPoint>& points = scene.local.pair.points;
  points.resize(1);  // one old point elsewhere carried everything
  points[0].id = 999;
  points[0].place = {0.02, 0.01, 0};
  points[0].depth = 2e-3;
  const double force_before = 1000 * 2e-3, energy_before = 0.5 * 1000 * 2e-3 * 2e-3;
  look_at(scene.local, scene.bodies, 1e-3);
  double force = 0, energy = 0;
  for (const ContactPoint& point : scene.local.pair.points) {
    const double compression = std::max(0.0, point.depth - point.offset);
    force += 1000 * compression;
    energy += 0.5 * 1000 * compression * compression;
  }
  REQUIRE(scene.local.pair.points.size() == 4);
  CHECK(force == doctest::Approx(force_before).epsilon(1e-12));
  CHECK(energy <= energy_before);
}

TEST_CASE("a_corner_that_appears_under_the_surface_is_born_without_force") {
  BoxOnPlane scene;
  look_at(scene.local, scene.bodies, 1e-3);
  scene.local.pair.points.pop_back();  // one corner was not known
  const std::vector<ContactPoint> before = scene.local.pair.points;
  look_at(scene.local, scene.bodies, 1e-3);
  REQUIRE(scene.local.pair.points.size() == 4);
  int born = 0;
  for (const ContactPoint& point : scene.local.pair.points) {
    const bool is_known = std::any_of(before.begin(), before.end(),
                                      [&](const ContactPoint& old) { return old.id == point.id; });
    CHECK(point.offset == (is_known ? 0 : point.depth));
    born += is_known ? 0 : 1;
  }
  CHECK(born == 1);
}
