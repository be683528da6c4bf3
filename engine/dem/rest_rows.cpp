// SPDX-License-Identifier: MIT
#include "dem/rest_rows.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "dem/rotation.h"

namespace verisim::dem {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Four = RestRows::Four;
using FourDerivatives = RestRows::FourDerivatives;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

VERISIM_INLINE Lanes all(double value) { return Lanes{value, value, value, value}; }
VERISIM_INLINE Lanes positive(const Lanes& x) { return x > 0.0 ? x : all(0); }
VERISIM_INLINE Lanes root(const Lanes& x) {
  return Lanes{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}
VERISIM_INLINE double sum(const Lanes& x) { return (x[0] + x[1]) + (x[2] + x[3]); }
VERISIM_INLINE Lanes dot3(const Lanes* x, const Lanes* y) {
  return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}
VERISIM_INLINE void cross3(const Lanes* x, const Lanes* y, Lanes* z) {
  z[0] = x[1] * y[2] - x[2] * y[1];
  z[1] = x[2] * y[0] - x[0] * y[2];
  z[2] = x[0] * y[1] - x[1] * y[0];
}

/// Four numbers of a body, from wherever they lie.
VERISIM_INLINE Lanes load_from(const double* numbers) {
  Lanes four;
  std::memcpy(&four, numbers, sizeof(four));
  return four;
}

/// Rows to columns and back.
VERISIM_INLINE void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  const Lanes ab_low = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Lanes ab_high = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Lanes cd_low = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Lanes cd_high = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}

/// Velocities at the points of four rows, of the bodies `of`.
VERISIM_INLINE void velocity_at(const std::array<int, 4>& of, const Lanes* arm,
                                const Vector6* bodies, Lanes* velocity) {
  const double* rows[4];
  for (std::size_t i = 0; i < 4; ++i) rows[i] = bodies[of[i]].data();
  Lanes vx = load_from(rows[0]), vy = load_from(rows[1]), vz = load_from(rows[2]),
        wx = load_from(rows[3]);
  transpose(vx, vy, vz, wx);
  Lanes skip = load_from(rows[0] + 2), same = load_from(rows[1] + 2), wy = load_from(rows[2] + 2),
        wz = load_from(rows[3] + 2);
  transpose(skip, same, wy, wz);
  const Lanes spin[3] = {wx, wy, wz};
  cross3(spin, arm, velocity);
  velocity[0] += vx;
  velocity[1] += vy;
  velocity[2] += vz;
}

VERISIM_INLINE void relative(const Four& four, const Vector6* bodies, Lanes* u) {
  Lanes of_b[3];
  velocity_at(four.a, four.arm_a, bodies, u);
  velocity_at(four.b, four.arm_b, bodies, of_b);
  for (int i = 0; i < 3; ++i) u[i] = u[i] - of_b[i];
}

struct Forces {
  Lanes load, pull[3], size;
};

/// Load and friction of four rows at relative velocities `u`. The friction is that of the spring
/// after the step, capped at the bound.
VERISIM_INLINE Forces forces_at(const Four& four, const Lanes* u, double h) {
  Forces f;
  const Lanes un = dot3(four.normal, u);
  f.load = positive(four.stiffness * four.compression - four.push * (un - four.rebound));
  const Lanes per_speed = (RestRows::kTangentialSteps * h) * four.grip;
  for (int i = 0; i < 3; ++i) {
    f.pull[i] = four.shear * four.stretch[i] + per_speed * (u[i] - un * four.normal[i]);
  }
  f.size = root(dot3(f.pull, f.pull));
  const Lanes scale = f.size > four.bound ? four.bound / f.size : all(1);
  for (int i = 0; i < 3; ++i) f.pull[i] = scale * f.pull[i];
  return f;
}

VERISIM_INLINE void add_impulse(const Lanes& first, double fifth, double sixth, Vector6& body) {
  double* numbers = body.data();
  Lanes four = load_from(numbers) + first;
  std::memcpy(numbers, &four, sizeof(four));
  numbers[4] += fifth;
  numbers[5] += sixth;
}

/// Adds the impulses of four rows to the bodies they act on.
VERISIM_INLINE void give(const std::array<int, 4>& to, const Lanes* arm, const Lanes* impulse,
                         Vector6* bodies) {
  Lanes turn[3];
  cross3(arm, impulse, turn);
  Lanes row0 = impulse[0], row1 = impulse[1], row2 = impulse[2], row3 = turn[0];
  transpose(row0, row1, row2, row3);
  add_impulse(row0, turn[1][0], turn[2][0], bodies[to[0]]);
  add_impulse(row1, turn[1][1], turn[2][1], bodies[to[1]]);
  add_impulse(row2, turn[1][2], turn[2][2], bodies[to[2]]);
  add_impulse(row3, turn[1][3], turn[2][3], bodies[to[3]]);
}

VERISIM_INLINE void evaluate_inline(std::vector<Four>& fours, const Vector6* bodies, double h,
                                    Vector6* sums) {
  for (Four& four : fours) {
    relative(four, bodies, four.u);
    for (int i = 0; i < 3; ++i) four.u[i] += four.given[i];
    const Forces f = forces_at(four, four.u, h);
    four.load = f.load;
    four.size = f.size;
    Lanes on_a[3], on_b[3];
    for (int i = 0; i < 3; ++i) {
      four.pull[i] = f.pull[i];
      on_a[i] = h * (f.load * four.normal[i] - f.pull[i]);
      on_b[i] = -on_a[i];
    }
    give(four.a, four.arm_a, on_a, sums);
    give(four.b, four.arm_b, on_b, sums);
  }
}

VERISIM_INLINE void set_direction_inline(std::vector<Four>& fours, const Vector6* bodies) {
  for (Four& four : fours) relative(four, bodies, four.du);
}

VERISIM_INLINE double slope_inline(const std::vector<Four>& fours, double t, double h) {
  Lanes total = all(0);
  for (const Four& four : fours) {
    Lanes u[3], across[3];
    const Lanes dn = dot3(four.normal, four.du);
    for (int i = 0; i < 3; ++i) {
      u[i] = four.u[i] + t * four.du[i];
      across[i] = four.du[i] - dn * four.normal[i];
    }
    const Forces f = forces_at(four, u, h);
    total += dot3(f.pull, across) - f.load * dn;
  }
  return h * sum(total);
}

/// The derivatives of four rows, W = c_n n n^T + c_t (1 - n n^T - share t t^T) at their arms.
VERISIM_INLINE void differentiate_inline(const std::vector<Four>& fours, double h, double share,
                                         std::vector<FourDerivatives>& derivatives) {
  const double scale = RestRows::kTangentialSteps * h * h;
  for (std::size_t k = 0; k < fours.size(); ++k) {
    const Four& four = fours[k];
    const Lanes* n = four.normal;
    const Lanes normal = four.load > 0.0 ? h * four.push : all(0);
    const auto slides = four.size > four.bound;
    const Lanes shared = slides ? four.bound / four.size : all(1);
    const Lanes across = four.bound > 0.0 ? scale * four.grip * shared : all(0);
    // The pull lies along the slip, capped at the bound.
    const Lanes length = root(dot3(four.pull, four.pull));
    const Lanes along = (slides & (length > 0.0)) ? share * across / (length * length) : all(0);
    const Lanes* t = four.pull;
    Lanes w[3][3];
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) {
        w[i][j] = (normal - across) * n[i] * n[j] - along * t[i] * t[j];
        if (i == j) w[i][j] += across;
        w[j][i] = w[i][j];
      }
    }
    Lanes turned[3][3];  // W [r]x, row by row
    for (int i = 0; i < 3; ++i) cross3(w[i], four.base_arm, turned[i]);
    Lanes* entry = derivatives[k].entry;
    int e = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) entry[e++] = w[i][j];
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) entry[e++] = -turned[i][j];
    }
    for (int j = 0; j < 3; ++j) {
      const Lanes column[3] = {turned[0][j], turned[1][j], turned[2][j]};
      Lanes torque[3];
      cross3(column, four.base_arm, torque);
      for (int i = 0; i <= j; ++i) entry[e++] = torque[i];
    }
  }
}

