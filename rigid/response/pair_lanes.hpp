#pragma once
// Arranges the pairs of a step in groups for the sweeps (contact_lanes.hpp), and runs the sweeps.
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/response/contact_lanes.hpp"
#include "rigid/response/warm_start.hpp"

namespace silt::rigid {

/// The mobility of a body; zeros for infinite mass.
struct BodyMass {
  double inverse_mass = 0;
  LockedAxes locked = 0;                // axes along which the mass is infinite
  Mat3 inverse_inertia = Mat3::Zero();  // W
  bool isotropic = true;                // the same inertia about every axis (or infinite)
  bool turns = false;                   // may have an angular velocity
};

/// A pair to be added. It acts on each body with the body's mass divided by `share`.
struct PairToSolve {
  std::size_t row_a, row_b;
  std::span<const Contact> contacts;
  std::span<const ContactImpulse> impulses;  // initial values
  std::span<const double> targets;
  const BodyMass &a, &b;
  double share_a, share_b;
  double dt;
  double least_scale;                 // smaller impulses are rounding
  bool again;                         // false: no other pair moves its bodies, so one sweep is exact
  const Material* rolling = nullptr;  // set if it resists rolling or twisting
  Vec3 together = Vec3::Zero();       // relative velocity of b at which the contacts do not move; targets and
                                      // friction are relative to it (contact_targets.hpp)
};

class PairLanes {
 public:
  enum class Kind : std::uint8_t { block, central, rolling, lubricated };
  struct Place {
    std::uint32_t group;
    std::uint8_t lane;
    Kind kind;
  };

  /// Removes all pairs. rows: of the BodySet; state and sums have one more row, at rest, for unused lanes.
  void clear(std::size_t rows);
  /// Adds a pair. Call in the order of the pairs' keys.
  Place add(const PairToSolve&);
  /// Call after the last pair and before the first sweep.
  void prepare();
  /// Sweeps all pairs once from the same velocities. Adds to the bodies' sums in an order that depends on
  /// keys only, and marks bodies of pairs whose relative change exceeds the tolerance.
  SweepOutcome sweep(std::span<const BodyState>, std::span<BodySum>, const ContactSweep&);

  void read_impulses(const Place&, std::span<ContactImpulse>);
  /// The impulse against rolling, of a film or friction, on b, with its moment about a's centre.
  struct Rolling {
    Vec3 impulse = Vec3::Zero(), moment = Vec3::Zero();
  };
  Rolling read_rolling(const Place&) const;
  /// Restarts for the position correction: zero impulses, no friction, new targets for the pair's contacts.
  void aim(const Place&, std::span<const double> targets, double least_scale);

 private:
  Place add_central(const PairToSolve&);
  Place add_rolling(const PairToSolve&);
  Place add_lubricated(const PairToSolve&);
  Place add_block(const PairToSolve&);
  void add_block_contact(BlockContact&, int lane, const PairToSolve&, std::size_t k);
  void sum_blocks(std::span<BodySum>, double tolerance) const;
  PairGroup& group_at(const Place&);
  LaneContact& contact_at(const Place&, std::size_t k);

  std::size_t rows_ = 0;
  // the next free lane of the last group
  int central_lane_ = lane_count, rolling_lane_ = lane_count, lubricated_lane_ = lane_count;
  std::vector<CentralGroup> central_;
  std::vector<RollingGroup> rolling_;
  std::vector<LubricatedGroup> lubricated_;
  std::vector<BlockGroup> blocks_;
  std::vector<BlockContact> block_contacts_;
  std::vector<BlockLubrication> block_lubrication_;
  std::vector<BlockRolling> block_rolling_;
  struct Open {
    std::uint32_t group;
    int lane = lane_count;
  };
  std::vector<Open> open_;          // the group being filled, by number and kind of contacts
  std::vector<Place> block_order_;  // in the order added
};

/// Returns [r]x m [r]x without the products with zeros.
inline Mat3 crossed_on_both_sides(const Vec3& r, const Mat3& m) {
  Mat3 crossed, both;
  for (int column = 0; column < 3; ++column) crossed.col(column) = r.cross(m.col(column));
  for (int row = 0; row < 3; ++row) both.row(row) = crossed.row(row).cross(r.transpose());
  return both;
}

/// Returns the sum of both bodies' inverse masses along each axis.
inline Vec3 inverse_masses(const PairToSolve& p) {
  const double a = p.share_a * p.a.inverse_mass, b = p.share_b * p.b.inverse_mass;
  if (!p.a.locked && !p.b.locked) return Vec3::Constant(a + b);
  return without_locked(p.a.locked, Vec3::Constant(a)) + without_locked(p.b.locked, Vec3::Constant(b));
}

/// Returns the relative velocity at the contact per unit impulse there.
inline Mat3 compliance(const PairToSolve& p, const Contact& c) {
  return Mat3(inverse_masses(p).asDiagonal()) -
         crossed_on_both_sides(c.r_a, p.share_a * p.a.inverse_inertia) -
         crossed_on_both_sides(c.r_b, p.share_b * p.b.inverse_inertia);
}

/// Returns the larger eigenvalue of k in the plane normal to n, given k_n = k n.
inline double tangential_eigenvalue(const Mat3& k, const Vec3& n, const Vec3& k_n) {
  const double normal = n.dot(k_n), sum = k.trace() - normal;
  const double squares = k.squaredNorm() - 2 * k_n.squaredNorm() + normal * normal;
  return 0.5 * (sum + std::sqrt(std::max(0.0, 2 * squares - sum * sum)));
}

/// Returns the inverse of a compliance; 0 for zero compliance.
inline double inverse(double k) {
  return k > 0 ? 1 / k : 0;
}

/// Returns the fraction of a velocity of compliance k removed by a resistance z (impulse per velocity).
inline double damped(double z, double k) {
  return z * k / (1 + z * k);
}

}  // namespace silt::rigid
