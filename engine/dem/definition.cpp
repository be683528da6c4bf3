// SPDX-License-Identifier: MIT
// Checks of what a world is made from.
#include "dem/definition.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <sstream>

#include "dem/tether_definition.h"

namespace verisim::dem {
namespace {

class Problems {
 public:
  /// Notes "<where>: <key> is <seen>; <allowed>" unless it holds.
  template <class Seen>
  void require(bool holds, const std::string& where, const std::string& key, const Seen& seen,
               const std::string& allowed) {
    if (holds) return;
    std::ostringstream text;
    text << where << ": " << key << " is " << seen << "; allowed: " << allowed;
    list.push_back(text.str());
  }
  std::vector<std::string> list;
};

bool is_above_zero(double value) { return std::isfinite(value) && value > 0; }
bool is_at_least_zero(double value) { return std::isfinite(value) && value >= 0; }

bool is_finite(const Pose& pose) {
  return pose.position.allFinite() && pose.orientation.coeffs().allFinite() &&
         pose.linear_velocity.allFinite() && pose.angular_velocity.allFinite();
}

bool is_rotation(const Eigen::Quaterniond& q) { return std::abs(q.norm() - 1) < 1e-6; }

/// Symmetric, positive, and no moment above the sum of the other two.
bool is_inertia(const Eigen::Matrix3d& inertia) {
  if (!inertia.allFinite()) return false;
  const double scale = inertia.cwiseAbs().maxCoeff();
  if ((inertia - inertia.transpose()).cwiseAbs().maxCoeff() > 1e-9 * scale) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia, Eigen::EigenvaluesOnly);
  const Eigen::Vector3d moments = solver.eigenvalues();  // rising
  return moments.x() > 0 && moments.z() <= (moments.x() + moments.y()) * (1 + 1e-6);
}

void check_path(Problems& problems, const std::string& where, const PrescribedMotion& path) {
  const bool matches = !path.times.empty() && path.times.size() == path.poses.size();
  problems.require(matches, where, "path", std::to_string(path.times.size()) + " times",
                   "as many times as poses, at least one");
  for (std::size_t k = 0; k < path.times.size(); ++k) {
    const std::string key = "path time " + std::to_string(k);
    const double before = k > 0 ? path.times[k - 1] : -std::numeric_limits<double>::infinity();
    problems.require(std::isfinite(path.times[k]) && path.times[k] > before, where, key,
                     path.times[k], "finite and later than the one before");
  }
  for (std::size_t k = 0; k < path.poses.size(); ++k) {
    const bool holds = is_finite(path.poses[k]) && is_rotation(path.poses[k].orientation);
    problems.require(holds, where, "path pose " + std::to_string(k), "not a pose",
                     "finite numbers and a unit quaternion");
  }
}

void check_body(Problems& problems, const BodyDefinition& body) {
  const std::string where = "body " + body.name;
  problems.require(is_above_zero(body.mass), where, "mass", body.mass, "above 0 kg");
  problems.require(is_inertia(body.inertia_b), where, "inertia", "not one of a solid",
                   "symmetric, positive, no moment above the sum of the other two");
  problems.require(is_finite(body.initial), where, "start pose", "not finite", "finite numbers");
  problems.require(is_rotation(body.initial.orientation), where, "orientation norm",
                   body.initial.orientation.norm(), "1");
  problems.require(body.particle_offsets_b.empty() || is_above_zero(body.particle_radius), where,
                   "particle radius", body.particle_radius, "above 0 m");
  for (const Eigen::Vector3d& offset : body.particle_offsets_b) {
    problems.require(offset.allFinite(), where, "particle offset", "not finite", "finite numbers");
    if (!offset.allFinite()) break;
  }
  if (body.motion == Motion::kPrescribed) check_path(problems, where, body.prescribed);
}

void check_materials(Problems& problems, const WorldDefinition& definition) {
  const MaterialPairs& pairs = definition.material_pairs;
  const std::size_t size =
      static_cast<std::size_t>(pairs.count) * static_cast<std::size_t>(pairs.count);
  const bool is_table = pairs.restitution.size() == size && pairs.friction.size() == size;
  problems.require(is_table, "world", "material pairs", pairs.restitution.size(),
                   "restitution and friction of every pair of materials");
  problems.require(pairs.rolling_friction.empty() || pairs.rolling_friction.size() == size, "world",
                   "material pairs", pairs.rolling_friction.size(),
                   "rolling friction of every pair of materials, or of none");
  const auto check = [&](const std::string& where, int material) {
    problems.require(material >= 0 && material < pairs.count, where, "material", material,
                     "0 to " + std::to_string(pairs.count - 1));
  };
  for (const BodyDefinition& body : definition.bodies) check("body " + body.name, body.material);
  for (const PlaneDefinition& plane : definition.planes) {
    check("plane " + plane.name, plane.material);
  }
}

/// Hertz's law holds for spheres of materials with a modulus.
void check_hertz(Problems& problems, const WorldDefinition& definition) {
  for (const BodyDefinition& body : definition.bodies) {
    problems.require(std::holds_alternative<SphereShape>(body.shape), "body " + body.name, "shape",
                     "no sphere", "spheres and planes with contact law hertz_mindlin");
  }
  const MaterialPairs& pairs = definition.material_pairs;
  const auto count = static_cast<std::size_t>(pairs.count);
  const bool has_all = pairs.young_modulus.size() == count && pairs.poisson_ratio.size() == count;
  problems.require(has_all, "world", "elastic materials", pairs.young_modulus.size(),
                   "Young's modulus and Poisson's ratio of every material");
  for (std::size_t m = 0; has_all && m < count; ++m) {
    const std::string where = "material " + std::to_string(m);
    problems.require(is_above_zero(pairs.young_modulus[m]), where, "Young's modulus",
                     pairs.young_modulus[m], "above 0 Pa");
    const double poisson = pairs.poisson_ratio[m];
    problems.require(poisson > -1 && poisson <= 0.5, where, "Poisson's ratio", poisson,
                     "above -1, at most 0.5");
  }
}

/// What method xpbd does not model.
void check_xpbd(Problems& problems, const WorldDefinition& definition) {
  problems.require(definition.xpbd.substeps >= 1, "world", "number of substeps",
                   definition.xpbd.substeps, "1 or more");
  problems.require(definition.tethers.empty(), "world", "method", "xpbd",
                   "dem where there are tethers");
  for (const double rolling : definition.material_pairs.rolling_friction) {
    problems.require(rolling == 0, "world", "rolling friction", rolling, "0 with method xpbd");
    if (rolling != 0) break;
  }
}

void check_wind(Problems& problems, const Wind& wind) {
  const std::string where = "wind";
  problems.require(wind.velocity.allFinite(), where, "velocity", "not finite", "finite numbers");
  problems.require(is_above_zero(wind.density), where, "density", wind.density, "above 0 kg/m^3");
  problems.require(is_at_least_zero(wind.viscosity), where, "viscosity", wind.viscosity,
                   "0 Pa s or more");
  problems.require(is_at_least_zero(wind.drag_coefficient), where, "drag coefficient",
                   wind.drag_coefficient, "0 or more");
}

}  // namespace