// The same code for processors with four lanes in one register and for those with two.

void evaluate_plain(std::vector<Four>& fours, const Vector6* bodies, double h, Vector6* sums) {
  evaluate_inline(fours, bodies, h, sums);
}
double slope_plain(const std::vector<Four>& fours, double t, double h) {
  return slope_inline(fours, t, h);
}
void set_direction_plain(std::vector<Four>& fours, const Vector6* bodies) {
  set_direction_inline(fours, bodies);
}
void differentiate_plain(const std::vector<Four>& fours, double h, double share,
                         std::vector<FourDerivatives>& derivatives) {
  differentiate_inline(fours, h, share, derivatives);
}
#if defined(__x86_64__)
__attribute__((target("avx2"))) void evaluate_avx2(std::vector<Four>& fours, const Vector6* bodies,
                                                   double h, Vector6* sums) {
  evaluate_inline(fours, bodies, h, sums);
}
__attribute__((target("avx2"))) double slope_avx2(const std::vector<Four>& fours, double t,
                                                  double h) {
  return slope_inline(fours, t, h);
}
__attribute__((target("avx2"))) void set_direction_avx2(std::vector<Four>& fours,
                                                        const Vector6* bodies) {
  set_direction_inline(fours, bodies);
}
__attribute__((target("avx2"))) void differentiate_avx2(const std::vector<Four>& fours, double h,
                                                        double share,
                                                        std::vector<FourDerivatives>& derivatives) {
  differentiate_inline(fours, h, share, derivatives);
}
#else
constexpr auto evaluate_avx2 = evaluate_plain;
constexpr auto slope_avx2 = slope_plain;
constexpr auto set_direction_avx2 = set_direction_plain;
constexpr auto differentiate_avx2 = differentiate_plain;
#endif

