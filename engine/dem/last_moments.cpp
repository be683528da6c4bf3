// SPDX-License-Identifier: MIT
#include "dem/last_moments.h"

#include "dem/surface_contacts.h"

namespace verisim::dem {
namespace {

constexpr double kLeastInterval = 1e-3;  // s
constexpr double kOnTime = 1e-9;         // s

void add_surface_contacts(const World& world, const std::vector<ContactPair>& pairs,
                          std::vector<ContactRecord>& records) {
  for (const ContactPair& pair : pairs) {
    for (const ContactPoint& point : pair.points) {
      if (point.depth <= 0) continue;
      records.push_back({world.time, pair.a, pair.b, point.place, point.normal, point.depth,
                         point.is_touching ? point.load : 0});
    }
  }
}

void add_particle_contacts(const World& world, std::vector<ContactRecord>& records) {
  const ParticleRows& rows = world.rows;
  const double stiffness = world.parameters.seed.stiffness;
  const auto add = [&](int a, int b, const Eigen::Vector3d& place, const Eigen::Vector3d& normal,
                       double overlap) {
    if (overlap <= 0) return;
    records.push_back({world.time, a, b, place, normal, overlap, stiffness * overlap});
  };
  for (const ParticlePair& pair : world.neighbours.pairs) {
    if (!pair.touches) continue;
    const RowMotion &i = rows.motion[pair.i], &j = rows.motion[pair.j];
    const Eigen::Vector3d apart = i.place.vector() - j.place.vector();
    const double distance = apart.norm(), overlap = i.radius() + j.radius() - distance;
    if (distance <= 0) continue;
    const Eigen::Vector3d normal = apart / distance;
    add(rows.body[pair.i], rows.body[pair.j],
        i.place.vector() - (i.radius() - 0.5 * overlap) * normal, normal, overlap);
  }
  for (const PlanePair& pair : world.neighbours.plane_pairs) {
    const RowMotion& i = rows.motion[pair.row];
    const PlaneDefinition& plane = world.planes[pair.plane];
    const double overlap = i.radius() + plane.offset - plane.normal.dot(i.place.vector());
    add(rows.body[pair.row], world.bodies.count() + static_cast<int>(pair.plane),
        i.place.vector() - (i.radius() - 0.5 * overlap) * plane.normal, plane.normal, overlap);
  }
}

}  // namespace

std::vector<ContactRecord> contacts_of(const World& world) {
  std::vector<ContactRecord> records;
  if (!world.surfaces) {
    add_particle_contacts(world, records);
  } else if (world.steps == 0) {
    add_surface_contacts(world, world.surfaces->look(world), records);
  } else {
    add_surface_contacts(world, world.surfaces->pairs(), records);
  }
  return records;
}

void MomentKeeper::note(const World& world) {
  if (!moments_.empty() && world.time < moments_.back().time + kLeastInterval - kOnTime) return;
  Moment moment{world.time, {}, contacts_of(world)};
  for (int b = 0; b < world.bodies.count(); ++b) moment.poses.push_back(pose_of(world, b));
  moments_.push_back(std::move(moment));
  while (moments_.front().time < world.time - duration_ - kOnTime) moments_.pop_front();
}

LastMoments MomentKeeper::take(const World& world) && {
  LastMoments last;
  last.log.names = world.names;
  for (const Moment& moment : moments_) {
    last.log.times.push_back(moment.time);
    last.log.poses.insert(last.log.poses.end(), moment.poses.begin(), moment.poses.end());
    last.contacts.insert(last.contacts.end(), moment.contacts.begin(), moment.contacts.end());
  }
  return last;
}

}  // namespace verisim::dem
