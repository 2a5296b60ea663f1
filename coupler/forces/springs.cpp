#include "coupler/forces/springs.hpp"

#include <algorithm>
#include <cstring>

#include "coupler/exchange/coupling_state.hpp"

namespace silt::coupler {

using rigid::BodyId;
using rigid::BodySet;
using rigid::Vec3;

namespace {

constexpr std::size_t words = sizeof(rigid::Kinematics) / sizeof(std::int64_t);

}  // namespace

Springs::Springs(const Case& setup, MPI_Comm comm)
    : springs_(setup.springs), extent_(extent_of(setup)), comm_(comm) {
  for (const SpringSpec& spring : springs_)
    if (spring.to != 0) shared_.insert(shared_.end(), {spring.body, spring.to});
  std::sort(shared_.begin(), shared_.end());
  shared_.erase(std::unique(shared_.begin(), shared_.end()), shared_.end());
}

/// Each body has one owner: the bits of the others add nothing.
void Springs::look(const BodySet& bodies) {
  if (shared_.empty()) return;
  std::vector<std::int64_t> mine(words * shared_.size());
  for (std::size_t k = 0; k < shared_.size(); ++k)
    if (const std::size_t row = bodies.row_of(shared_[k]); row < bodies.owned) {
      const rigid::Kinematics kinematics = bodies.kinematics(row);
      std::memcpy(&mine[words * k], &kinematics, sizeof kinematics);
    }
  sums_.start(comm_, std::move(mine));
}

void Springs::push(BodySet& bodies) {
  pushes_.clear();
  if (!shared_.empty()) told_ = sums_.finish();
  for (const SpringSpec& spring : springs_) pull(bodies, spring);
}

void Springs::leave_out(BodySet& bodies) const {
  for (const Push& p : pushes_) {
    vector_in<3>(bodies, p.row, column::seen_load) -= p.force;
    vector_in<3>(bodies, p.row, column::seen_load, 3) -= p.torque;
  }
}

/// Returns where drift takes the body before it is kicked; nothing for a body that is not there.
std::optional<Springs::State> Springs::state(const BodySet& bodies, BodyId id) const {
  const auto found = std::lower_bound(shared_.begin(), shared_.end(), id);
  rigid::Kinematics k;
  if (found != shared_.end() && *found == id) {
    std::memcpy(static_cast<void*>(&k), &told_[words * (found - shared_.begin())], sizeof k);
  } else {
    const std::size_t row = bodies.row_of(id);
    if (row >= bodies.owned) return {};
    k = bodies.kinematics(row);
  }
  const rigid::Quat q(k.orientation[0], k.orientation[1], k.orientation[2], k.orientation[3]);
  if (q.squaredNorm() == 0) return {};
  const rigid::Twist twist{Vec3(k.velocity), Vec3(k.angular_velocity)};
  return State{{Vec3(k.position) + 0.5 * twist.v, rigid::cayley(0.5 * twist.w) * q}, twist};
}

/// method.md, equations 49 and 50.
void Springs::pull(BodySet& bodies, const SpringSpec& spring) {
  if (bodies.row_of(spring.body) >= bodies.owned &&
      (spring.to == 0 || bodies.row_of(spring.to) >= bodies.owned))
    return;
  const auto a = state(bodies, spring.body);
  const auto b = spring.to == 0 ? std::optional<State>(State{}) : state(bodies, spring.to);
  if (!a || !b) return;
  const Vec3 arm_a = a->pose.orientation * spring.arm, arm_b = b->pose.orientation * spring.to_arm;
  const Vec3 apart = nearest_image(b->pose.position + arm_b - a->pose.position - arm_a, extent_);
  const Vec3 rate = b->twist.at(arm_b) - a->twist.at(arm_a);
  const double distance = apart.norm();
  const double damping = spring.damping / (1 + 0.5 * spring.damping * spring.compliance);
  Vec3 force = spring.stiffness * apart + damping * rate;
  if (spring.length > 0) {
    const Vec3 along = distance > 0 ? Vec3(apart / distance) : Vec3(Vec3::Zero());
    force = (spring.stiffness * (distance - spring.length) + damping * rate.dot(along)) * along;
  }
  add(bodies, spring.body, force, arm_a);
  if (spring.to != 0) add(bodies, spring.to, -force, arm_b);
}

void Springs::add(BodySet& bodies, BodyId id, const Vec3& force, const Vec3& arm) {
  const std::size_t row = bodies.row_of(id);
  if (row >= bodies.owned || !bodies.is_dynamic(row)) return;
  const Vec3 torque = arm.cross(force);
  bodies.add_force(row, force);
  bodies.add_torque(row, torque);
  pushes_.push_back({row, force, torque});
}

}  // namespace silt::coupler
