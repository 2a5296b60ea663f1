#pragma once
// All contacts of two bodies, solved by themselves: the block of the sFFD sweeps (FFD.md 5.2, 5.3).
// Normals run from a to b, u = v_b - v_a at the contact point, impulses act on b and are reversed on a.
#include <span>
#include <vector>

#include "rigid/types.hpp"

namespace silt::rigid {

/// One contact point as the solver sees it.
struct ContactRow {
  Vec3 normal, r_a, r_b;
  double inverse_k_n = 0, inverse_k_t = 0;  // effective masses; k_t: larger eigenvalue of the tangential block
  double target = 0;                        // least normal velocity after the step
  double friction = 0;
  double p_n = 0;                   // accumulated impulses
  Vec3 p_t = Vec3::Zero();

  Vec3 impulse() const { return p_n * normal + p_t; }
};

/// Velocity of a body's centre and its angular velocity.
struct Twist {
  Vec3 v = Vec3::Zero(), w = Vec3::Zero();
  Vec3 at(const Vec3& r) const { return v + w.cross(r); }
};

/// How a body answers an impulse in this pair: its inverse mass and inertia times its number of pairs.
struct SplitMass {
  double inverse_mass = 0;
  Mat3 inverse_inertia = Mat3::Zero();

  void push(Twist& t, const Vec3& r, const Vec3& impulse) const {
    t.v += inverse_mass * impulse;
    t.w += inverse_inertia * r.cross(impulse);
  }
};

struct PairChange {
  Vec3 impulse = Vec3::Zero();                               // change on b
  Vec3 angular_a = Vec3::Zero(), angular_b = Vec3::Zero();   // sum of r x change, of a (sign as on b) and of b
  double largest = 0;                                        // change of one contact's impulse
  double scale = 0;                                          // largest impulse of a contact
};

/// Fills the effective masses of the rows. Returns whether one round of solve_pair is exact: a single contact whose
/// normal and tangential directions do not mix, as of spheres.
bool set_effective_masses(std::span<ContactRow>, const SplitMass& a, const SplitMass& b);

/// Block Gauss-Seidel over the rows from the velocities given, until nothing changes. Coulomb friction with a
/// circular cone; with `frictionless` normal impulses only.
PairChange solve_pair(std::span<ContactRow>, const SplitMass& a, const SplitMass& b, Twist twist_a, Twist twist_b,
                      bool one_round, bool frictionless);

}  // namespace silt::rigid
