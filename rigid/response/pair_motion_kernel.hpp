#pragma once
// How the two bodies of a pair move relative to each other while the pair is solved. Only for *_kernel.cpp.
#include "rigid/response/lanes_kernel.hpp"

namespace silt::rigid::SILT_ISA {
namespace {

/// Eight pairs: velocity of b seen from a, at a's centre, and the sums of the impulses given, on b, moments
/// about a's centre.
struct PairMotion {
  Vector u, omega;
  Vector impulse{}, angular{};

  PairMotion(const BlockGroup& g, const Twist& a, const Twist& b)
      : u(b.v + cross(b.w, load(g.offset)) - a.v), omega(b.w - a.w) {}

  Vector at(const Vector& r) const { return u + cross(omega, r); }

  /// An impulse at r.
  void push(const BlockGroup& g, const Vector& r, const Vector& p) { push_about_a(g, p, cross(r, p)); }
  /// An impulse, and its moment about a's centre: that of one contact, or the sums of some.
  void push_about_a(const BlockGroup& g, const Vector& p, const Vector& about_a) {
    const Vector d = load(g.offset);
    const Vector turn_b = times(g.inverse_inertia_b, about_a + cross(d, p));
    omega += turn_b + times(g.inverse_inertia_a, about_a);
    u += p * g.inverse_mass + cross(turn_b, d);
    impulse += p;
    angular += about_a;
  }
};

inline PairMotion choose(Mask m, const PairMotion& a, const PairMotion& b) {
  PairMotion c = b;
  c.u = choose(m, a.u, b.u);
  c.omega = choose(m, a.omega, b.omega);
  c.impulse = choose(m, a.impulse, b.impulse);
  c.angular = choose(m, a.angular, b.angular);
  return c;
}

}  // namespace
}  // namespace silt::rigid::SILT_ISA
