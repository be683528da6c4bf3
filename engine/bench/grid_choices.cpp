// SPDX-License-Identifier: MIT
// Design choices of grids of particles, side by side: how cells are kept, what a cap of four
// particles per cell loses, and what filling a mesh costs.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <new>
#include <random>
#include <unordered_map>
#include <vector>

#include "shape/fill_particles.h"
#include "shape/primitives.h"

namespace {

using Clock = std::chrono::steady_clock;
using Place = std::array<float, 3>;
using Cell = std::array<int, 3>;

constexpr int kNumParticles = 20000;
constexpr int kRepeats = 5;
constexpr int kCap = 4;  // particles in a texel of the source's grid
constexpr std::size_t kMostCells = std::size_t{1} << 28;  // of the dense array: 1 GiB of starts
std::size_t allocated_bytes = 0;                          // by containers under test

/// Counts what a container keeps on the heap.
template <class T>
struct Counted {
  using value_type = T;
  Counted() = default;
  template <class U>
  explicit(false) Counted(const Counted<U>&) {}
  T* allocate(std::size_t count) {
    allocated_bytes += count * sizeof(T);
    return static_cast<T*>(::operator new(count * sizeof(T)));
  }
  void deallocate(T* place, std::size_t count) {
    allocated_bytes -= count * sizeof(T);
    ::operator delete(place);
  }
  bool operator==(const Counted&) const = default;
};

template <class T>
using Row = std::vector<T, Counted<T>>;

/// Particles of diameter 1 on a disturbed lattice of `occupancy` per unit cell, in the middle of a
/// world of `num_cells` cells along each side.
struct Bed {
  std::vector<Place> places;
  int num_cells = 0;
};

Bed bed_of(double occupancy, int times_larger) {
  const int row = static_cast<int>(std::lround(std::cbrt(kNumParticles)));
  const double spacing = std::cbrt(1 / occupancy);
  const int filled = static_cast<int>(std::ceil(row * spacing)) + 2;
  Bed bed;
  bed.num_cells = filled * times_larger;
  const double corner = 0.5 * (bed.num_cells - row * spacing);
  std::mt19937 generator(1);
  const auto aside = [&] { return (generator() / 4294967296.0 - 0.5) * 0.5 * spacing; };
  for (int n = 0; n < row * row * row; ++n) {
    const std::array<int, 3> at{n % row, n / row % row, n / (row * row)};
    Place place;
    for (int axis = 0; axis < 3; ++axis) {
      place[axis] = static_cast<float>(corner + (at[axis] + 0.5) * spacing + aside());
    }
    bed.places.push_back(place);
  }
  return bed;
}

Cell cell_of(const Place& place) {
  return {static_cast<int>(place[0]), static_cast<int>(place[1]), static_cast<int>(place[2])};
}

std::size_t key_of(const Cell& cell, int num_cells) {
  const auto side = static_cast<std::size_t>(num_cells);
  return (static_cast<std::size_t>(cell[2]) * side + cell[1]) * side + cell[0];
}

/// One start per cell of the world, particles behind each other (counting sort over all cells).
struct Dense {
  Row<std::uint32_t> starts, items;
  static constexpr const char* kName = "dense array";
  static bool fits(const Bed& bed) {
    return std::pow(bed.num_cells, 3) < static_cast<double>(kMostCells);
  }
  void build(const Bed& bed) {
    const auto side = static_cast<std::size_t>(bed.num_cells);
    starts.assign(side * side * side + 1, 0);
    items.resize(bed.places.size());
    for (const Place& place : bed.places) ++starts[key_of(cell_of(place), bed.num_cells) + 1];
    for (std::size_t n = 1; n < starts.size(); ++n) starts[n] += starts[n - 1];
    for (std::size_t i = bed.places.size(); i-- > 0;) {
      const std::size_t key = key_of(cell_of(bed.places[i]), bed.num_cells);
      items[--starts[key + 1]] = static_cast<std::uint32_t>(i);
    }
  }
  template <class Visit>
  void visit(std::size_t key, const Visit& see) const {
    const std::size_t end = key + 2 < starts.size() ? starts[key + 2] : items.size();
    for (std::size_t n = starts[key + 1]; n < end; ++n) see(items[n]);
  }
};

/// A list of particles per occupied cell, in a map.
template <class Map>
struct Listed {
  Map cells;
  static bool fits(const Bed&) { return true; }
  void build(const Bed& bed) {
    cells.clear();
    for (std::size_t i = 0; i < bed.places.size(); ++i) {
      cells[key_of(cell_of(bed.places[i]), bed.num_cells)].push_back(static_cast<std::uint32_t>(i));
    }
  }
  template <class Visit>
  void visit(std::size_t key, const Visit& see) const {
    const auto found = cells.find(key);
    if (found == cells.end()) return;
    for (const std::uint32_t i : found->second) see(i);
  }
};

using Items = Row<std::uint32_t>;
using Entry = std::pair<const std::size_t, Items>;
struct Tree : Listed<std::map<std::size_t, Items, std::less<>, Counted<Entry>>> {
  static constexpr const char* kName = "std::map";
};
struct Hashed : Listed<std::unordered_map<std::size_t, Items, std::hash<std::size_t>,
                                          std::equal_to<>, Counted<Entry>>> {
  static constexpr const char* kName = "hash map";
};

/// Counting sort over hashed cells, twice as many as particles; others' particles are skipped by
/// their distance alone.
struct Sorted {
  Row<std::uint32_t> starts, items;
  int shift = 0;  // leaves as many bits as slots need
  static constexpr const char* kName = "counting sort";
  static bool fits(const Bed&) { return true; }
  [[nodiscard]] std::size_t slot(std::size_t key) const {
    return key * 0x9E3779B97F4A7C15ULL >> shift;
  }
  void build(const Bed& bed) {
    std::size_t count = 1;
    shift = 64;
    for (; count < 2 * bed.places.size(); count *= 2) --shift;
    starts.assign(count + 1, 0);
    items.resize(bed.places.size());
    for (const Place& place : bed.places) {
      ++starts[slot(key_of(cell_of(place), bed.num_cells))];
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& start : starts) start = sum += start;
    for (std::size_t i = bed.places.size(); i-- > 0;) {
      items[--starts[slot(key_of(cell_of(bed.places[i]), bed.num_cells))]] =
          static_cast<std::uint32_t>(i);
    }
  }
  template <class Visit>
  void visit(std::size_t key, const Visit& see) const {
    const std::size_t at = slot(key);
    for (std::size_t n = starts[at]; n < starts[at + 1]; ++n) see(items[n]);
  }
};

struct Found {
  long checks = 0, contacts = 0;
};

/// Pairs that overlap, each seen from both sides. Slots that two of the 27 cells share are counted
/// once per cell, so contacts are told by the cell that the other particle lies in.
template <class Grid>
Found contacts_of(const Grid& grid, const Bed& bed) {
  Found found;
  for (std::size_t i = 0; i < bed.places.size(); ++i) {
    const Place& own = bed.places[i];
    const Cell middle = cell_of(own);
    for (int n = 0; n < 27; ++n) {
      const Cell cell{middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1, middle[2] + n / 9 - 1};
      grid.visit(key_of(cell, bed.num_cells), [&](std::uint32_t j) {
        ++found.checks;
        if (j == i) return;
        const Place& other = bed.places[j];
        float squared = 0;
        for (int axis = 0; axis < 3; ++axis) {
          squared += (own[axis] - other[axis]) * (own[axis] - other[axis]);
        }
        if (squared < 1 && cell_of(other) == cell) ++found.contacts;
      });
    }
  }
  return found;
}

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

template <class Grid>
void time_grid(const Bed& bed, double occupancy, int times_larger) {
  if (!Grid::fits(bed)) {
    std::printf("%9.1f %7d  %-14s  more than a GiB\n", occupancy, times_larger, Grid::kName);
    return;
  }
  const auto count = static_cast<double>(bed.places.size());
  Grid grid;
  grid.build(bed);  // warms up: later builds find their memory
  const double bytes = static_cast<double>(allocated_bytes) / count;
  double build_s = 1e9, query_s = 1e9;
  Found found;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    auto begin = Clock::now();
    grid.build(bed);
    build_s = std::min(build_s, seconds_since(begin));
    begin = Clock::now();
    found = contacts_of(grid, bed);
    query_s = std::min(query_s, seconds_since(begin));
  }
  std::printf("%9.1f %7d  %-14s %10.1f %10.1f %10.1f %10.1f %10.2f\n", occupancy, times_larger,
              Grid::kName, 1e9 * build_s / count, 1e9 * query_s / count, bytes,
              static_cast<double>(found.checks) / count,
              static_cast<double>(found.contacts) / count);
}