std::vector<std::string> problems_of(const WorldDefinition& definition) {
  Problems problems;
  const std::string world = "world";
  problems.require(definition.gravity.allFinite(), world, "gravity", "not finite",
                   "finite numbers");
  problems.require(is_above_zero(definition.dt), world, "dt", definition.dt, "above 0 s");
  problems.require(definition.num_threads >= 1, world, "number of threads", definition.num_threads,
                   "1 or more");
  const SeedSettings& seed = definition.seed;
  problems.require(is_at_least_zero(seed.stiffness), world, "stiffness", seed.stiffness,
                   "0 N/m or more");
  problems.require(is_at_least_zero(seed.damping_ratio), world, "damping ratio", seed.damping_ratio,
                   "0 or more");
  problems.require(is_at_least_zero(seed.tangential_damping_ratio), world,
                   "tangential damping ratio", seed.tangential_damping_ratio, "0 or more");
  for (const PlaneDefinition& plane : definition.planes) {
    const bool is_unit = std::abs(plane.normal.norm() - 1) < 1e-6;
    problems.require(is_unit && std::isfinite(plane.offset), "plane " + plane.name, "normal norm",
                     plane.normal.norm(), "1, with a finite offset");
  }
  for (const BodyDefinition& body : definition.bodies) check_body(problems, body);
  if (has_surfaces(definition.method)) check_materials(problems, definition);
  if (definition.method == Method::kDem && definition.dem.contact_law == NormalLaw::kHertzMindlin) {
    check_hertz(problems, definition);
  }
  const bool has_modules = definition.wind.has_value() || !definition.tethers.empty();
  problems.require(has_surfaces(definition.method) || !has_modules, world, "method", "seed",
                   "dem or xpbd where there is wind, dem where there are tethers");
  if (definition.method == Method::kXpbd) check_xpbd(problems, definition);
  if (definition.wind) check_wind(problems, *definition.wind);
  for (std::size_t t = 0; t < definition.tethers.size(); ++t) {
    const std::string fault = fault_of_tether(definition.tethers[t], definition.bodies);
    if (!fault.empty()) problems.list.push_back("tether " + std::to_string(t) + ": " + fault);
  }
  return problems.list;
}

}  // namespace verisim::dem
