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
inline LanesToSolve to_solve(const LaneBodies& bodies, const Real8& carried, const BodyState* state,
                             const ContactSweep& sweep) {
  LanesToSolve lanes;
  const bool first = sweep.number == 1;
  const Mask all = mask_of([&](int) { return first; });
  const Mask goes_on = mask_of([&](int l) { return bodies.again[l]; });
  const Mask woken = goes_on & mask_of([&](int l) {
                       return state[bodies.a[l]].number != 0 || state[bodies.b[l]].number != 0;
                     });
  const Mask carries = mask_of([&](int) { return !sweep.plain; });
  lanes.on = all | woken | (Lanes(carried) != 0);
  lanes.to_carry = goes_on & (all | woken) & carries;
  return lanes;
}

/// Velocity and angular velocity of eight bodies.
struct Twist {
  Vector v, w;

  Twist(const std::int32_t* rows, const BodyState* state) {
    const auto one = [&](auto of) { return gathered([&](int l) { return of(state[rows[l]]); }); };
    v = {one([](const BodyState& s) { return s.v[0]; }), one([](const BodyState& s) { return s.v[1]; }),
         one([](const BodyState& s) { return s.v[2]; })};
    w = {one([](const BodyState& s) { return s.w[0]; }), one([](const BodyState& s) { return s.w[1]; }),
         one([](const BodyState& s) { return s.w[2]; })};
  }
};

/// How far impulses are carried on along their last change (Nesterov's acceleration, k-th sweep since the
/// last restart: (k - 1) / (k + 2)). Where that led the wrong way it starts anew (O'Donoghue, Candes, Found.
/// Comput. Math. 15 (2015) 715, gradient scheme), each pair for itself.
inline Lanes momentum(Real8& age, const Lanes& led_wrong, const Mask& on) {
  const Lanes before = age, k = choose(led_wrong > 0, 1, before);
  age = choose(on, k + 1, before);
  return choose(on, (k - 1) / (k + 2), 0);
}
inline Mask goes_on(const LaneBodies& bodies) {
  return mask_of([&](int l) { return bodies.again[l]; });
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
