#include "rigid/collision/kept_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace silt::rigid {

namespace {

constexpr double least_slack = 0.05;                   // of a body's reach: a sixth more pairs
constexpr double ahead = 1.2;                          // bodies that gather speed move further than they did
constexpr double slack_rounding = 1e-3;                // of the slack
constexpr double search = 14;                          // looks at a pair cost as much as finding it
constexpr std::size_t sample = 256;                    // bodies that tell what all have in common
constexpr double tried_calls[] = {1, 2, 4, 6, 9, 12};  // that a list is to serve after the first

bool same(const WallSurface& a, const WallSurface& b) {
  return a.point == b.point && a.direction == b.direction && a.radius == b.radius && a.moves == b.moves;
}

bool differ(const std::array<std::int32_t, 3>& a, const std::array<std::int32_t, 3>& b) {
  return ((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2])) != 0;
}

}  // namespace

bool KeptPairs::same_surroundings(const Surroundings& around, std::span<const WallSurface> walls) const {
  if (around.size() != seen_.size() || around.extent.size != extent_.size ||
      around.extent.periodic != extent_.periodic ||
      !std::equal(walls.begin(), walls.end(), walls_.begin(), walls_.end(), same))
    return false;
  for (std::size_t row = 0; row < seen_.size(); ++row)
    if (around.bodies.id[row] != seen_[row].id || around.bodies.is_dynamic(row) != seen_[row].dynamic)
      return false;
  return true;
}

/// Through periodic sides, too.
Vec3 KeptPairs::displacement_of(const Surroundings& around, std::size_t row) const {
  const Seen& then = seen_[row];
  const auto& image = around.bodies.image[row];
  Vec3 displacement = around.bodies.position[row] - then.position;
  if (differ(image, then.image))
    for (int d = 0; d < 3; ++d) displacement[d] += (image[d] - then.image[d]) * around.extent.size[d];
  return displacement;
}

/// What bodies have moved on the mean. Whatever it is, what they have moved apart from it counts.
Vec3 KeptPairs::common_displacement(const Surroundings& around) const {
  Vec3 sum = Vec3::Zero();
  std::size_t count = 0;
  for (std::size_t row = 0; row < seen_.size(); row += seen_.size() / sample | 1, ++count)
    sum += displacement_of(around, row);
  return count ? Vec3(sum / double(count)) : sum;
}

/// Two bodies have at most one image of each other in reach. Else another one may come to meet, where one of
/// them passes a periodic side, that was none when the pairs were found.
bool KeptPairs::images_are_few() const {
  double largest = 0;
  for (std::size_t row = 0; row < seen_.size(); ++row)
    largest = std::max(largest, seen_[row].reach + slack_[row].to_bodies);
  for (int d = 0; d < 3; ++d)
    if (extent_.periodic[d] && extent_.size[d] <= 2 * largest) return false;
  return true;
}

bool KeptPairs::hold(const Surroundings& around, std::span<const WallSurface> walls) {
  ++calls_;
  wrapped_ = false;
  known_ = same_surroundings(around, walls);
  if (!known_) return false;
  // without slack only what has not moved at all is sure: not even rounding may differ
  const Vec3 common = has_slack_ ? common_displacement(around) : Vec3(Vec3::Zero());
  const auto used_up = [](double moved, double left) { return left < 0 || moved > left * left; };
  for (std::size_t row = 0; row < seen_.size(); ++row) {
    const Vec3 moved = displacement_of(around, row);
    const double grown = around.reach[row].sum() - seen_[row].reach, sure = 1 - slack_rounding;
    if (used_up((moved - common).squaredNorm(), sure * slack_[row].to_bodies - grown)) return false;
    if (!walls_.empty() && used_up(moved.squaredNorm(), sure * slack_[row].to_walls - grown)) return false;
    wrapped_ |= differ(around.bodies.image[row], seen_[row].image);
  }
  return !wrapped_ || few_images_;
}

