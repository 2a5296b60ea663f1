#pragma once
// The data the sweeps of sffd read and write: pairs of bodies side by side, eight in a group, so that one
// vector instruction works on all of them. In a sweep no pair sees another's result (Jacobi), so which pairs
// share a group changes no bit. No Eigen: the kernels are built for several
// instruction sets.
//
// Normals run from a to b, u = v_b - v_a at the contact, impulses act on b and are reversed on a.
#include <cstddef>
#include <cstdint>

namespace silt::rigid {

inline constexpr int lane_count = 8;
/// One number of each of eight pairs. A vector type, whatever the width of the machine's own.
using Lanes = double __attribute__((vector_size(lane_count * sizeof(double))));

/// A body as the sweeps see it: one cache line.
struct alignas(64) BodyState {
  double v[3], w[3];
  double number;  // travels with it: before the first sweep its number of pairs, then whether it changed
  double unused;
};

/// What the pairs of one sweep do to a body.
struct alignas(64) BodySum {
  double impulse[3], angular[3];
  double changed;
  double unused;
};

/// Which bodies: rows of the BodySet; unused lanes point one past the last row.
struct LaneBodies {
  std::int32_t a[lane_count], b[lane_count];
  std::int32_t again[lane_count];  // 0: final after the first sweep
};

/// Pairs that touch in one point on the line of centres of bodies that turn alike about every axis (or do not
/// turn): normal, friction and rotation do not mix, so one pass over the contact is exact. Spheres, mostly.
struct alignas(64) CentralGroup {
  Lanes normal[3];
  Lanes normal_impulse, tangential_impulse[3];
  Lanes last_normal, last_tangential[3];  // what the last sweep found, before it was carried on
  Lanes age;                              // sweeps since the impulses were last carried too far
  Lanes carried;                          // by what part of their last change they were carried on
  Lanes target;                           // least normal velocity after the step
  Lanes friction;                         // coefficient
  Lanes inverse_k_n, inverse_k_t;
  Lanes arm_a, arm_b;  // the contact lies at arm * normal from each centre
  Lanes least_scale;   // impulses below are rounding
  LaneBodies bodies;
};

/// The same with a viscous film in the gap (film.hpp). Of a resistance z, as an impulse per velocity, against
/// the compliance k of its motion: damped is z k / (1 + z k), the part of the velocity it takes away.
struct alignas(64) FilmGroup : CentralGroup {
  Lanes normal_stiffness;  // 1 + z k
  Lanes normal_damped, tangential_damped;
  Lanes skew;                   // alpha of film.hpp
  Lanes reach_a, reach_b;       // A and B there
  Lanes roll_gain, roll_keeps;  // z / (1 + z k), z k / (1 + z k)
  Lanes roll_to_slip;           // slip by a unit impulse against rolling, and the reverse
  Lanes rolling_impulse[3], last_rolling[3];
};

/// Any other pairs, as many contacts in each lane of a group. Moments are taken about a's centre.
struct alignas(64) BlockGroup {
  Lanes offset[3];                                   // from b's centre to a's
  Lanes inverse_mass;                                // of both together
  Lanes inverse_inertia_a[6], inverse_inertia_b[6];  // xx, yy, zz, xy, xz, yz
  Lanes inverse_arm;                                 // of the furthest contact from a's centre
  Lanes least_scale;
  Lanes
      inverse_mobility[21];  // of the relative motion (packed(i, j)), times `softness`; set by prepare_blocks
  Lanes softness;            // of the trial in which all stick
  Lanes impulse[3], angular[3];  // of the last sweep, on b about a's centre
  Lanes age, carried;            // as in CentralGroup
  Lanes relative_change;         // of the last sweep; negative: not solved
  LaneBodies bodies;
  std::uint32_t first, count;  // of its contacts
  std::uint32_t films;         // where its contacts' films begin; none: no_films
};

inline constexpr std::uint32_t no_films = ~std::uint32_t{0};

struct alignas(64) BlockContact {
  Lanes r[3];  // from a's centre
  Lanes normal[3];
  Lanes k_normal[3];  // velocity there by a unit normal impulse
  Lanes normal_impulse, tangential_impulse[3];
  Lanes last_normal, last_tangential[3];
  Lanes target, friction, inverse_k_n, inverse_k_t;
};

/// Of one BlockContact; as in FilmGroup. Rolling is left out.
struct alignas(64) BlockFilm {
  Lanes normal_stiffness, normal_damped, tangential_damped;
};

/// How the groups are swept.
struct Sweep {
  int number;        // from 1; the first solves every pair, later ones those of which a body changed
  bool plain;        // not accelerated: impulses stay as found
  bool push;         // position correction: solved less exactly
  double tolerance;  // a relative change above it marks both bodies as changed
};

// The kernels. A sweep goes once over its groups and returns the largest relative change of a pair that is
// not final; blocks are prepared once a step, after the groups are filled.
using SweepCentral = double(CentralGroup*, std::size_t groups, const BodyState*, BodySum*, const Sweep&);
using SweepFilms = double(FilmGroup*, std::size_t groups, const BodyState*, BodySum*, const Sweep&);
using SweepBlocks = double(BlockGroup*, std::size_t groups, BlockContact*, const BlockFilm*, const BodyState*,
                           const Sweep&);
using PrepareBlocks = void(BlockGroup*, std::size_t groups);

namespace portable {
SweepCentral sweep_central;
SweepFilms sweep_films;
SweepBlocks sweep_blocks;
PrepareBlocks prepare_blocks;
}  // namespace portable
namespace avx2 {
SweepCentral sweep_central;
SweepFilms sweep_films;
SweepBlocks sweep_blocks;
PrepareBlocks prepare_blocks;
}  // namespace avx2
namespace avx512 {
SweepCentral sweep_central;
SweepFilms sweep_films;
SweepBlocks sweep_blocks;
PrepareBlocks prepare_blocks;
}  // namespace avx512

}  // namespace silt::rigid
