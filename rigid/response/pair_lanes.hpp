#pragma once
// Lays the pairs of a step out for the sweeps (contact_lanes.hpp), and runs them.
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "cpu/isa.hpp"
#include "rigid/bodies/contact.hpp"
#include "rigid/response/contact_lanes.hpp"
#include "rigid/response/warm_start.hpp"

namespace silt::rigid {

/// A body answers an impulse by these numbers; they are zeros for infinite mass.
struct BodyMass {
  double inverse_mass = 0;
  LockedAxes locked = 0;                // along which it is infinite
  Mat3 inverse_inertia = Mat3::Zero();  // W
  bool isotropic = true;                // the same about every axis (or infinite)
  bool turns = false;                   // may have an angular velocity
};

/// One pair as it is to be laid out. Of either body the pair has the mass divided by `share` to itself.
struct PairToSolve {
  std::size_t row_a, row_b;
  std::span<const Contact> contacts;
  std::span<const ContactImpulse> impulses;  // to start from
  std::span<const double> targets;
  const BodyMass &a, &b;
  double share_a, share_b;
  double dt;
  double least_scale;                 // impulses below are rounding
  bool again;                         // false: one sweep is exact, nothing else moves its bodies
  const Material* rolling = nullptr;  // that resists rolling or twisting
  Vec3 together = Vec3::Zero();       // velocity, of b seen from a, that is none to the contacts: targets and
                                      // friction are besides it (contact_targets.hpp)
};

class PairLanes {
 public:
  enum class Kind : std::uint8_t { block, central, rolling, lubricated };
  struct Place {
    std::uint32_t group;
    std::uint8_t lane;
    Kind kind;
  };

  /// Forgets all pairs. rows: of the BodySet; state and sums have one more, at rest, for unused lanes.
  void clear(std::size_t rows);
  /// Call in the order of the pairs' keys.
  Place add(const PairToSolve&);
  /// Must be called after the last pair, before the first sweep.
  void prepare();
  /// One sweep of all pairs from the same velocities. Adds to the bodies' sums in an order
  /// that only the keys decide, and marks a body as changed where a relative change exceeds the tolerance.
  SweepOutcome sweep(std::span<const BodyState>, std::span<BodySum>, const ContactSweep&);

  void read_impulses(const Place&, std::span<ContactImpulse>);
  /// A film or friction acts on b against rolling by an impulse, and by its moment about a's centre.
  struct Rolling {
    Vec3 impulse = Vec3::Zero(), moment = Vec3::Zero();
  };
  Rolling read_rolling(const Place&) const;
  /// Starts over for the position correction: zero impulses, no friction, the target of each contact of the
  /// pair.
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
  // the next free one of the last group
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
  std::vector<Open> open_;          // the group being filled, by number of contacts and what they have
  std::vector<Place> block_order_;  // as added
};

/// [r]x m [r]x, without the products by zero.
inline Mat3 crossed_on_both_sides(const Vec3& r, const Mat3& m) {
  Mat3 crossed, both;
  for (int column = 0; column < 3; ++column) crossed.col(column) = r.cross(m.col(column));
  for (int row = 0; row < 3; ++row) both.row(row) = crossed.row(row).cross(r.transpose());
  return both;
}

/// Returns the inverse masses of both bodies together, along each axis.
inline Vec3 inverse_masses(const PairToSolve& p) {
  const double a = p.share_a * p.a.inverse_mass, b = p.share_b * p.b.inverse_mass;
  if (!p.a.locked && !p.b.locked) return Vec3::Constant(a + b);
  return without_locked(p.a.locked, Vec3::Constant(a)) + without_locked(p.b.locked, Vec3::Constant(b));
}

/// Relative velocity at the contact by a unit impulse there.
inline Mat3 compliance(const PairToSolve& p, const Contact& c) {
  return Mat3(inverse_masses(p).asDiagonal()) -
         crossed_on_both_sides(c.r_a, p.share_a * p.a.inverse_inertia) -
         crossed_on_both_sides(c.r_b, p.share_b * p.b.inverse_inertia);
}

/// The larger eigenvalue of k between directions across n, k n being k_n.
inline double tangential_eigenvalue(const Mat3& k, const Vec3& n, const Vec3& k_n) {
  const double normal = n.dot(k_n), sum = k.trace() - normal;
  const double squares = k.squaredNorm() - 2 * k_n.squaredNorm() + normal * normal;
  return 0.5 * (sum + std::sqrt(std::max(0.0, 2 * squares - sum * sum)));
}

/// The inverse of the compliance of a motion; of one that nothing moves 0.
inline double inverse(double k) {
  return k > 0 ? 1 / k : 0;
}

/// Share of a velocity of compliance k that a resistance takes away; impulse z per velocity.
inline double damped(double z, double k) {
  return z * k / (1 + z * k);
}

}  // namespace silt::rigid
