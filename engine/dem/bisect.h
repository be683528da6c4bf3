// SPDX-License-Identifier: MIT
// The root of a function of one variable, to rounding.
#pragma once

namespace verisim::dem {

/// Root in (low, high), given whether a place lies above it. Sixty halvings.
template <class IsAboveRoot>
double bisect(double low, double high, const IsAboveRoot& is_above_root) {
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (is_above_root(middle) ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace verisim::dem
