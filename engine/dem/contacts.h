// SPDX-License-Identifier: MIT
// Forces of all listed particle pairs and planes on the particles.
#pragma once

#include <vector>

#include "dem/balance.h"
#include "dem/contact_book.h"
#include "dem/contact_law.h"
#include "dem/neighbours.h"
#include "dem/particle_rows.h"

namespace verisim::dem {

/// Adds to `rows.load`, which must be zero, and notes in `book` which contacts began or ended.
/// Each particle adds its planes, then its partners by rising row, whatever the number of threads.
/// block_sums: scratch, one per block of rows, added up in order of blocks.
ContactSums evaluate_contacts(ParticleRows& rows, Neighbours& neighbours, ContactBook& book,
                              const std::vector<PlaneDefinition>& planes, const ContactLaw& law,
                              std::vector<ContactSums>& block_sums, ThreadPool& pool);

}  // namespace verisim::dem
