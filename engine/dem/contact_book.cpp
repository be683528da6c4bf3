// SPDX-License-Identifier: MIT
// Keeps count of which bodies touch, and reports each begin and end.
#include "dem/contact_book.h"

#include <algorithm>

namespace verisim::dem {
namespace {

/// Two bodies in rising order; a plane p is written as body num_bodies + p.
struct BodyPair {
  int a, b;
};

BodyPair ordered(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

ContactEvent make_event(ContactChange change, double time, BodyPair pair, int num_bodies,
                        double normal_velocity) {
  ContactEvent event;
  event.change = change;
  event.time = time;
  event.body_a = pair.a;
  event.body_b = pair.b < num_bodies ? pair.b : -1;
  event.plane = pair.b < num_bodies ? -1 : pair.b - num_bodies;
  event.speed = change == ContactChange::kBegin ? -normal_velocity : normal_velocity;
  return event;
}

void begin_contact(ContactBook& book, BodyPair pair, double normal_velocity, int num_bodies,
                   double time) {
  int& num_contacts =
      book.touching.at(static_cast<std::uint32_t>(pair.a), static_cast<std::uint32_t>(pair.b));
  if (num_contacts++ == 0) {
    book.events.push_back(
        make_event(ContactChange::kBegin, time, pair, num_bodies, normal_velocity));
  }
}

void end_contact(ContactBook& book, BodyPair pair, double normal_velocity, int num_bodies,
                 double time) {
  const auto a = static_cast<std::uint32_t>(pair.a), b = static_cast<std::uint32_t>(pair.b);
  int* num_contacts = book.touching.find(a, b);
  if (num_contacts == nullptr || --*num_contacts > 0) return;
  book.touching.erase(a, b);
  book.events.push_back(make_event(ContactChange::kEnd, time, pair, num_bodies, normal_velocity));
}

template <class Visit>
void for_each_transition(const std::vector<std::vector<Transition>>& lists, bool begins,
                         const Visit& visit) {
  for (const std::vector<Transition>& list : lists) {
    for (const Transition& transition : list) {
      if (transition.begins == begins) visit(transition);
    }
  }
}

/// Velocity (m/s) of a particle centre, for contacts that ended unseen between two lists.
Eigen::Vector3d velocity_of(const Bodies& bodies, const Particles& particles, int particle) {
  const int b = particles.body[particle];
  return bodies.linear_velocity[b] +
         bodies.angular_velocity[b].cross(bodies.orientation[b] * particles.offset_b[particle]);
}

}  // namespace

ContactBook make_contact_book(int num_particles, int num_threads) {
  const auto count = static_cast<std::size_t>(num_particles);
  const auto threads = static_cast<std::size_t>(num_threads);
  ContactBook book;
  // A dense packing has about three contacts per particle.
  book.touching.reserve(3 * count);
  book.carried_pairs.reserve(3 * count);
  book.carried_planes.reserve(count);
  book.pair_transitions.resize(threads);
  book.plane_transitions.resize(threads);
  for (auto* lists : {&book.pair_transitions, &book.plane_transitions}) {
    for (std::vector<Transition>& list : *lists) list.reserve(3 * count);
  }
  book.events.reserve(64 + count);
  return book;
}

void carry_contacts(ContactBook& book, const Neighbours& neighbours, const ParticleRows& rows) {
  book.carried_pairs.clear();
  book.carried_planes.clear();
  for (const ParticlePair& pair : neighbours.pairs) {
    if (!pair.touches) continue;
    const auto [low, high] = std::minmax(rows.particle[pair.i], rows.particle[pair.j]);
    book.carried_pairs.at(static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(high)) = 1;
  }
  for (const PlanePair& pair : neighbours.plane_pairs) {
    if (!pair.touches) continue;
    book.carried_planes.at(static_cast<std::uint32_t>(rows.particle[pair.row]), pair.plane) = 1;
  }
}

void restore_contacts(ContactBook& book, Neighbours& neighbours, const ParticleRows& rows,
                      const Bodies& bodies, const Particles& particles,
                      const std::vector<PlaneDefinition>& planes, double time) {
  if (book.carried_pairs.size() > 0) {
    for (ParticlePair& pair : neighbours.pairs) {
      const auto [low, high] = std::minmax(rows.particle[pair.i], rows.particle[pair.j]);
      pair.touches = book.carried_pairs.erase(static_cast<std::uint32_t>(low),
                                              static_cast<std::uint32_t>(high));
    }
  }
  for (PlanePair& pair : neighbours.plane_pairs) {
    pair.touches =
        book.carried_planes.erase(static_cast<std::uint32_t>(rows.particle[pair.row]), pair.plane);
  }
  book.carried_pairs.for_each([&](std::uint32_t i, std::uint32_t j, std::uint8_t) {
    const int first = static_cast<int>(i), second = static_cast<int>(j);
    const Eigen::Vector3d apart = neighbours.place[first] - neighbours.place[second];
    const Eigen::Vector3d velocity =
        velocity_of(bodies, particles, first) - velocity_of(bodies, particles, second);
    end_contact(book, ordered(particles.body[first], particles.body[second]),
                velocity.dot(apart.normalized()), bodies.count(), time);
  });
  book.carried_planes.for_each([&](std::uint32_t i, std::uint32_t plane, std::uint8_t) {
    const int particle = static_cast<int>(i);
    end_contact(book, {particles.body[particle], bodies.count() + static_cast<int>(plane)},
                velocity_of(bodies, particles, particle).dot(planes[plane].normal), bodies.count(),
                time);
  });
}

void record_transitions(ContactBook& book, const Neighbours& neighbours, const ParticleRows& rows,
                        int num_bodies, double time) {
  const auto bodies_of_pair = [&](const Transition& transition) {
    const ParticlePair& pair = neighbours.pairs[transition.index];
    return ordered(rows.body[pair.i], rows.body[pair.j]);
  };
  const auto body_and_plane = [&](const Transition& transition) {
    const PlanePair& pair = neighbours.plane_pairs[transition.index];
    return BodyPair{rows.body[pair.row], num_bodies + static_cast<int>(pair.plane)};
  };
  // Begins first: a body that passes from one of its particles to the next has not let go.
  for_each_transition(book.plane_transitions, true, [&](const Transition& t) {
    begin_contact(book, body_and_plane(t), t.normal_velocity, num_bodies, time);
  });
  for_each_transition(book.pair_transitions, true, [&](const Transition& t) {
    begin_contact(book, bodies_of_pair(t), t.normal_velocity, num_bodies, time);
  });
  for_each_transition(book.plane_transitions, false, [&](const Transition& t) {
    end_contact(book, body_and_plane(t), t.normal_velocity, num_bodies, time);
  });
  for_each_transition(book.pair_transitions, false, [&](const Transition& t) {
    end_contact(book, bodies_of_pair(t), t.normal_velocity, num_bodies, time);
  });
}

}  // namespace verisim::dem
