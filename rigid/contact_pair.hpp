#pragma once
// All contacts of two bodies, solved by themselves: the block of the sFFD sweeps (FFD.md 5.2, 5.3).
// Normals run from a to b, u = v_b - v_a at the contact point, impulses act on b and are reversed on a.
// The solver works in the contacts' own directions, with the matrix that takes their impulses to their
// velocities.
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "rigid/types.hpp"

namespace silt::rigid {

/// One contact point as the solver sees it.
struct ContactRow {
  std::array<Vec3, 3> direction;  // normal and two tangents
  Vec3 r_a, r_b;
  std::array<double, 3> impulse{};  // accumulated, along the directions
  double inverse_k_n = 0,
         inverse_k_t = 0;  // effective masses; k_t: larger eigenvalue of the tangential block
  double target = 0;       // least normal velocity after the step
  double friction = 0;

  const Vec3& normal() const { return direction[0]; }
  Vec3 impulse_W() const {
    return impulse[0] * direction[0] + impulse[1] * direction[1] + impulse[2] * direction[2];
  }
  double tangential_impulse() const { return std::hypot(impulse[1], impulse[2]); }
};

/// The directions of a contact with this normal.
std::array<Vec3, 3> contact_directions(const Vec3& normal);

/// Velocity of a body's centre and its angular velocity.
struct Twist {
  Vec3 v = Vec3::Zero(), w = Vec3::Zero();
  Vec3 at(const Vec3& r) const { return v + w.cross(r); }
};

/// How a body answers an impulse in this pair: its inverse mass and inertia times its number of pairs.
struct SplitMass {
  double inverse_mass = 0;
  Mat3 inverse_inertia = Mat3::Zero();
};

struct PairChange {
  Vec3 impulse = Vec3::Zero();                              // change on b
  Vec3 angular_a = Vec3::Zero(), angular_b = Vec3::Zero();  // sum of r x change, of a (sign as on b) and of b
  double largest = 0;                                       // change of one contact's impulse
  double scale = 0;                                         // largest impulse of a contact
};

/// Doubles that the matrix of a pair takes.
inline std::size_t matrix_size(std::size_t contacts) {
  return 9 * contacts * contacts;
}

/// Fills the effective masses of the rows and the symmetric matrix (3 lines a contact) from impulses to
/// velocities. Returns whether one round of solve_pair is exact: a single contact whose directions do not
/// mix, as of spheres.
bool set_effective_masses(std::span<ContactRow>, const SplitMass& a, const SplitMass& b, double* matrix);

enum class PairLaw {
  single,        // one round is exact
  coulomb,       // Coulomb friction with a circular cone
  frictionless,  // normal impulses only
};

/// Solves the rows from the velocities given, to round-off (stacks vibrate if it is left at less): block
/// Gauss-Seidel.
PairChange solve_pair(std::span<ContactRow>, const double* matrix, const Twist& a, const Twist& b, PairLaw);

}  // namespace silt::rigid
