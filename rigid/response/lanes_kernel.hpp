#pragma once
// Arithmetic on eight pairs at a time, for the contact kernels. Only for *_kernel.cpp: built once an
// instruction set.
#include <cmath>

#include "rigid/response/contact_lanes.hpp"

namespace silt::rigid::SILT_ISA {
namespace {

using Mask = decltype(Real8{} < Real8{});  // all bits of a lane set: true

inline Real8 larger(Real8 a, Real8 b) {
  return a > b ? a : b;
}
inline Real8 square_root(Real8 x) {
  Real8 root;
  for (int l = 0; l < lane_count; ++l) root[l] = std::sqrt(x[l]);
  return root;
}
inline bool any(Mask m) {
  long long bits = 0;
  for (int l = 0; l < lane_count; ++l) bits |= m[l];
  return bits != 0;
}
/// The largest of the lanes.
inline double largest(Real8 x) {
  double most = x[0];
  for (int l = 1; l < lane_count; ++l) most = x[l] > most ? x[l] : most;
  return most;
}

struct Vector {
  Real8 x, y, z;

  Vector operator+(const Vector& o) const { return {x + o.x, y + o.y, z + o.z}; }
  Vector operator-(const Vector& o) const { return {x - o.x, y - o.y, z - o.z}; }
  Vector operator*(Real8 s) const { return {s * x, s * y, s * z}; }
  Vector& operator+=(const Vector& o) { return *this = *this + o; }
  Vector& operator-=(const Vector& o) { return *this = *this - o; }
};
inline Real8 dot(const Vector& a, const Vector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vector choose(Mask m, const Vector& a, const Vector& b) {
  return {m ? a.x : b.x, m ? a.y : b.y, m ? a.z : b.z};
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
inline LanesToSolve to_solve(const LaneBodies& bodies, Real8 carried, const BodyState* state,
                             const ContactSweep& sweep) {
  LanesToSolve lanes;
  const bool first = sweep.number == 1;
  for (int l = 0; l < lane_count; ++l) {
    const bool woken = bodies.again[l] && (state[bodies.a[l]].number != 0 || state[bodies.b[l]].number != 0);
    lanes.on[l] = first || woken || carried[l] != 0 ? -1 : 0;
    lanes.to_carry[l] = bodies.again[l] && (first || woken) && !sweep.plain ? -1 : 0;
  }
  return lanes;
}

/// Velocity and angular velocity of eight bodies.
struct Twist {
  Vector v, w;

  Twist(const std::int32_t* rows, const BodyState* state) {
    for (int l = 0; l < lane_count; ++l) {
      const BodyState& s = state[rows[l]];
      v.x[l] = s.v[0];
      v.y[l] = s.v[1];
      v.z[l] = s.v[2];
      w.x[l] = s.w[0];
      w.y[l] = s.w[1];
      w.z[l] = s.w[2];
    }
  }
};

/// How far impulses are carried on along their last change (Nesterov's acceleration, k-th sweep since the
/// last restart: (k - 1) / (k + 2)). Where that led the wrong way it starts anew (O'Donoghue, Candes, Found.
/// Comput. Math. 15 (2015) 715, gradient scheme), each pair for itself.
inline Real8 momentum(Real8& age, Real8 led_wrong, Mask on) {
  const Mask restart = led_wrong > 0;
  const Real8 one = age * 0 + 1, k = restart ? one : age;
  age = on ? k + 1 : age;
  return on ? (k - 1) / (k + 2) : Real8{};
}
inline Mask goes_on(const LaneBodies& bodies) {
  Mask on;
  for (int l = 0; l < lane_count; ++l) on[l] = bodies.again[l] ? -1 : 0;
  return on;
}

/// What the groups of a sweep have found.
class Outcome {
 public:
  template <class Group>
  void add(const Group& g, Real8 relative_change) {
    residual_ = goes_on(g.bodies) & (relative_change > residual_) ? relative_change : residual_;
    carried_ = carried_ | (g.carried != 0);
    solved_ = true;
  }
  SweepOutcome all() const { return {largest(residual_), solved_, any(carried_)}; }

 private:
  Real8 residual_{};
  Mask carried_{};
  bool solved_ = false;
};

/// Tangential impulses brought back into the cone.
inline Vector into_cone(const Vector& q, Real8 limit) {
  const Real8 square = dot(q, q);
  const Mask outside = square > limit * limit;
  if (!any(outside)) return q;  // roots and quotients are what a round waits for
  return choose(outside, q * (limit / square_root(square)), q);
}

}  // namespace
}  // namespace silt::rigid::SILT_ISA