/// Contacts that are missed if a cell keeps only the first four particles it gets.
void count_lost(double occupancy) {
  const Bed bed = bed_of(occupancy, 1);
  Dense grid;
  grid.build(bed);
  const long all = contacts_of(grid, bed).contacts;
  Bed kept;
  kept.num_cells = bed.num_cells;
  std::map<std::size_t, int> held;
  std::vector<bool> is_kept;
  for (const Place& place : bed.places) {
    is_kept.push_back(held[key_of(cell_of(place), bed.num_cells)]++ < kCap);
    if (is_kept.back()) kept.places.push_back(place);
  }
  // Every particle still looks around itself, as in the source: a contact is lost on the side of
  // the one that finds the other missing.
  Dense capped;
  capped.build(kept);
  long left = 0;
  for (std::size_t i = 0; i < bed.places.size(); ++i) {
    const Place& own = bed.places[i];
    const Cell middle = cell_of(own);
    for (int n = 0; n < 27; ++n) {
      const Cell cell{middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1, middle[2] + n / 9 - 1};
      capped.visit(key_of(cell, kept.num_cells), [&](std::uint32_t j) {
        float squared = 0;
        for (int axis = 0; axis < 3; ++axis) {
          const float apart = own[axis] - kept.places[j][axis];
          squared += apart * apart;
        }
        if (squared > 0 && squared < 1) ++left;
      });
    }
  }
  const auto missing = static_cast<double>(bed.places.size() - kept.places.size());
  std::printf("%9.1f %12.2f %12.2f\n", occupancy,
              100 * missing / static_cast<double>(bed.places.size()),
              100 * static_cast<double>(all - left) / static_cast<double>(all));
}

