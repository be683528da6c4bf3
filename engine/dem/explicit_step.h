// SPDX-License-Identifier: MIT
// One explicit step of an island: exact flight to touch-down, or kick-drift-kick in contact.
#pragma once

#include "dem/flight.h"

namespace verisim::dem {

/// Advances by at most `longest` (s) and returns the time advanced. Where nothing touches: free
/// flight, up to the first touch-down at the latest. Where something does: one of the steps that
/// divide the shortest contact.
double explicit_step(Island& island, double longest, const ContactSettings& settings);

/// Forces and torques of gravity, contacts and outside at the present state, with tangential
/// springs advanced over the `drift` (s) that led here.
void evaluate_contact_forces(Island& island, double drift, const ContactSettings& settings);

}  // namespace verisim::dem
