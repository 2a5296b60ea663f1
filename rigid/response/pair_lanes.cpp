#include "rigid/response/pair_lanes.hpp"

#include <array>

namespace silt::rigid {
namespace {

/// The kernels built for this processor.
struct LaneKernels {
  SweepCentral* sweep_central = SILT_CHOSEN(sweep_central);
  SweepRolling* sweep_rolling = SILT_CHOSEN(sweep_rolling);
  SweepLubricated* sweep_lubricated = SILT_CHOSEN(sweep_lubricated);
  SweepBlocks* sweep_blocks = SILT_CHOSEN(sweep_blocks);
  PrepareBlocks* prepare_blocks = SILT_CHOSEN(prepare_blocks);
};
const LaneKernels& kernels() {
  static const LaneKernels of_this_machine;
  return of_this_machine;
}

constexpr double on_axis = 1e-12;  // sine between arm and normal below which they are parallel

bool is_central(const PairToSolve& p) {
  if (p.contacts.size() != 1 || !p.a.isotropic || !p.b.isotropic) return false;
  if (p.a.locked || p.b.locked) return false;
  const Contact& c = p.contacts[0];
  if (p.rolling && c.lubrication) return false;
  const auto along = [&](const Vec3& r, const BodyMass& m) {
    return !m.turns || r.cross(c.normal).squaredNorm() <= on_axis * on_axis * r.squaredNorm();
  };
  return along(c.r_a, p.a) && along(c.r_b, p.b);
}

void set(Real8* lanes, int l, const Vec3& x) {
  for (int d = 0; d < 3; ++d) lanes[d][l] = x[d];
}

Vec3 vector_of(const Real8* lanes, int l) {
  return {lanes[0][l], lanes[1][l], lanes[2][l]};
}

void set_symmetric(Real8* lanes, int l, const Mat3& m) {
  lanes[0][l] = m(0, 0);
  lanes[1][l] = m(1, 1);
  lanes[2][l] = m(2, 2);
  lanes[3][l] = m(0, 1);
  lanes[4][l] = m(0, 2);
  lanes[5][l] = m(1, 2);
}

bool has_lubrication(const PairToSolve& p) {
  return std::ranges::any_of(p.contacts, [](const Contact& c) { return bool(c.lubrication); });
}

/// Returns the next free lane of the last group; adds a group of unused lanes if there is none.
template <class Group>
int next_lane(std::vector<Group>& groups, int& lane, std::size_t rows) {
  if (lane == lane_count) {
    groups.emplace_back();
    for (int l = 0; l < lane_count; ++l) {
      LaneBodies& bodies = groups.back().bodies;
      bodies.a[l] = bodies.b[l] = static_cast<std::int32_t>(rows);
      groups.back().least_scale[l] = 1;
    }
    lane = 0;
  }
  return lane++;
}

void set_pair(PairGroup& g, int l, const PairToSolve& p) {
  g.age[l] = 1;
  g.carried[l] = 0;
  g.least_scale[l] = p.least_scale;
  g.bodies.a[l] = static_cast<std::int32_t>(p.row_a);
  g.bodies.b[l] = static_cast<std::int32_t>(p.row_b);
  g.bodies.again[l] = p.again;
}

/// Sets contact k of the pair, with the compliances of its normal and tangential motion.
void set_contact(LaneContact& lanes, int l, const PairToSolve& p, std::size_t k, double k_n, double k_t) {
  const Contact& c = p.contacts[k];
  set(lanes.normal, l, c.normal);
  lanes.normal_impulse[l] = lanes.last_normal[l] = p.impulses[k].normal;
  set(lanes.tangential_impulse, l, p.impulses[k].tangential);
  set(lanes.last_tangential, l, p.impulses[k].tangential);
  lanes.target[l] = p.targets[k];
  lanes.friction[l] = c.friction;
  lanes.inverse_k_n[l] = inverse(k_n);
  lanes.inverse_k_t[l] = inverse(k_t);
}

/// Returns the compliances of normal and tangential motion.
std::array<double, 2> set_central(CentralGroup& g, int l, const PairToSolve& p) {
  const Contact& c = p.contacts[0];
  const double arm_a = c.normal.dot(c.r_a), arm_b = c.normal.dot(c.r_b);
  const double k_n = p.share_a * p.a.inverse_mass + p.share_b * p.b.inverse_mass;
  const double turn_a = p.share_a * p.a.inverse_inertia(0, 0), turn_b = p.share_b * p.b.inverse_inertia(0, 0);
  const double k_t = k_n + arm_a * arm_a * turn_a + arm_b * arm_b * turn_b;
  set_pair(g, l, p);
  set_contact(g, l, p, 0, k_n, k_t);
  g.target[l] += c.normal.dot(p.together);
  g.arm_a[l] = arm_a;
  g.arm_b[l] = arm_b;
  return {k_n, k_t};
}

/// Removes the resistance to rolling, for the position correction.
void release(RollingGroup& g, int l) {
  g.rolling_friction[l] = g.twisting_friction[l] = 0;
  set(g.rolling_impulse, l, Vec3::Zero());
  set(g.last_rolling, l, Vec3::Zero());
}

void set_rolling(BlockRolling& lanes, int l, const PairToSolve& p, std::size_t k) {
  const Mat3 turn = p.share_a * p.a.inverse_inertia + p.share_b * p.b.inverse_inertia;
  const double arm = p.contacts[k].radii.least;
  lanes.roll_arm[l] = arm;
  lanes.rolling_friction[l] = p.rolling->rolling_friction;
  lanes.twisting_friction[l] = p.rolling->twisting_friction;
  lanes.inverse_k_roll[l] =
      inverse(arm * arm * turn.cwiseAbs().rowwise().sum().maxCoeff());  // an upper bound of k
}

/// Removes the lubrication film, for the position correction.
void dry(LubricatedGroup& g, int l) {
  g.normal_stiffness[l] = 1;
  g.normal_damped[l] = g.roll_keeps[l] = g.tangential_damped[l] = g.roll_gain[l] = g.roll_to_slip[l] = 0;
  set(g.rolling_impulse, l, Vec3::Zero());
  set(g.last_rolling, l, Vec3::Zero());
}

void set_lubrication(BlockLubrication& lanes, int l, const PairToSolve& p, std::size_t k,
                     const BlockContact& contact) {
  const LubricationResistance& resistance = p.contacts[k].lubrication;
  const double k_n = inverse(contact.inverse_k_n[l]), k_t = inverse(contact.inverse_k_t[l]);
  lanes.normal_stiffness[l] = 1 + p.dt * resistance.normal * k_n;
  lanes.normal_damped[l] = damped(p.dt * resistance.normal, k_n);
  lanes.tangential_damped[l] = damped(p.dt * resistance.sliding, k_t);
  lanes.normal_held[l] = k_n > 0 ? 0 : p.dt * resistance.normal;
  lanes.tangential_held[l] = k_t > 0 ? 0 : p.dt * resistance.sliding;
}

}  // namespace

void PairLanes::clear(std::size_t rows) {
  rows_ = rows;
  central_lane_ = rolling_lane_ = lubricated_lane_ = lane_count;
  central_.clear();
  rolling_.clear();
  lubricated_.clear();
  blocks_.clear();
  block_contacts_.clear();
  block_lubrication_.clear();
  block_rolling_.clear();
  open_.clear();
  block_order_.clear();
}

PairLanes::Place PairLanes::add(const PairToSolve& p) {
  if (!is_central(p)) return add_block(p);
  if (p.rolling) return add_rolling(p);
  return p.contacts[0].lubrication ? add_lubricated(p) : add_central(p);
}

PairLanes::Place PairLanes::add_central(const PairToSolve& p) {
  const int l = next_lane(central_, central_lane_, rows_);
  set_central(central_.back(), l, p);
  return {static_cast<std::uint32_t>(central_.size() - 1), static_cast<std::uint8_t>(l), Kind::central};
}

PairLanes::Place PairLanes::add_rolling(const PairToSolve& p) {
  const int l = next_lane(rolling_, rolling_lane_, rows_);
  RollingGroup& g = rolling_.back();
  const double k_t = set_central(g, l, p)[1], arm = p.contacts[0].radii.least;
  const double turn_a = p.share_a * p.a.inverse_inertia(0, 0), turn_b = p.share_b * p.b.inverse_inertia(0, 0);
  const double k_r = arm * arm * (turn_a + turn_b),
               across = arm * (turn_a * g.arm_a[l] + turn_b * g.arm_b[l]);
  release(g, l);
  g.roll_arm[l] = arm;
  g.rolling_friction[l] = p.rolling->rolling_friction;
  g.twisting_friction[l] = p.rolling->twisting_friction;
  g.roll_to_slip[l] = across;
  g.inverse_k_roll[l] = inverse(k_r);
  g.inverse_k_roll_stuck[l] = inverse(k_r - across * across / k_t);
  return {static_cast<std::uint32_t>(rolling_.size() - 1), static_cast<std::uint8_t>(l), Kind::rolling};
}

PairLanes::Place PairLanes::add_lubricated(const PairToSolve& p) {
  const int l = next_lane(lubricated_, lubricated_lane_, rows_);
  LubricatedGroup& g = lubricated_.back();
  const auto [k_n, k_t] = set_central(g, l, p);
  const Contact& c = p.contacts[0];
  const double z_n = p.dt * c.lubrication.normal, z_t = p.dt * c.lubrication.sliding,
               z_r = p.dt * c.lubrication.rolling;
  const double a = g.arm_a[l], b = -g.arm_b[l];  // A and B of contact_lanes.hpp
  const double skew = is_wall(c.b) ? -1 : (a - b) / (a + b);
  const double turn_a = a * a * p.share_a * p.a.inverse_inertia(0, 0);
  const double turn_b = is_wall(c.b) ? 0 : b * b * p.share_b * p.b.inverse_inertia(0, 0);
  const double k_r = skew * skew * k_n + turn_a + turn_b;
  const double across = turn_b - turn_a - skew * k_n;
  const double gain = z_r / (1 + z_r * k_r);
  g.normal_stiffness[l] = 1 + z_n * k_n;
  g.together[l] = c.normal.dot(p.together);
  g.normal_damped[l] = damped(z_n, k_n);
  const double k_slip = k_t - gain * across * across;
  g.inverse_k_t[l] = 1 / k_slip;
  g.tangential_damped[l] = damped(z_t, k_slip);
  g.skew[l] = skew;
  g.reach_a[l] = a;
  g.reach_b[l] = is_wall(c.b) ? 2 * a + b : b;
  g.roll_gain[l] = gain;
  g.roll_keeps[l] = gain * k_r;
  g.roll_to_slip[l] = across;
  set(g.rolling_impulse, l, Vec3::Zero());
  set(g.last_rolling, l, Vec3::Zero());
  return {static_cast<std::uint32_t>(lubricated_.size() - 1), static_cast<std::uint8_t>(l), Kind::lubricated};
}

PairLanes::Place PairLanes::add_block(const PairToSolve& p) {
  const std::size_t count = p.contacts.size();
  const bool lubricated = has_lubrication(p);
  const bool rolling = p.rolling != nullptr;
  if (open_.size() <= 4 * count + 3) open_.resize(4 * count + 4);
  Open& open = open_[4 * count + 2 * rolling + lubricated];
  if (open.lane == lane_count) {
    open = {static_cast<std::uint32_t>(blocks_.size()), 0};
    blocks_.emplace_back();
    BlockGroup& g = blocks_.back();
    for (int l = 0; l < lane_count; ++l) {
      g.bodies.a[l] = g.bodies.b[l] = static_cast<std::int32_t>(rows_);
      g.least_scale[l] = g.softness[l] = 1;
      set(g.inverse_mass, l, Vec3::Ones());
      set_symmetric(g.inverse_inertia_a, l, Mat3::Identity());
    }
    g.first = static_cast<std::uint32_t>(block_contacts_.size());
    g.count = static_cast<std::uint32_t>(count);
    block_contacts_.resize(block_contacts_.size() + count);
    g.first_lubrication = lubricated ? static_cast<std::uint32_t>(block_lubrication_.size()) : without;
    g.first_rolling = rolling ? static_cast<std::uint32_t>(block_rolling_.size()) : without;
    if (rolling) block_rolling_.resize(block_rolling_.size() + count);
    if (lubricated) block_lubrication_.resize(block_lubrication_.size() + count);
  }
  BlockGroup& g = blocks_[open.group];
  const int l = open.lane++;
  const Contact& c = p.contacts[0];
  set(g.offset, l, c.r_b - c.r_a);
  set(g.together, l, p.together);
  set(g.inverse_mass, l, inverse_masses(p));
  set_symmetric(g.inverse_inertia_a, l, p.share_a * p.a.inverse_inertia);
  set_symmetric(g.inverse_inertia_b, l, p.share_b * p.b.inverse_inertia);
  set_pair(g, l, p);
  constexpr double soft = 1e-5;  // relative to a contact's compliance
  double furthest = 0;
  for (std::size_t k = 0; k < count; ++k) {
    furthest = std::max(furthest, p.contacts[k].r_a.squaredNorm());
    add_block_contact(block_contacts_[g.first + k], l, p, k);
    if (lubricated)
      set_lubrication(block_lubrication_[g.first_lubrication + k], l, p, k, block_contacts_[g.first + k]);
    if (rolling) set_rolling(block_rolling_[g.first_rolling + k], l, p, k);
  }
  const double stiffness = block_contacts_[g.first].inverse_k_n[l];
  g.softness[l] = stiffness > 0 ? soft / stiffness : soft;
  g.inverse_arm[l] = furthest > 0 ? 1 / std::sqrt(furthest) : 0;
  block_order_.push_back({open.group, static_cast<std::uint8_t>(l), Kind::block});
  return block_order_.back();
}

void PairLanes::add_block_contact(BlockContact& lanes, int l, const PairToSolve& p, std::size_t k) {
  const Contact& c = p.contacts[k];
  const Mat3 response = compliance(p, c);
  const Vec3 k_normal = response * c.normal;
  // for infinite mass of a its own points may lie apart from those on b, where the impulses act
  const Vec3 r = p.a.inverse_mass > 0 ? c.r_a : Vec3(c.r_b - (p.contacts[0].r_b - p.contacts[0].r_a));
  set(lanes.r, l, r);
  set(lanes.k_normal, l, k_normal);
  set_contact(lanes, l, p, k, c.normal.dot(k_normal), tangential_eigenvalue(response, c.normal, k_normal));
}

void PairLanes::prepare() {
  kernels().prepare_blocks(blocks_);
}

SweepOutcome PairLanes::sweep(std::span<const BodyState> state, std::span<BodySum> sums,
                              const ContactSweep& sweep) {
  const LaneKernels& k = kernels();
  const SweepOutcome of_kinds[] = {
      k.sweep_central(central_, state.data(), sums.data(), sweep),
      rolling_.empty() ? SweepOutcome{} : k.sweep_rolling(rolling_, state.data(), sums.data(), sweep),
      k.sweep_lubricated(lubricated_, state.data(), sums.data(), sweep),
      k.sweep_blocks(blocks_, block_contacts_.data(), block_lubrication_.data(), block_rolling_.data(),
                     state.data(), sweep)};
  sum_blocks(sums, sweep.tolerance);
  SweepOutcome all;
  for (const SweepOutcome& of : of_kinds) {
    all.residual = std::max(all.residual, of.residual);
    all.solved |= of.solved;
    all.carried |= of.carried;
  }
  return all;
}

void PairLanes::sum_blocks(std::span<BodySum> sums, double tolerance) const {
  for (const Place& at : block_order_) {
    const BlockGroup& g = blocks_[at.group];
    const int l = at.lane;
    if (g.relative_change[l] < 0) continue;
    const Vec3 impulse = vector_of(g.impulse, l), angular = vector_of(g.angular, l);
    const Vec3 angular_b = angular + vector_of(g.offset, l).cross(impulse);
    BodySum &a = sums[g.bodies.a[l]], &b = sums[g.bodies.b[l]];
    for (int d = 0; d < 3; ++d) {
      a.impulse[d] -= impulse[d];
      a.angular[d] -= angular[d];
      b.impulse[d] += impulse[d];
      b.angular[d] += angular_b[d];
    }
    if (g.relative_change[l] > tolerance) a.changed = b.changed = 1;
  }
}

PairGroup& PairLanes::group_at(const Place& at) {
  switch (at.kind) {
    case Kind::central:
      return central_[at.group];
    case Kind::rolling:
      return rolling_[at.group];
    case Kind::lubricated:
      return lubricated_[at.group];
    default:
      return blocks_[at.group];
  }
}

LaneContact& PairLanes::contact_at(const Place& at, std::size_t k) {
  if (at.kind == Kind::block) return block_contacts_[blocks_[at.group].first + k];
  return static_cast<CentralGroup&>(group_at(at));
}

void PairLanes::read_impulses(const Place& at, std::span<ContactImpulse> out) {
  for (std::size_t k = 0; k < out.size(); ++k) {
    const LaneContact& lanes = contact_at(at, k);
    out[k].normal = lanes.normal_impulse[at.lane];
    for (int d = 0; d < 3; ++d) out[k].tangential[d] = lanes.tangential_impulse[d][at.lane] + 0.0;  // no -0
  }
}

/// The moments on a and b about a's centre are opposite.
PairLanes::Rolling PairLanes::read_rolling(const Place& at) const {
  const int l = at.lane;
  Rolling all;
  if (at.kind == Kind::rolling) {
    const RollingGroup& g = rolling_[at.group];
    all.moment = g.roll_arm[l] * vector_of(g.rolling_impulse, l);
  } else if (at.kind == Kind::lubricated) {
    const LubricatedGroup& g = lubricated_[at.group];
    const Vec3 impulse = vector_of(g.rolling_impulse, l);
    all = {-g.skew[l] * impulse, -g.reach_a[l] * vector_of(g.normal, l).cross(impulse)};
  } else if (at.kind == Kind::block && blocks_[at.group].first_rolling != without) {
    for (std::uint32_t k = 0; k < blocks_[at.group].count; ++k) {
      const BlockRolling& r = block_rolling_[blocks_[at.group].first_rolling + k];
      all.moment += r.roll_arm[l] * vector_of(r.impulse, l);
    }
  }
  return all;
}

void PairLanes::aim(const Place& at, std::span<const double> targets, double least_scale) {
  const auto set_target = [&](LaneContact& lanes, double target) {
    lanes.target[at.lane] = target;
    lanes.friction[at.lane] = lanes.normal_impulse[at.lane] = lanes.last_normal[at.lane] = 0;
    set(lanes.tangential_impulse, at.lane, Vec3::Zero());
    set(lanes.last_tangential, at.lane, Vec3::Zero());
  };
  PairGroup& group = group_at(at);
  group.least_scale[at.lane] = least_scale;
  group.age[at.lane] = 1;
  group.carried[at.lane] = 0;
  if (at.kind == Kind::block) set(blocks_[at.group].together, at.lane, Vec3::Zero());
  if (at.kind == Kind::lubricated) dry(lubricated_[at.group], at.lane);
  if (at.kind == Kind::rolling) release(rolling_[at.group], at.lane);
  for (std::size_t k = 0; k < targets.size(); ++k) set_target(contact_at(at, k), targets[k]);
}

}  // namespace silt::rigid
