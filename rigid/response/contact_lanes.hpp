#pragma once
// The data the sweeps of sffd read and write: pairs of bodies side by side, eight in a group, so that one
// vector instruction works on all of them. In a sweep no pair sees another's result (Jacobi), so which pairs
// share a group changes no bit. No Eigen: the kernels are built for several instruction sets.
//
// Normals run from a to b, u = v_b - v_a at the contact, impulses act on b and are reversed on a.
#include <cstdint>
#include <span>

#include "cpu/isa.hpp"

namespace silt::rigid {

inline constexpr int lane_count = 8;
/// One number of each of eight pairs. The kernels compute with Registers of them (cpu/lanes.hpp).
struct alignas(64) Real8 {
  double lane[lane_count];

  double& operator[](int l) { return lane[l]; }
  double operator[](int l) const { return lane[l]; }
  template <class Numbers>
  requires requires(const Numbers& x, double* to) { x.store(to); }
  Real8& operator=(const Numbers& x) {
    x.store(lane);
    return *this;
  }
};

/// The sweeps see a body as one cache line.
struct alignas(64) BodyState {
  double v[3], w[3];
  double number;  // travels with it: before the first sweep its number of pairs, then whether it changed
  double unused;
};

/// This is what the pairs of one sweep do to a body.
struct alignas(64) BodySum {
  double impulse[3], angular[3];
  double changed;  // above 0 if a pair did more than rounding
  double unused;
};

/// The bodies are given as rows of the BodySet; unused lanes point one past the last row.
struct LaneBodies {
  std::int32_t a[lane_count], b[lane_count];
  std::int32_t again[lane_count];  // 0: final after the first sweep
};

/// All groups hold pairs side by side.
struct PairGroup {
  Real8 age;          // sweeps since the impulses were last carried too far
  Real8 carried;      // by what part of their last change they were carried on
  Real8 least_scale;  // impulses below are rounding
  LaneBodies bodies;
};

/// One contact of each of eight pairs.
struct LaneContact {
  Real8 normal[3];
  Real8 normal_impulse, tangential_impulse[3];
  Real8 last_normal, last_tangential[3];  // what the last sweep found, before it was carried on
  Real8 target;                           // least normal velocity after the step
  Real8 friction;                         // coefficient
  Real8 inverse_k_n, inverse_k_t;
};

/// A CentralGroup holds pairs that touch in one point on the line of centres of bodies that turn alike about
/// every axis (or do not turn): normal, friction and rotation do not mix, so one pass over the contact is
/// exact. Spheres, mostly.
struct alignas(64) CentralGroup : PairGroup, LaneContact {
  Real8 arm_a, arm_b;  // the contact lies at arm * normal from each centre
};

/// These pairs have moments against rolling and twisting too, as impulses: `rolling_impulse` times `roll_arm`
/// is a moment on b. Rolling is seen as the velocity that the bodies' turning gives at that arm.
struct alignas(64) RollingGroup : CentralGroup {
  Real8 roll_arm, rolling_friction, twisting_friction;
  Real8 inverse_k_roll, inverse_k_roll_stuck;  // the latter where slip takes what impulse it needs
  Real8 roll_to_slip;                          // slip by a unit impulse against rolling, and the reverse
  Real8 rolling_impulse[3], last_rolling[3];
};

/// These pairs have a lubrication film in the gap (lubrication.hpp). A resistance z, as an impulse per
/// velocity, acts against the compliance k of its motion: damped is z k / (1 + z k), the part of the velocity
/// it takes away.
struct alignas(64) LubricatedGroup : CentralGroup {
  Real8 normal_stiffness;  // 1 + z k
  Real8 together;          // the normal velocity that leaves the gap as it is; not 0 where bodies cohere
  Real8 normal_damped, tangential_damped;
  Real8 skew;                   // alpha of lubrication.hpp
  Real8 reach_a, reach_b;       // A and B there; at a wall, of arm R, 2 A - R: as seen from it where it turns
  Real8 roll_gain, roll_keeps;  // z / (1 + z k), z k / (1 + z k)
  Real8 roll_to_slip;           // slip by a unit impulse against rolling, and the reverse
  Real8 rolling_impulse[3], last_rolling[3];
};

/// A group holds any other pairs, as many contacts in each lane of a group. Moments are taken about a's
/// centre.
struct alignas(64) BlockGroup : PairGroup {
  Real8 offset[3];                                   // from b's centre to a's
  Real8 together[3];                                 // velocity of b seen from a that is none to the contacts
  Real8 inverse_mass[3];                             // of both together, along each axis
  Real8 inverse_inertia_a[6], inverse_inertia_b[6];  // xx, yy, zz, xy, xz, yz
  Real8 inverse_arm;                                 // of the furthest contact from a's centre
  Real8 inverse_mobility[21];    // of the relative motion (packed(i, j)), times `softness`; by prepare_blocks
  Real8 softness;                // of the trial in which all stick
  Real8 impulse[3], angular[3];  // of the last sweep, on b about a's centre
  Real8 relative_change;         // of the last sweep; negative: not solved
  std::uint32_t first, count;    // of its contacts
  std::uint32_t first_lubrication, first_rolling;  // where those of its contacts begin; none: without
};

inline constexpr std::uint32_t without = ~std::uint32_t{0};

struct alignas(64) BlockContact : LaneContact {
  Real8 r[3];         // from a's centre
  Real8 k_normal[3];  // velocity there by a unit normal impulse
};

/// This is the lubrication of one BlockContact, as in LubricatedGroup. Rolling is left out.
struct alignas(64) BlockLubrication {
  Real8 normal_stiffness, normal_damped, tangential_damped;
};

/// The resistance against rolling and twisting at one BlockContact, as in RollingGroup.
struct alignas(64) BlockRolling {
  Real8 roll_arm, rolling_friction, twisting_friction, inverse_k_roll;
  Real8 impulse[3];
};

/// A ContactSweep says how the groups are swept.
struct ContactSweep {
  int number;        // from 1; the first solves every pair, later ones those of which a body changed
  bool plain;        // not accelerated: all impulses stay as found
  bool push;         // position correction: solved less exactly
  double tolerance;  // a relative change above it marks both bodies as changed
};

struct SweepOutcome {
  double residual = 0;   // largest relative change of a pair that is not final
  bool solved = false;   // any pair
  bool carried = false;  // some impulses have been carried on: the next sweep has to solve for them
};

// The kernels. A sweep goes once over its groups; blocks are prepared once a step, after the groups are
// filled.
using SweepCentral = SweepOutcome(std::span<CentralGroup>, const BodyState*, BodySum*, const ContactSweep&);
using SweepRolling = SweepOutcome(std::span<RollingGroup>, const BodyState*, BodySum*, const ContactSweep&);
using SweepLubricated = SweepOutcome(std::span<LubricatedGroup>, const BodyState*, BodySum*,
                                     const ContactSweep&);
using SweepBlocks = SweepOutcome(std::span<BlockGroup>, BlockContact*, const BlockLubrication*, BlockRolling*,
                                 const BodyState*, const ContactSweep&);
using PrepareBlocks = void(std::span<BlockGroup>);

SILT_BUILDS(SweepCentral sweep_central; SweepRolling sweep_rolling; SweepLubricated sweep_lubricated;
            SweepBlocks sweep_blocks; PrepareBlocks prepare_blocks;)

}  // namespace silt::rigid