void set(Lanes* lanes, std::size_t lane, const Vector3d& v) {
  for (int i = 0; i < 3; ++i) lanes[i][lane] = v[i];
}

}  // namespace

Vector3d relative_velocity(const RestRow& row, const std::vector<Vector6>& v) {
  Vector3d u = row.given;
  if (row.a >= 0) {
    const Vector6& va = v[at(row.a)];
    u += va.head<3>() + va.tail<3>().cross(row.arm_a);
  }
  if (row.b >= 0) {
    const Vector6& vb = v[at(row.b)];
    u -= vb.head<3>() + vb.tail<3>().cross(row.arm_b);
  }
  return u;
}

void RestRows::set_places(const std::vector<RestRow>& rows, std::size_t num_bodies,
                          double duration) {
  h_ = duration;
  num_bodies_ = num_bodies;
  const int none = static_cast<int>(num_bodies);
  fours_.assign((rows.size() + 3) / 4, Four{});
  for (Four& four : fours_) four.a = four.b = {none, none, none, none};
  derivatives_.resize(fours_.size());
  pairs_.clear();
  const LocalPair* local = nullptr;
  int num_edges = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const RestRow& row = rows[r];
    Four& four = fours_[r / 4];
    const std::size_t lane = r % 4;
    set(four.normal, lane, row.normal);
    set(four.arm_a, lane, row.arm_a);
    set(four.arm_b, lane, row.arm_b);
    set(four.base_arm, lane, row.a >= 0 ? row.arm_a : row.arm_b);
    set(four.given, lane, row.given);
    set(four.stretch, lane, row.stretch);
    four.a[lane] = row.a >= 0 ? row.a : none;
    four.b[lane] = row.b >= 0 ? row.b : none;
    if (row.local != local) {
      local = row.local;
      const bool has_edge = row.a >= 0 && row.b >= 0;
      const int first = static_cast<int>(r);
      pairs_.push_back({first, first, row.a, row.b, has_edge ? num_edges++ : -1,
                        Vector3d(row.arm_b - row.arm_a)});
    }
    ++pairs_.back().last;
  }
}

void RestRows::set_springs(const std::vector<RestRow>& rows) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    Four& four = fours_[r / 4];
    const std::size_t lane = r % 4;
    four.compression[lane] = rows[r].compression;
    four.stiffness[lane] = rows[r].stiffness;
    four.rebound[lane] = rows[r].rebound;
    four.push[lane] = h_ * rows[r].stiffness + rows[r].damping;
    four.shear[lane] = rows[r].shear;
  }
}

void RestRows::set_bounds(const std::vector<RestRow>& rows, double slip_speed) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    Four& four = fours_[r / 4];
    const std::size_t lane = r % 4;
    four.bound[lane] = rows[r].bound;
    four.grip[lane] = rows[r].shear;
    if (slip_speed <= 0) continue;
    const double softened = rows[r].bound / (kTangentialSteps * h_ * slip_speed);
    four.grip[lane] = std::min(rows[r].shear, softened);
  }
}

