// SPDX-License-Identifier: MIT
// Settles r = Q r0 Q*: right as algebra; in glm `q * v` is already the whole product.
#include <doctest/doctest.h>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include <Eigen/Geometry>
#include <cmath>

namespace {

constexpr double kAngle = 0.5;  // rad, about z; r0 along x

double angle_of(double x, double y) { return std::atan2(y, x); }

const Eigen::Quaterniond kTurn(Eigen::AngleAxisd(kAngle, Eigen::Vector3d::UnitZ()));
const Eigen::Quaterniond kVector(0, 1, 0, 0);  // (0, r0)

}  // namespace

TEST_CASE("the_product_Q_r0_Q_conjugate_turns_by_the_angle") {
  const Eigen::Quaterniond r = kTurn * kVector * kTurn.conjugate();
  CHECK(angle_of(r.x(), r.y()) == doctest::Approx(kAngle).epsilon(1e-14));
  CHECK(std::abs(r.w()) < 1e-15);
  const Eigen::Vector3d by_eigen = kTurn * Eigen::Vector3d::UnitX();  // Eigen's q * v: the same
  CHECK(angle_of(by_eigen.x(), by_eigen.y()) == doctest::Approx(kAngle).epsilon(1e-14));
}

TEST_CASE("in_glm_q_times_v_is_the_whole_product_and_a_conjugate_behind_it_doubles_the_angle") {
  const glm::dquat q = glm::angleAxis(kAngle, glm::dvec3(0, 0, 1));
  const glm::dvec3 r0(1, 0, 0);
  const glm::dvec3 once = q * r0;
  CHECK(angle_of(once.x, once.y) == doctest::Approx(kAngle).epsilon(1e-14));
  // Reads like the equation, but `(q * r0) * conjugate(q)` is q (q r0): v * p is inverse(p) * v.
  const glm::dvec3 twice = q * r0 * glm::conjugate(q);
  CHECK(angle_of(twice.x, twice.y) == doctest::Approx(2 * kAngle).epsilon(1e-14));
}

TEST_CASE("the_half_product_Q_r0_turns_by_half_the_angle_and_is_no_vector_in_general") {
  const Eigen::Quaterniond half = kTurn * kVector;
  CHECK(angle_of(half.x(), half.y()) == doctest::Approx(kAngle / 2).epsilon(1e-14));
  const Eigen::Vector3d diagonal = Eigen::Vector3d::Ones().normalized();
  const Eigen::Quaterniond oblique =
      Eigen::Quaterniond(Eigen::AngleAxisd(kAngle, diagonal)) * kVector;
  CHECK(oblique.w() == doctest::Approx(-0.143).epsilon(0.005));
  CHECK(oblique.vec().norm() == doctest::Approx(0.990).epsilon(0.001));
}