/// What a body moves in a call, apart from the others and in all, as it did since the pairs were found.
KeptPairs::Slack KeptPairs::motion_of(const Surroundings& around, std::size_t row, const Vec3& common) const {
  const Vec3 moved = displacement_of(around, row);
  const double grown = std::max(0.0, around.reach[row].sum() - seen_[row].reach), share = ahead / calls_;
  return {float(share * ((moved - common).norm() + grown)), float(share * (moved.norm() + grown))};
}

/// So many calls as make them cheapest: each looks at all of the list, which has the more pairs the more it
/// is to last, and the first one finds it.
double KeptPairs::best_calls(const Surroundings& around, const Vec3& common) const {
  std::array<double, std::size(tried_calls)> pairs{};
  for (std::size_t row = 0; row < seen_.size(); ++row) {
    const double reach = seen_[row].reach, motion = motion_of(around, row, common).to_bodies;
    const double shares = reach > 0 ? motion / reach : 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const double wider = 1 + std::max(least_slack, tried_calls[k] * shares);
      pairs[k] += wider * wider * wider;
    }
  }
  double best = 0, least = (search + 1) * double(seen_.size());
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const double cost = pairs[k] * (search / (tried_calls[k] + 1) + 1);
    if (cost < least) best = tried_calls[k], least = cost;
  }
  return best;
}

std::span<const KeptPairs::Slack> KeptPairs::plan(const Surroundings& around) {
  slack_.assign(around.size(), {0, 0});
  has_slack_ = false;
  if (!known_) return slack_;
  const Vec3 common = common_displacement(around);
  const double calls = best_calls(around, common);
  if (calls == 0) return slack_;
  has_slack_ = true;
  for (std::size_t row = 0; row < seen_.size(); ++row) {
    const Slack motion = motion_of(around, row, common);
    const float least = float(least_slack * seen_[row].reach);
    slack_[row] = {std::max(least, float(calls) * motion.to_bodies),
                   std::max(least, float(calls) * motion.to_walls)};
  }
  return slack_;
}

std::vector<CandidatePair>& KeptPairs::renew(const Surroundings& around, std::span<const WallSurface> walls) {
  const BodySet& bodies = around.bodies;
  seen_.resize(around.size());
  for (std::size_t row = 0; row < around.size(); ++row)
    seen_[row] = {bodies.id[row], bodies.position[row], bodies.image[row], bodies.is_dynamic(row),
                  around.reach[row].sum()};
  walls_.assign(walls.begin(), walls.end());
  extent_ = around.extent;
  calls_ = 0;
  wrapped_ = false;
  few_images_ = images_are_few();
  return pairs_;
}

/// The image of b relative to a follows both through periodic sides. Returns whether it is one that bodies
/// meet through.
bool KeptPairs::image_now(const BodySet& bodies, CandidatePair& p) const {
  const auto &a = bodies.image[p.row_a], &b = bodies.image[p.row_b];
  const auto &a_then = seen_[p.row_a].image, &b_then = seen_[p.row_b].image;
  std::int8_t* const of_pair[3] = {&p.image.x, &p.image.y, &p.image.z};
  for (int d = 0; d < 3; ++d) {
    const std::int32_t image = *of_pair[d] + (b[d] - b_then[d]) - (a[d] - a_then[d]);
    if (image < -1 || image > 1) return false;
    *of_pair[d] = static_cast<std::int8_t>(image);
  }
  return true;
}

void KeptPairs::select(const Surroundings& around, std::span<const WallSurface> walls,
                       std::vector<CandidatePair>& pairs) const {
  for (CandidatePair p : pairs_) {
    const bool wall = p.row_b >= around.size();
    if (!wall && wrapped_ && !image_now(around.bodies, p)) continue;
    if (wall ? around.meets(p.row_a, walls[p.row_b - around.size()]) : around.meet(p)) pairs.push_back(p);
  }
}

}  // namespace silt::rigid
