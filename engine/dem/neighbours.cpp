// SPDX-License-Identifier: MIT
// Which particles may touch before any body has used up its margin of motion.
#include "dem/neighbours.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "dem/contact_law.h"

namespace verisim::dem {
namespace {

// A longer margin means fewer rebuilds and more pairs that do not touch. In a settled bed the
// least margin (1.5 % of a diameter) holds for hundreds of steps; a fast body gets kSteps steps,
// up to half a diameter, beyond which the lists grow faster than the rebuilds get rarer.
constexpr double kLeastMargin = 0.015;   // of a particle diameter
constexpr double kGreatestMargin = 0.5;  // of a particle diameter
constexpr double kSteps = 20;

constexpr std::uint32_t kIndexBits = 0x7FFFFFFF;  // beside the bit that says whether a pair touches

/// Upper bound of how far any particle of the body is from where it was at the reference (m).
/// Turning by angle t moves a point at distance r by 2 r sin(t/2) <= 2 r |q - q_reference|.
double moved(const Neighbours& neighbours, const Bodies& bodies, int b) {
  const double way = (bodies.position[b] - neighbours.reference_position[b]).norm();
  if (bodies.reach[b] == 0) return way;
  const Eigen::Vector4d& q = bodies.orientation[b].coeffs();
  const Eigen::Vector4d& reference = neighbours.reference_orientation[b].coeffs();
  const double turn = std::min((q - reference).norm(), (q + reference).norm());
  return way + 2 * bodies.reach[b] * turn;
}

void set_reference(Neighbours& neighbours, const Bodies& bodies, double dt) {
  for (int b = 0; b < bodies.count(); ++b) {
    neighbours.reference_position[b] = bodies.position[b];
    neighbours.reference_orientation[b] = bodies.orientation[b];
    const double diameter = 2 * bodies.particle_radius[b];
    const double speed =
        bodies.linear_velocity[b].norm() + bodies.angular_velocity[b].norm() * bodies.reach[b];
    const double margin =
        std::clamp(kSteps * speed * dt, kLeastMargin * diameter, kGreatestMargin * diameter);
    neighbours.margin[b] = bodies.motion[b] == Motion::kFixed ? 0 : margin;
  }
}

bool may_interact(const Bodies& bodies, int a, int b) {
  return a != b && (bodies.motion[a] == Motion::kFree || bodies.motion[b] == Motion::kFree);
}

/// Marks the particles of a that lie in the box around b's particles.
void mark_near(Neighbours& neighbours, const Bodies& bodies, int a, int b) {
  const double gap = bodies.particle_radius[a] + bodies.particle_radius[b] + neighbours.margin[a] +
                     neighbours.margin[b];
  const double reach = bodies.reach[b] + gap;
  const Eigen::Quaterniond q_bw = bodies.orientation[b].conjugate();
  const Eigen::Vector3d room(gap, gap, gap);
  const Eigen::Vector3d low = neighbours.box_b[b].min() - room;
  const Eigen::Vector3d high = neighbours.box_b[b].max() + room;
  for (int k = bodies.first_particle[a]; k < bodies.first_particle[a + 1]; ++k) {
    const Eigen::Vector3d arm = neighbours.place[k] - bodies.position[b];
    if (neighbours.near_another[k] || arm.squaredNorm() > reach * reach) continue;
    const Eigen::Vector3d place_b = q_bw * arm;
    neighbours.near_another[k] =
        (place_b.array() >= low.array()).all() && (place_b.array() <= high.array()).all();
  }
}

void mark_particles_near_other_bodies(Neighbours& neighbours, const Bodies& bodies) {
  const std::size_t num_particles = neighbours.near_another.size();
  if (num_particles <= static_cast<std::size_t>(bodies.count())) {
    std::fill(neighbours.near_another.begin(), neighbours.near_another.end(), std::uint8_t{1});
    return;  // about one particle per body: the particle grid alone is as quick
  }
  std::fill(neighbours.near_another.begin(), neighbours.near_another.end(), std::uint8_t{0});
  SphereGrid& grid = neighbours.grid;
  grid.items.clear();
  for (int b = 0; b < bodies.count(); ++b) {
    if (bodies.num_particles(b) == 0) continue;
    const double radius = bodies.reach[b] + bodies.particle_radius[b] + neighbours.margin[b];
    grid.items.push_back({bodies.position[b], radius, b, {}});
  }
  sort_into_cells(grid);
  for_each_close_pair(grid, [&](std::size_t i, std::size_t j) {
    const int a = grid.items[i].id, b = grid.items[j].id;
    if (!may_interact(bodies, a, b)) return;
    mark_near(neighbours, bodies, a, b);
    mark_near(neighbours, bodies, b, a);
  });
}

bool is_near(const Neighbours& neighbours, const Bodies& bodies, const PlaneDefinition& plane,
             int body, const Eigen::Vector3d& place) {
  return bodies.motion[body] == Motion::kFree &&
         plane.normal.dot(place) - plane.offset <
             bodies.particle_radius[body] + neighbours.margin[body];
}

bool is_near_any(const Neighbours& neighbours, const Bodies& bodies,
                 const std::vector<PlaneDefinition>& planes, int body,
                 const Eigen::Vector3d& place) {
  return std::any_of(planes.begin(), planes.end(), [&](const PlaneDefinition& plane) {
    return is_near(neighbours, bodies, plane, body, place);
  });
}

/// Rows for all particles with something near, in cell order.
void choose_rows(Neighbours& neighbours, ParticleRows& rows, const Bodies& bodies,
                 const Particles& particles, const std::vector<PlaneDefinition>& planes) {
  SphereGrid& grid = neighbours.grid;
  grid.items.clear();
  for (int k = 0; k < particles.count(); ++k) {
    const int b = particles.body[k];
    const Eigen::Vector3d& place = neighbours.place[k];
    if (!neighbours.near_another[k] && !is_near_any(neighbours, bodies, planes, b, place)) continue;
    grid.items.push_back({place, bodies.particle_radius[b] + neighbours.margin[b], k, {}});
  }
  sort_into_cells(grid);

  const std::size_t count = grid.items.size();
  rows.particle.resize(count);
  rows.body.resize(count);
  rows.motion.resize(count);
  rows.load.assign(count, RowLoad{});
  rows.body_rows.resize(count);
  std::fill(neighbours.row_of_particle.begin(), neighbours.row_of_particle.end(), -1);
  for (std::size_t row = 0; row < count; ++row) {
    const int particle = grid.items[row].id;
    rows.particle[row] = particle;
    rows.body[row] = particles.body[particle];
    neighbours.row_of_particle[particle] = static_cast<int>(row);
  }
  int filled = 0;
  for (int b = 0; b < bodies.count(); ++b) {
    rows.body_begin[b] = filled;
    for (int k = bodies.first_particle[b]; k < bodies.first_particle[b + 1]; ++k) {
      const int row = neighbours.row_of_particle[k];
      if (row >= 0) rows.body_rows[filled++] = row;
    }
  }
  rows.body_begin[bodies.count()] = filled;
}

/// 1 / mass of one particle (1/kg); a body that forces do not move is infinitely heavy.
double inverse_particle_mass(const Bodies& bodies, int b) {
  return bodies.motion[b] == Motion::kFree ? bodies.num_particles(b) / bodies.mass[b] : 0;
}

void list_pairs(Neighbours& neighbours, const ParticleRows& rows, const Bodies& bodies) {
  neighbours.pairs.clear();
  neighbours.pair_begin.clear();
  for_each_close_pair(neighbours.grid, [&](std::size_t i, std::size_t j) {
    const int a = rows.body[i], b = rows.body[j];
    if (!may_interact(bodies, a, b)) return;
    while (neighbours.pair_begin.size() <= i) {
      neighbours.pair_begin.push_back(static_cast<std::uint32_t>(neighbours.pairs.size()));
    }
    const double mass =
        effective_mass(inverse_particle_mass(bodies, a), inverse_particle_mass(bodies, b));
    neighbours.pairs.push_back({static_cast<std::uint32_t>(i),
                                static_cast<std::uint32_t>(j) & kIndexBits, 0u, std::sqrt(mass)});
  });
  neighbours.pair_begin.resize(rows.particle.size() + 1,
                               static_cast<std::uint32_t>(neighbours.pairs.size()));
}

void list_plane_pairs(Neighbours& neighbours, const ParticleRows& rows, const Bodies& bodies,
                      const std::vector<PlaneDefinition>& planes) {
  neighbours.plane_pairs.clear();
  neighbours.plane_begin.clear();
  for (std::size_t row = 0; row < rows.particle.size(); ++row) {
    neighbours.plane_begin.push_back(static_cast<std::uint32_t>(neighbours.plane_pairs.size()));
    const int b = rows.body[row];
    for (std::size_t p = 0; p < planes.size(); ++p) {
      const Eigen::Vector3d& place = neighbours.place[rows.particle[row]];
      if (!is_near(neighbours, bodies, planes[p], b, place)) continue;
      neighbours.plane_pairs.push_back({static_cast<std::uint32_t>(row),
                                        static_cast<std::uint32_t>(p) & kIndexBits, 0u,
                                        std::sqrt(1 / inverse_particle_mass(bodies, b))});
    }
  }
  neighbours.plane_begin.push_back(static_cast<std::uint32_t>(neighbours.plane_pairs.size()));
}

void list_border_pairs(Neighbours& neighbours, int num_rows, const ThreadPool& pool) {
  for (std::vector<ParticlePair>& list : neighbours.border_pairs) list.clear();
  const auto owner = [&](std::uint32_t row) {
    int t = 0;
    while (row >= static_cast<std::uint32_t>(pool.range_begin(num_rows, kRowBlock, t + 1))) ++t;
    return t;
  };
  if (pool.num_threads() == 1) return;
  for (const ParticlePair& pair : neighbours.pairs) {
    const int of_i = owner(pair.i), of_j = owner(pair.j);
    if (of_i != of_j) neighbours.border_pairs[of_j].push_back(pair);
  }
}

}  // namespace

Neighbours make_neighbours(const Bodies& bodies, const Particles& particles, int num_threads) {
  const auto num_bodies = static_cast<std::size_t>(bodies.count());
  const auto num_particles = static_cast<std::size_t>(particles.count());
  Neighbours neighbours;
  neighbours.reference_position.resize(num_bodies);
  neighbours.reference_orientation.resize(num_bodies);
  neighbours.margin.resize(num_bodies);
  neighbours.box_b.resize(num_bodies);
  for (int k = 0; k < particles.count(); ++k) {
    neighbours.box_b[particles.body[k]].extend(particles.offset_b[k]);
  }
  neighbours.place.resize(num_particles);
  neighbours.near_another.resize(num_particles);
  neighbours.row_of_particle.resize(num_particles);
  neighbours.border_pairs.resize(static_cast<std::size_t>(num_threads));
  // Room for a dense packing, so that lists do not grow while bodies fall into a pile.
  neighbours.grid.items.reserve(std::max(num_particles, num_bodies));
  neighbours.grid.levels.reserve(kMaxLevels);
  for (std::vector<ParticlePair>& list : neighbours.border_pairs) {
    if (num_threads > 1) list.reserve(8 * num_particles);
  }
  neighbours.pairs.reserve(8 * num_particles);
  neighbours.pair_begin.reserve(num_particles + 1);
  neighbours.plane_pairs.reserve(num_particles);
  neighbours.plane_begin.reserve(num_particles + 1);
  return neighbours;
}

bool margins_used_up(const Neighbours& neighbours, const Bodies& bodies, ThreadPool& pool) {
  constexpr int kBlock = 64;
  std::atomic<bool> used_up = false;
  pool.run_ranges(bodies.count(), kBlock, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) {
      if (bodies.motion[b] == Motion::kFixed) continue;
      if (moved(neighbours, bodies, b) > neighbours.margin[b]) used_up.store(true);
    }
  });
  return used_up;
}

void rebuild(Neighbours& neighbours, ParticleRows& rows, const Bodies& bodies,
             const Particles& particles, const std::vector<PlaneDefinition>& planes, double dt,
             const ThreadPool& pool) {
  set_reference(neighbours, bodies, dt);
  for (int k = 0; k < particles.count(); ++k) {
    const int b = particles.body[k];
    neighbours.place[k] = bodies.position[b] + bodies.orientation[b] * particles.offset_b[k];
  }
  mark_particles_near_other_bodies(neighbours, bodies);
  choose_rows(neighbours, rows, bodies, particles, planes);
  list_pairs(neighbours, rows, bodies);
  list_plane_pairs(neighbours, rows, bodies, planes);
  list_border_pairs(neighbours, rows.count(), pool);
  ++neighbours.num_rebuilds;
}

}  // namespace verisim::dem