void RestRows::take_forces(std::vector<RestRow>& rows) const {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Four& four = fours_[r / 4];
    const std::size_t lane = r % 4;
    rows[r].load = four.load[lane];
    rows[r].is_softened = four.grip[lane] < four.shear[lane];
    rows[r].tangential = {-four.pull[0][lane], -four.pull[1][lane], -four.pull[2][lane]};
  }
}

void RestRows::list_edges(BlockMatrix& matrix) const {
  matrix.edges.clear();
  for (const Pair& pair : pairs_) {
    if (pair.edge >= 0)
      matrix.edges.push_back({std::max(pair.a, pair.b), std::min(pair.a, pair.b)});
  }
}

void RestRows::evaluate(const std::vector<Vector6>& v, std::vector<Vector6>& gradient) {
  bodies_ = v;
  bodies_.push_back(Vector6::Zero());
  sums_.assign(num_bodies_ + 1, Vector6::Zero());
  (kHasAvx2 ? evaluate_avx2 : evaluate_plain)(fours_, bodies_.data(), h_, sums_.data());
  for (std::size_t i = 0; i < num_bodies_; ++i) gradient[i] -= sums_[i];
}

void RestRows::set_direction(const std::vector<Vector6>& direction) {
  bodies_ = direction;
  bodies_.push_back(Vector6::Zero());
  (kHasAvx2 ? set_direction_avx2 : set_direction_plain)(fours_, bodies_.data());
}

double RestRows::slope(double t) const {
  return (kHasAvx2 ? slope_avx2 : slope_plain)(fours_, t, h_);
}

void RestRows::add_stiffness(double sliding_share, BlockMatrix& matrix) {
  (kHasAvx2 ? differentiate_avx2 : differentiate_plain)(fours_, h_, sliding_share, derivatives_);
  for (const Pair& pair : pairs_) take_pair_stiffness(pair, matrix);
}

void RestRows::take_pair_stiffness(const Pair& pair, BlockMatrix& matrix) const {
  double entry[kEntries] = {};
  for (int r = pair.first; r < pair.last; ++r) {
    const FourDerivatives& four = derivatives_[at(r / 4)];
    for (int e = 0; e < kEntries; ++e) entry[e] += four.entry[e][r % 4];
  }
  if (entry[0] + entry[3] + entry[5] == 0) {  // the trace: no point is pressed in
    if (pair.edge >= 0) matrix.off[at(pair.edge)].setZero();
    return;
  }
  Matrix3d push, turn, torque;  // force over velocity, force over spin, torque over spin
  push << entry[0], entry[1], entry[2], entry[1], entry[3], entry[4], entry[2], entry[4], entry[5];
  turn << entry[6], entry[7], entry[8], entry[9], entry[10], entry[11], entry[12], entry[13],
      entry[14];
  torque << entry[15], entry[16], entry[18], entry[16], entry[17], entry[19], entry[18], entry[19],
      entry[20];
  const auto add = [](const Matrix3d& p, const Matrix3d& t, const Matrix3d& q, Matrix6& block) {
    block.topLeftCorner<3, 3>() += p;
    block.topRightCorner<3, 3>() += t;
    block.bottomLeftCorner<3, 3>() += t.transpose();
    block.bottomRightCorner<3, 3>() += q;
  };
  const int base = pair.a >= 0 ? pair.a : pair.b;
  add(push, turn, torque, matrix.diagonal[at(base)]);
  if (pair.edge < 0) return;
  // At b's centre of mass the same points have the arms r + d, d from b's centre to a's:
  // J_b = J_a [1, -[d]x; 0, 1].
  const Matrix3d d = cross_matrix(pair.a_from_b);
  const Matrix3d turn_b = turn - push * d;
  const Matrix3d mixed = torque - turn.transpose() * d;
  add(push, turn_b, mixed + d * turn_b, matrix.diagonal[at(pair.b)]);
  Matrix6& off = matrix.off[at(pair.edge)];
  if (pair.a > pair.b) {
    off.topLeftCorner<3, 3>() = -push;
    off.topRightCorner<3, 3>() = -turn_b;
    off.bottomLeftCorner<3, 3>() = -turn.transpose();
    off.bottomRightCorner<3, 3>() = -mixed;
  } else {
    off.topLeftCorner<3, 3>() = -push;
    off.topRightCorner<3, 3>() = -turn;
    off.bottomLeftCorner<3, 3>() = -turn_b.transpose();
    off.bottomRightCorner<3, 3>() = -mixed.transpose();
  }
}

}  // namespace verisim::dem
