#pragma once
// Vectors, bodies and sweeps of eight pairs at a time, for the contact kernels. Only for *_kernel.cpp: built
// once an instruction set.
#include "rigid/response/wide_kernel.hpp"

namespace silt::rigid::SILT_ISA {
namespace {

struct Vector {
  Lanes x, y, z;

  Vector operator+(const Vector& o) const { return {x + o.x, y + o.y, z + o.z}; }
  Vector operator-(const Vector& o) const { return {x - o.x, y - o.y, z - o.z}; }
  Vector operator*(Lanes s) const { return {s * x, s * y, s * z}; }
  Vector& operator+=(const Vector& o) { return *this = *this + o; }
  Vector& operator-=(const Vector& o) { return *this = *this - o; }
};
inline Lanes dot(const Vector& a, const Vector& b) {
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
/// A symmetric matrix (xx, yy, zz, xy, xz, yz) times a vector.
inline Vector times(const Real8* m, const Vector& a) {
  return {m[0] * a.x + m[3] * a.y + m[4] * a.z, m[3] * a.x + m[1] * a.y + m[5] * a.z,
          m[4] * a.x + m[5] * a.y + m[2] * a.z};
}

/// The lanes of a group in a sweep.
struct LanesToSolve {
  Mask on;  // all in the first sweep, then those of which a body changed or whose impulses were carried on
  Mask to_carry;  // of them, whose impulses are then carried on: not those at rest but for being carried
};
inline Mask goes_on(const LaneBodies& bodies) {
  return whole_numbers(bodies.again) != 0;
}
inline LanesToSolve to_solve(const LaneBodies& bodies, const Real8& carried, const BodyState* state,
                             const ContactSweep& sweep) {
  const Mask none{}, all = ~none, again = goes_on(bodies);
  const auto changed = [&](const std::int32_t* rows) {
    return gathered([&](int l) { return state[rows[l]].number; }) != 0;
  };
  const Mask moved = sweep.number == 1 ? all : again & (changed(bodies.a) | changed(bodies.b));
  return {moved | (Lanes(carried) != 0), sweep.plain ? none : again & moved};
}

/// Four numbers of a body, half of its cache line: one read or write for four.
using HalfLine = double __attribute__((vector_size(4 * sizeof(double))));
inline HalfLine half_line(const double* from) {
  HalfLine h;
  std::memcpy(&h, from, sizeof h);
  return h;
}

/// Number k of half line j becomes number j of half line k.
[[gnu::always_inline]] inline void transpose(HalfLine (&h)[4]) {
  const HalfLine even_01 = __builtin_shufflevector(h[0], h[1], 0, 4, 2, 6),
                 odd_01 = __builtin_shufflevector(h[0], h[1], 1, 5, 3, 7),
                 even_23 = __builtin_shufflevector(h[2], h[3], 0, 4, 2, 6),
                 odd_23 = __builtin_shufflevector(h[2], h[3], 1, 5, 3, 7);
  h[0] = __builtin_shufflevector(even_01, even_23, 0, 1, 4, 5);
  h[1] = __builtin_shufflevector(odd_01, odd_23, 0, 1, 4, 5);
  h[2] = __builtin_shufflevector(even_01, even_23, 2, 3, 6, 7);
  h[3] = __builtin_shufflevector(odd_01, odd_23, 2, 3, 6, 7);
}

/// The numbers of half a line, of eight bodies each.
struct Numbers {
  Lanes of[4];
};
template <class HalfOf>  // of body l
Numbers numbers(HalfOf half_of) {
  HalfLine by_number[4][2];
  for (int k = 0; k < 2; ++k) {
    HalfLine h[4];
    for (int l = 0; l < 4; ++l) h[l] = half_of(4 * k + l);
    transpose(h);
    for (int n = 0; n < 4; ++n) by_number[n][k] = h[n];
  }
  Numbers all;
  std::memcpy(&all, by_number, sizeof all);
  return all;
}
/// The reverse: a half line a body.
inline void half_lines(const Numbers& all, HalfLine (&of_body)[lane_count]) {
  HalfLine by_number[4][2];
  std::memcpy(by_number, &all, sizeof all);
  for (int k = 0; k < 2; ++k) {
    HalfLine h[4];
    for (int n = 0; n < 4; ++n) h[n] = by_number[n][k];
    transpose(h);
    for (int l = 0; l < 4; ++l) of_body[4 * k + l] = h[l];
  }
}

/// Velocities of eight bodies, and angular ones.
struct Twist {
  Vector v, w;
};
inline Numbers first_half(const std::int32_t* rows, const BodyState* state) {
  return numbers([&](int l) { return half_line(state[rows[l]].v); });
}
inline Vector velocities(const std::int32_t* rows, const BodyState* state) {
  const Numbers first = first_half(rows, state);
  return {first.of[0], first.of[1], first.of[2]};
}
inline Twist twists(const std::int32_t* rows, const BodyState* state) {
  const Numbers first = first_half(rows, state),
                second = numbers([&](int l) { return half_line(state[rows[l]].w + 1); });
  return {{first.of[0], first.of[1], first.of[2]}, {first.of[3], second.of[0], second.of[1]}};
}

/// What eight pairs do to their bodies: an impulse on b, its reverse on a, and the moments on either (none of
/// them: `turning` false), of those in `on`, one lane after the other; those in `marked` are noted as
/// changes. (A sum is never -0, so zeros change no bit.)
template <bool turning>
void add_to_bodies(const LaneBodies& bodies, const Vector& impulse, const Vector& moment_a,
                   const Vector& moment_b, const Mask& on, const Mask& marked, BodySum* sums) {
  HalfLine first_a[lane_count], first_b[lane_count], second_a[lane_count], second_b[lane_count];
  const unsigned those = lane_bits(on), changes = lane_bits(marked);
  const Lanes none{};
  const Vector reverse = Vector{none, none, none} - impulse;
  half_lines({reverse.x, reverse.y, reverse.z, turning ? moment_a.x : none}, first_a);
  half_lines({impulse.x, impulse.y, impulse.z, turning ? moment_b.x : none}, first_b);
  if constexpr (turning) {
    const Lanes changed = choose(marked, 1, none);
    half_lines({moment_a.y, moment_a.z, changed, none}, second_a);
    half_lines({moment_b.y, moment_b.z, changed, none}, second_b);
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
    else if (changes >> l & 1)
      a.changed = b.changed = 1;
  }
}

/// How far impulses are carried on along their last change (Nesterov's acceleration, k-th sweep since the
/// last restart: (k - 1) / (k + 2)). Where that led the wrong way it starts anew (O'Donoghue, Candes, Found.
/// Comput. Math. 15 (2015) 715, gradient scheme), each pair for itself.
inline Lanes momentum(Real8& age, const Lanes& led_wrong, const Mask& on) {
  const Lanes before = age, k = choose(led_wrong > 0, 1, before);
  age = choose(on, k + 1, before);
  return choose(on, (k - 1) / (k + 2), 0);
}

/// What the groups of a sweep have found.
class Outcome {
 public:
  template <class Group>
  void add(const Group& g, Lanes relative_change) {
    residual_ = choose(goes_on(g.bodies) & (relative_change > residual_), relative_change, residual_);
    carried_ = carried_ | (Lanes(g.carried) != 0);
    solved_ = true;
  }
  SweepOutcome all() const { return {largest(residual_), solved_, any(carried_)}; }
  /// Where the squares of the changes were added.
  SweepOutcome of_squares() const { return {std::sqrt(largest(residual_)), solved_, any(carried_)}; }

 private:
  Lanes residual_{};
  Mask carried_{};
  bool solved_ = false;
};

/// Tangential impulses brought back into the cone.
inline Vector into_cone(const Vector& q, Lanes limit) {
  const Lanes square = dot(q, q);
  const Mask outside = square > limit * limit;
  if (!any(outside)) return q;  // roots and quotients are what a round waits for
  return choose(outside, q * (limit / square_root(square)), q);
}

}  // namespace
}  // namespace silt::rigid::SILT_ISA