void time_filling(int subdivisions, int columns) {
  const auto mesh = verisim::shape::sphere_mesh(1, subdivisions);
  double best = 1e9;
  verisim::shape::ParticleFill fill;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const auto begin = Clock::now();
    fill = verisim::shape::fill_mesh(mesh, 2.0 / columns);
    best = std::min(best, seconds_since(begin));
  }
  std::printf("%9zu %8d %10zu %10.3f %12lld %10.1f\n", mesh.triangles.size(), columns * columns,
              fill.centers.size(), 1e3 * best, static_cast<long long>(fill.num_ray_tests),
              1e9 * best / static_cast<double>(fill.num_ray_tests));
}

}  // namespace

int main() {
  std::printf("grids of %d particles (world: times the filled part, along each side)\n",
              kNumParticles);
  std::printf("%9s %7s  %-14s %10s %10s %10s %10s %10s\n", "in a cell", "world", "cells in",
              "build ns", "query ns", "bytes", "checks", "contacts");
  for (const int times_larger : {1, 4, 16}) {
    for (const double occupancy : {0.25, 1.0, 2.0, 4.0}) {
      const Bed bed = bed_of(occupancy, times_larger);
      time_grid<Dense>(bed, occupancy, times_larger);
      time_grid<Tree>(bed, occupancy, times_larger);
      time_grid<Hashed>(bed, occupancy, times_larger);
      time_grid<Sorted>(bed, occupancy, times_larger);
    }
  }
  std::printf("\ncap of %d particles in a cell: lost, %%\n%9s %12s %12s\n", kCap, "in a cell",
              "particles", "contacts");
  for (const double occupancy : {0.5, 1.0, 1.4, 2.0, 3.0, 4.0}) count_lost(occupancy);
  std::printf("\nfilling a ball\n%9s %8s %10s %10s %12s %10s\n", "triangles", "columns",
              "particles", "ms", "ray tests", "ns a test");
  for (const int subdivisions : {2, 4, 6}) {
    for (const int columns : {8, 32, 128}) time_filling(subdivisions, columns);
  }
  return 0;
}
