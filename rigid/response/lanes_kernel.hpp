#pragma once
// Vectors, bodies and sweeps of eight pairs at a time. Only for *_kernel.cpp.
#include <cmath>
#include <cstring>

#include "cpu/lanes.hpp"
#include "rigid/response/contact_lanes.hpp"

namespace silt::rigid::SILT_BUILD {
namespace {

using Numbers = Registers<double, lane_count>;
using Mask = Numbers::Mask;

struct Vector {
  Numbers x, y, z;

  Vector operator+(const Vector& o) const { return {x + o.x, y + o.y, z + o.z}; }
  Vector operator-(const Vector& o) const { return {x - o.x, y - o.y, z - o.z}; }
  Vector operator*(Numbers s) const { return {s * x, s * y, s * z}; }
  Vector& operator+=(const Vector& o) { return *this = *this + o; }
  Vector& operator-=(const Vector& o) { return *this = *this - o; }
};
inline Numbers dot(const Vector& a, const Vector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vector choose(Mask m, const Vector& a, const Vector& b) {
  return {choose(m, a.x, b.x), choose(m, a.y, b.y), choose(m, a.z, b.z)};
}
inline Vector load(const Real8* v) {
  return {v[0], v[1], v[2]};
}
inline void store(Real8* v, const Vector& a) {
  v[0] = a.x;
  v[1] = a.y;
  v[2] = a.z;
}
/// Multiplies a symmetric matrix (xx, yy, zz, xy, xz, yz) by a vector.
inline Vector times(const Real8* m, const Vector& a) {
  return {m[0] * a.x + m[3] * a.y + m[4] * a.z, m[3] * a.x + m[1] * a.y + m[5] * a.z,
          m[4] * a.x + m[5] * a.y + m[2] * a.z};
}

/// The lanes of a group to be solved in a sweep.
struct LanesToSolve {
  Mask on;        // all in the first sweep, then pairs of changed bodies and pairs with extrapolated impulses
  Mask to_carry;  // those to be extrapolated afterwards: not pairs solved only because of an extrapolation
};
inline Mask needs_sweeps(const LaneBodies& bodies) {
  return Numbers(bodies.again) != 0;
}
inline LanesToSolve to_solve(const LaneBodies& bodies, const Real8& carried, const BodyState* state,
                             const ContactSweep& sweep) {
  const Mask none{}, all = ~none, again = needs_sweeps(bodies);
  const auto changed = [&](const std::int32_t* rows) {
    return Numbers::gathered([&](int l) { return state[rows[l]].number; }) != 0;
  };
  const Mask moved = sweep.number == 1 ? all : again & (changed(bodies.a) | changed(bodies.b));
  return {moved | (Numbers(carried) != 0), sweep.plain ? none : again & moved};
}

/// Four numbers of a body, half of its cache line, for one read or write.
using HalfLine = double __attribute__((vector_size(4 * sizeof(double))));
inline HalfLine half_line(const double* from) {
  HalfLine h;
  std::memcpy(&h, from, sizeof h);
  return h;
}

/// Eight half lines transposed: the first number of each, the second, ...
struct Transposed {
  Numbers first, second, third, fourth;  // not an array, which compilers would copy through memory
};
/// Reads lanes as they are in memory.
template <class Lines>
Numbers lanes_of(const Lines& lines) {
  static_assert(sizeof lines == sizeof(Numbers));
  Numbers lanes;
  std::memcpy(&lanes, &lines, sizeof lanes);
  return lanes;
}

/// Two half lines, for registers of that size. (Stores of two halves before a load of the whole would stall.)
using FullLine = double __attribute__((vector_size(8 * sizeof(double))));
/// Transposes two 4 x 4 matrices, whose rows are side by side.
inline void transpose_squares(FullLine (&row)[4]) {
  const FullLine low = __builtin_shufflevector(row[0], row[1], 0, 8, 2, 10, 4, 12, 6, 14),
                 high = __builtin_shufflevector(row[0], row[1], 1, 9, 3, 11, 5, 13, 7, 15),
                 low_2 = __builtin_shufflevector(row[2], row[3], 0, 8, 2, 10, 4, 12, 6, 14),
                 high_2 = __builtin_shufflevector(row[2], row[3], 1, 9, 3, 11, 5, 13, 7, 15);
  row[0] = __builtin_shufflevector(low, low_2, 0, 1, 8, 9, 4, 5, 12, 13);
  row[1] = __builtin_shufflevector(high, high_2, 0, 1, 8, 9, 4, 5, 12, 13);
  row[2] = __builtin_shufflevector(low, low_2, 2, 3, 10, 11, 6, 7, 14, 15);
  row[3] = __builtin_shufflevector(high, high_2, 2, 3, 10, 11, 6, 7, 14, 15);
}

[[gnu::always_inline]] inline Transposed transposed(const HalfLine (&h)[lane_count]) {
  if constexpr (Numbers::count == 1) {
    FullLine row[4];
    for (int k = 0; k < 4; ++k) row[k] = __builtin_shufflevector(h[k], h[k + 4], 0, 1, 2, 3, 4, 5, 6, 7);
    transpose_squares(row);
    return {lanes_of(row[0]), lanes_of(row[1]), lanes_of(row[2]), lanes_of(row[3])};
  }
  HalfLine to[4][2];
  for (int k = 0; k < 2; ++k) {
    const HalfLine *from = h + 4 * k, low = __builtin_shufflevector(from[0], from[1], 0, 4, 2, 6),
                   high = __builtin_shufflevector(from[0], from[1], 1, 5, 3, 7),
                   low_2 = __builtin_shufflevector(from[2], from[3], 0, 4, 2, 6),
                   high_2 = __builtin_shufflevector(from[2], from[3], 1, 5, 3, 7);
    to[0][k] = __builtin_shufflevector(low, low_2, 0, 1, 4, 5);
    to[1][k] = __builtin_shufflevector(high, high_2, 0, 1, 4, 5);
    to[2][k] = __builtin_shufflevector(low, low_2, 2, 3, 6, 7);
    to[3][k] = __builtin_shufflevector(high, high_2, 2, 3, 6, 7);
  }
  return {lanes_of(to[0]), lanes_of(to[1]), lanes_of(to[2]), lanes_of(to[3])};
}
/// The inverse, as a separate function: a common function for both directions would make a sweep a sixth
/// slower.
inline void transpose(const Numbers& x, const Numbers& y, const Numbers& z, const Numbers& w,
                      HalfLine (&to)[lane_count]) {
  if constexpr (Numbers::count == 1) {
    FullLine row[4];
    std::memcpy(&row[0], &x, sizeof x), std::memcpy(&row[1], &y, sizeof y);
    std::memcpy(&row[2], &z, sizeof z), std::memcpy(&row[3], &w, sizeof w);
    transpose_squares(row);
    for (int k = 0; k < 4; ++k) {
      to[k] = __builtin_shufflevector(row[k], row[k], 0, 1, 2, 3);
      to[k + 4] = __builtin_shufflevector(row[k], row[k], 4, 5, 6, 7);
    }
    return;
  }
  HalfLine from[4][2];
  std::memcpy(from[0], &x, sizeof x), std::memcpy(from[1], &y, sizeof y);
  std::memcpy(from[2], &z, sizeof z), std::memcpy(from[3], &w, sizeof w);
  for (int k = 0; k < 2; ++k) {
    const HalfLine low = __builtin_shufflevector(from[0][k], from[1][k], 0, 4, 2, 6),
                   high = __builtin_shufflevector(from[0][k], from[1][k], 1, 5, 3, 7),
                   low_2 = __builtin_shufflevector(from[2][k], from[3][k], 0, 4, 2, 6),
                   high_2 = __builtin_shufflevector(from[2][k], from[3][k], 1, 5, 3, 7);
    to[4 * k] = __builtin_shufflevector(low, low_2, 0, 1, 4, 5);
    to[4 * k + 1] = __builtin_shufflevector(high, high_2, 0, 1, 4, 5);
    to[4 * k + 2] = __builtin_shufflevector(low, low_2, 2, 3, 6, 7);
    to[4 * k + 3] = __builtin_shufflevector(high, high_2, 2, 3, 6, 7);
  }
}

/// Linear and angular velocities of eight bodies.
struct Twist {
  Vector v, w;
};
inline Transposed first_half(const std::int32_t* rows, const BodyState* state) {
  HalfLine h[lane_count];
  for (int l = 0; l < lane_count; ++l) h[l] = half_line(state[rows[l]].v);
  return transposed(h);
}
inline Vector velocities(const std::int32_t* rows, const BodyState* state) {
  const Transposed t = first_half(rows, state);
  return {t.first, t.second, t.third};
}
inline Twist twists(const std::int32_t* rows, const BodyState* state) {
  HalfLine h[lane_count];
  for (int l = 0; l < lane_count; ++l) h[l] = half_line(state[rows[l]].w + 1);
  const Transposed low = first_half(rows, state), high = transposed(h);
  return {{low.first, low.second, low.third}, {low.fourth, high.first, high.second}};
}

/// The effect of eight pairs on their bodies: impulses on b, reversed on a, and moments on both.
struct Push {
  Vector impulse, moment_a, moment_b;
};
/// Adds the pushes of the lanes in `on`, one lane after another (`turning` false: without moments); lanes in
/// `marked` count as changes. (A sum is never -0, so adding zeros changes no bit.)
template <bool turning>
void add_to_bodies(const LaneBodies& bodies, const Push& push, const Mask& on, const Mask& marked,
                   BodySum* sums) {
  HalfLine first_a[lane_count], first_b[lane_count], second_a[lane_count], second_b[lane_count];
  const unsigned those = lane_bits(on);
  const Numbers none{};
  const auto& [impulse, moment_a, moment_b] = push;
  const Vector reverse = Vector{none, none, none} - impulse;
  transpose(reverse.x, reverse.y, reverse.z, turning ? moment_a.x : none, first_a);
  transpose(impulse.x, impulse.y, impulse.z, turning ? moment_b.x : none, first_b);
  const Numbers changed = choose(marked, 1, none);
  if constexpr (turning) {
    transpose(moment_a.y, moment_a.z, changed, none, second_a);
    transpose(moment_b.y, moment_b.z, changed, none, second_b);
  }
  const auto add = [](double* to, const HalfLine& h) {
    const HalfLine sum = half_line(to) + h;
    std::memcpy(to, &sum, sizeof sum);
  };
  for (int l = 0; l < lane_count; ++l) {
    if (!(those >> l & 1)) continue;
    BodySum &a = sums[bodies.a[l]], &b = sums[bodies.b[l]];
    add(a.impulse, first_a[l]), add(b.impulse, first_b[l]);
    if constexpr (turning)
      add(a.angular + 1, second_a[l]), add(b.angular + 1, second_b[l]);
    else
      a.changed += changed[l], b.changed += changed[l];
  }
}

/// Returns the factor by which impulses are extrapolated along their last change: Nesterov's acceleration, in
/// the k-th sweep since the last restart (k - 1) / (k + 2). A pair restarts when the extrapolation opposed
/// its change (O'Donoghue, Candes, Found. Comput. Math. 15 (2015) 715, gradient scheme).
inline Numbers momentum(Real8& age, const Numbers& opposed, const Mask& on) {
  const Numbers before = age, k = choose(opposed > 0, 1, before);
  age = choose(on, k + 1, before);
  return choose(on, (k - 1) / (k + 2), 0);
}

/// Accumulates the outcome of a sweep over its groups.
class Outcome {
 public:
  template <class Group>
  void add(const Group& g, Numbers relative_change) {
    residual_ = choose(needs_sweeps(g.bodies) & (relative_change > residual_), relative_change, residual_);
    carried_ = carried_ | (Numbers(g.carried) != 0);
    solved_ = true;
  }
  SweepOutcome all() const { return {largest(residual_), solved_, any_lane(carried_)}; }
  /// Returns the outcome if squares of changes were added.
  SweepOutcome of_squares() const { return {std::sqrt(largest(residual_)), solved_, any_lane(carried_)}; }

 private:
  Numbers residual_{};
  Mask carried_{};
  bool solved_ = false;
};

/// Projects tangential impulses onto the friction cone.
inline Vector into_cone(const Vector& q, Numbers limit) {
  const Numbers square = dot(q, q);
  const Mask outside = square > limit * limit;
  if (!any_lane(outside)) return q;  // avoids the latency of roots and quotients
  return choose(outside, q * (limit / square_root(square)), q);
}

}  // namespace
}  // namespace silt::rigid::SILT_BUILD
