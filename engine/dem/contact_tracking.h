// SPDX-License-Identifier: MIT
// Keeps the points of a pair while bodies move: knows them again, begins and ends contacts.
#pragma once

#include "dem/island.h"

namespace verisim::dem {

/// Looks at a pair anew. Points that are known again keep their springs; points that appear under
/// the surface of a pair that already touches are born without force (offset = depth); if no point
/// is known again, the new ones share the old load, without gain of energy. Returns the energy (J)
/// of springs that nobody takes over. `elapsed`: time (s) since the last look, over which points
/// that are not found again went on at the present velocities.
double look_at(LocalPair& local, const std::vector<BodyState>& bodies, double margin,
               double elapsed = 0);
/// The same; the island's books take the energy.
void look_and_book(LocalPair& local, Island& island, double margin, double elapsed = 0);

/// Speed (m/s) at which the bodies approach each other at a point; < 0: they part.
double closing_speed(const LocalPair& local, const std::vector<BodyState>& bodies,
                     const ContactPoint& point);

/// Gap (m) below which two surfaces have met.
double touch_gap(const ContactSettings& settings);

/// Fastest approach (m/s) of the points of a pair that have met; minus infinity if none has.
double fastest_closing(const LocalPair& local, const std::vector<BodyState>& bodies,
                       const ContactSettings& settings);

/// True if a pair of the island touches.
bool has_contact(const Island& island);

/// Energy (J) of a point's normal spring.
double normal_energy(const ContactPair& pair, const ContactPoint& point);

/// Begins the contact of a pair whose points are within `tolerance` (m) and approach, and ends
/// that of a pair whose points have all left. Stiffness and damping scale are set at the onset.
void update_contact(LocalPair& local, Island& island, const ContactSettings& settings,
                    double tolerance);

/// A contact of the pair begins or ends now, at `speed` (m/s; see ContactEvent).
void record_event(Island& island, const LocalPair& local, ContactChange change, double speed);

/// A stored stretch (m) turned into the plane across `normal`, its length kept.
Eigen::Vector3d turned_into_plane(Eigen::Vector3d stretch, const Eigen::Vector3d& normal);

/// Inverse of the mass (1/kg) that two bodies present to each other, rotation left aside.
double inverse_pair_mass(const BodyState& a, const BodyState& b);

/// Raises a pair's stiffness with the force of every point held continuous. Returns the energy (J)
/// that this takes out of the normal springs.
double stiffen(ContactPair& pair, double stiffness);

/// Greatest depth (m) of a pair's points; 0 if they are apart.
double deepest(const ContactPair& pair);

/// What an implicit step may err in the depth (m) of a pair that lies `depth` deep: `share` depths
/// of rest, less where little is left of the allowed penetration.
double room(double depth, double share, const ContactSettings& settings);

/// Slowest approach speed (m/s) that damping is scaled with: the speed of free fall through the
/// depth of rest.
double least_approach_speed(const ContactSettings& settings);

/// Slowest approach (m/s) that counts as an impact: it rebounds by more than the depth of rest.
double least_impact_speed(const ContactSettings& settings);

}  // namespace verisim::dem
