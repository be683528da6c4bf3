// SPDX-License-Identifier: MIT
// Watches a run of method `dem`: who is too deep in whom, who went through.
#include <algorithm>
#include <optional>

#include "dem/failures.h"
#include "dem/message_text.h"
#include "dem/surface_contacts.h"

namespace verisim::dem {
namespace {

constexpr double kDeep = 0.05;  // of the smaller body's size

/// Is a point of the body frame inside of the solid?
bool is_inside(const CollisionShape& shape, const Eigen::Vector3d& p_b) {
  if (const auto* sphere = std::get_if<SphereShape>(&shape)) return p_b.norm() < sphere->radius;
  if (const auto* box = std::get_if<BoxShape>(&shape)) {
    return (p_b.cwiseAbs().array() < box->half.array()).all();
  }
  if (const auto* mesh = std::get_if<MeshShape>(&shape)) {
    return distance_at(mesh->surface->field, p_b).value < 0;
  }
  return false;
}

bool is_plane(const World& world, int body) { return body >= world.bodies.count(); }

std::string name_of(const World& world, int body) {
  return is_plane(world, body) ? world.planes[body - world.bodies.count()].name : world.names[body];
}

/// Size (m) of the smaller of two bodies; a plane has none.
double smaller_size(const World& world, const ContactPair& pair) {
  const Bodies& bodies = world.bodies;
  if (is_plane(world, pair.b)) return bodies.size[pair.a];
  if (is_plane(world, pair.a)) return bodies.size[pair.b];
  return std::min(bodies.size[pair.a], bodies.size[pair.b]);
}

double depth_of(const ContactPair& pair) {
  double depth = 0;
  for (const ContactPoint& point : pair.points) depth = std::max(depth, point.depth);
  return depth;
}

/// The body of a pair that can be blamed: a free one, the first in the scene.
int culprit_of(const World& world, const ContactPair& pair) {
  const auto is_free = [&](int body) {
    return !is_plane(world, body) && world.bodies.motion[body] == Motion::kFree;
  };
  const int first = std::min(pair.a, pair.b), second = std::max(pair.a, pair.b);
  return is_free(first) ? first : second;
}

int other_of(const ContactPair& pair, int body) { return pair.a == body ? pair.b : pair.a; }

/// The body of a pair whose centre lies in the other one, if there is such a body.
std::optional<int> body_inside(const World& world, const ContactPair& pair,
                               const std::vector<std::uint8_t>& holds_own_centre) {
  if (is_plane(world, pair.a) || is_plane(world, pair.b)) return std::nullopt;
  const Bodies& bodies = world.bodies;
  const auto is_in = [&](int inner, int outer) {
    // The centre of a ring or a hook is not part of it and may lie in anything.
    if (!holds_own_centre[static_cast<std::size_t>(inner)]) return false;
    const Eigen::Vector3d apart = bodies.position[inner] - bodies.position[outer];
    return is_inside(world.surfaces->shape(outer), bodies.orientation[outer].conjugate() * apart);
  };
  if (is_in(pair.a, pair.b)) return pair.a;
  if (is_in(pair.b, pair.a)) return pair.b;
  return std::nullopt;
}

}  // namespace

void FailureWatch::start_surfaces(const World& world) {
  for (int b = 0; b < world.bodies.count(); ++b) {
    holds_own_centre_.push_back(is_inside(world.surfaces->shape(b), Eigen::Vector3d::Zero()) ? 1
                                                                                             : 0);
  }
  const std::vector<ContactPair> pairs = world.surfaces->look(world);
  const double allowed = world.surfaces->chosen().max_penetration;
  const ContactPair* deepest = nullptr;
  int num_others = -1;
  for (const ContactPair& pair : pairs) {
    if (body_inside(world, pair, holds_own_centre_)) {
      inside_at_start_.at(static_cast<std::uint32_t>(pair.a), static_cast<std::uint32_t>(pair.b)) =
          1;
    }
    if (depth_of(pair) <= allowed) continue;
    ++num_others;
    if (deepest == nullptr || depth_of(pair) > depth_of(*deepest)) deepest = &pair;
  }
  // Later on, what is pressed together may be deeper than allowed; a start has no excuse.
  if (deepest == nullptr || world.steps > 0) return;
  const int a = culprit_of(world, *deepest);
  fail(world, "penetration", a, world.time,
       text(world.names[a], " and ", name_of(world, other_of(*deepest, a)), " overlap by ",
            depth_of(*deepest), " m from the start, ", allowed, " m are allowed",
            num_others > 0 ? text("; so do ", num_others, " more pairs") : ""));
}

void FailureWatch::note_deep_surfaces(const World& world, const StepReport& report) {
  const ContactPair* likely = nullptr;  // of all pairs, the one that allows most
  for (const ContactPair& pair : world.surfaces->pairs()) {
    const double limit = kDeep * smaller_size(world, pair);
    if (likely == nullptr || limit > kDeep * smaller_size(world, *likely)) likely = &pair;
    const double depth = depth_of(pair);
    if (depth <= limit) continue;
    const int a = culprit_of(world, pair), b = other_of(pair, a);
    fail(world, "penetration", a, world.time,
         text(world.names[a], " and ", name_of(world, b), " overlap by ", depth,
              " m, more than 5 % of the smaller one"));
    if (!is_plane(world, b)) remember_deep(world.bodies, std::min(a, b), std::max(a, b));
  }
  // Pairs are seen at the end of a step; an impact within it may have been deeper.
  if (likely == nullptr || report.max_overlap <= kDeep * smaller_size(world, *likely)) return;
  const bool is_alone = world.surfaces->pairs().size() == 1;
  fail(world, "penetration", is_alone ? culprit_of(world, *likely) : -1, world.time,
       text("two bodies overlap by ", report.max_overlap, " m, more than 5 % of the smaller one"));
}

void FailureWatch::check_centres(const World& world) {
  if (has_failed("pass_through")) return;
  for (const ContactPair& pair : world.surfaces->pairs()) {
    const std::optional<int> inner = body_inside(world, pair, holds_own_centre_);
    if (!inner) continue;
    if (inside_at_start_.find(static_cast<std::uint32_t>(pair.a),
                              static_cast<std::uint32_t>(pair.b)) != nullptr) {
      continue;
    }
    fail(world, "pass_through", culprit_of(world, pair), world.time,
         text("the centre of ", world.names[*inner], " is inside of ",
              world.names[other_of(pair, *inner)]));
    return;
  }
}

}  // namespace verisim::dem
