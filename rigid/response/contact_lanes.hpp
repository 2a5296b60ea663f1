#pragma once
// The data of sffd's sweeps: pairs of bodies side by side in groups of eight, for vector instructions. In a
// sweep no pair sees another's result (Jacobi), so the grouping has no influence on results. Without Eigen,
// since the kernels are built for several instruction sets.
//
// Normals point from a to b, u = v_b - v_a at the contact; impulses act on b and, reversed, on a.
#include <cstdint>
#include <span>

#include "cpu/isa.hpp"

namespace silt::rigid {

inline constexpr int lane_count = 8;
/// One number for each of eight pairs. The kernels compute with Registers of them (cpu/lanes.hpp).
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

/// The velocities of a body, in one cache line.
struct alignas(64) BodyState {
  double v[3], w[3];
  double number;  // sent with them: first the number of pairs, later whether the body has changed
  double unused;
};

/// The sum of what the pairs of a sweep apply to a body.
struct alignas(64) BodySum {
  double impulse[3], angular[3];
  double changed;  // > 0 if a pair's change exceeded the tolerance
  double unused;
};

/// Rows of the pairs' bodies in the BodySet; unused lanes have the row after the last.
struct LaneBodies {
  std::int32_t a[lane_count], b[lane_count];
  std::int32_t again[lane_count];  // 0: exact after the first sweep
};

/// Members common to all groups.
struct PairGroup {
  Real8 age;          // sweeps since the last restart of the acceleration
  Real8 carried;      // factor by which the last change of the impulses was extrapolated
  Real8 least_scale;  // smaller impulses are rounding
  LaneBodies bodies;
};

/// A contact of each of eight pairs.
struct LaneContact {
  Real8 normal[3];
  Real8 normal_impulse, tangential_impulse[3];
  Real8 last_normal, last_tangential[3];  // impulses found by the last sweep, before extrapolation
  Real8 target;                           // least normal velocity after the step
  Real8 friction;                         // coefficient
  Real8 inverse_k_n, inverse_k_t;
};

/// Pairs with one contact on the line of centres of bodies that have isotropic inertia or cannot rotate,
/// mostly spheres. Normal impulse, friction and rotation do not couple: one pass is exact.
struct alignas(64) CentralGroup : PairGroup, LaneContact {
  Real8 arm_a, arm_b;  // the contact is at arm * normal from each centre
};

/// Central pairs with moments against rolling and twisting, stored as impulses: the moment on b is
/// `rolling_impulse` times `roll_arm`. The rolling velocity is the relative angular velocity times that arm.
struct alignas(64) RollingGroup : CentralGroup {
  Real8 roll_arm, rolling_friction, twisting_friction;
  Real8 inverse_k_roll, inverse_k_roll_stuck;  // the latter where the contact sticks
  Real8 roll_to_slip;                          // slip velocity per unit rolling impulse, and the reverse
  Real8 rolling_impulse[3], last_rolling[3];
};

/// Central pairs with a lubrication film (lubrication.hpp). A resistance z, as impulse per velocity, acts on
/// a motion of compliance k: damped = z k / (1 + z k) is the fraction of the velocity it removes.
struct alignas(64) LubricatedGroup : CentralGroup {
  Real8 normal_stiffness;  // 1 + z k
  Real8 together;          // normal velocity at which the gap is constant; not 0 for cohesive pairs
  Real8 normal_damped, tangential_damped;
  Real8 skew;                   // (A - B) / (A + B); at a wall -1
  Real8 reach_a, reach_b;       // A = arm_a, B = -arm_b; at a wall the latter is 2 A + B
  Real8 roll_gain, roll_keeps;  // z / (1 + z k), z k / (1 + z k)
  Real8 roll_to_slip;           // slip velocity per unit rolling impulse, and the reverse
  Real8 rolling_impulse[3], last_rolling[3];
};

/// All other pairs, with the same number of contacts in each lane of a group. Moments are about a's centre.
struct alignas(64) BlockGroup : PairGroup {
  Real8 offset[3];        // from b's centre to a's
  Real8 together[3];      // relative velocity of b at which the contacts do not move
  Real8 inverse_mass[3];  // sum of both bodies', along each axis
  Real8 inverse_inertia_a[6], inverse_inertia_b[6];  // xx, yy, zz, xy, xz, yz
  Real8 inverse_arm;                                 // of the contact furthest from a's centre
  Real8 inverse_mobility[21];    // of the relative motion (packed(i, j)), times `softness`; by prepare_blocks
  Real8 softness;                // of the trial in which all contacts stick
  Real8 impulse[3], angular[3];  // of the last sweep, on b about a's centre
  Real8 relative_change;         // of the last sweep; negative: not solved
  std::uint32_t first, count;    // contacts
  std::uint32_t first_lubrication, first_rolling;  // where the data of its contacts begin, or `without`
};

inline constexpr std::uint32_t without = ~std::uint32_t{0};

struct alignas(64) BlockContact : LaneContact {
  Real8 r[3];         // from a's centre
  Real8 k_normal[3];  // velocity at the contact per unit normal impulse
};

/// The lubrication film of a BlockContact, as in LubricatedGroup but without rolling.
struct alignas(64) BlockLubrication {
  Real8 normal_stiffness, normal_damped, tangential_damped;
  Real8 normal_held, tangential_held;  // z where k is 0, between bodies that locked axes hold; else 0
};

/// The moments against rolling and twisting of a BlockContact, as in RollingGroup.
struct alignas(64) BlockRolling {
  Real8 roll_arm, rolling_friction, twisting_friction, inverse_k_roll;
  Real8 impulse[3];
};

/// Parameters of a sweep.
struct ContactSweep {
  int number;        // from 1; the first solves every pair, later ones the pairs of bodies that have changed
  bool plain;        // without acceleration
  bool push;         // position correction, with a larger tolerance
  double tolerance;  // a larger relative change marks both bodies as changed
};

struct SweepOutcome {
  double residual = 0;   // largest relative change of a pair that needs further sweeps
  bool solved = false;   // whether any pair was solved
  bool carried = false;  // whether impulses were extrapolated, so that the next sweep must solve again
};

// The kernels. A sweep visits its groups once; prepare_blocks runs once a step, after the groups are filled.
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
