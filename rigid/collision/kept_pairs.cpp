#include "rigid/collision/kept_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace silt::rigid {

namespace {

constexpr double least_slack = 0.05;     // of a body's reach: a sixth more pairs
constexpr double ahead = 1.2;            // bodies that gather speed move further than they did
constexpr double slack_rounding = 1e-3;  // of the slack
constexpr double search = 14;            // looks at a pair cost as much as finding it

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

void KeptPairs::find_motion(const Surroundings& around) {
  motion_.resize(seen_.size());
  Vec3 mean = Vec3::Zero();
  for (std::size_t row = 0; row < seen_.size(); ++row) {
    motion_[row].displacement = displacement_of(around, row);
    motion_[row].grown = around.reach[row].sum() - seen_[row].reach;
    mean += motion_[row].displacement;
  }
  mean /= double(std::max<std::size_t>(seen_.size(), 1));
  for (Motion& m : motion_) m.apart = (m.displacement - mean).norm();
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
  find_motion(around);
  constexpr double sure = 1 - slack_rounding;
  for (std::size_t row = 0; row < seen_.size(); ++row) {
    const Motion& m = motion_[row];
    if (m.apart + m.grown > sure * slack_[row].to_bodies) return false;
    if (!walls_.empty() && m.displacement.norm() + m.grown > sure * slack_[row].to_walls) return false;
    wrapped_ |= differ(around.bodies.image[row], seen_[row].image);
  }
  return !wrapped_ || few_images_;
}

/// What they are expected to move in so many calls, as they did since the pairs were found.
void KeptPairs::set_slack(double calls) {
  slack_.assign(seen_.size(), {0, 0});
  if (calls == 0) return;
  for (std::size_t row = 0; row < seen_.size(); ++row) {
    const Motion& m = motion_[row];
    const double least = least_slack * seen_[row].reach, share = ahead * calls / calls_,
                 grown = std::max(0.0, m.grown);
    slack_[row] = {std::max(least, share * (m.apart + grown)),
                   std::max(least, share * (m.displacement.norm() + grown))};
  }
}

/// How many times as many pairs the list has with the slack.
double KeptPairs::growth_of_list() const {
  double sum = 0;
  for (std::size_t row = 0; row < seen_.size(); ++row) {
    const double wider = seen_[row].reach > 0 ? 1 + slack_[row].to_bodies / seen_[row].reach : 1;
    sum += wider * wider * wider;
  }
  return sum / double(std::max<std::size_t>(seen_.size(), 1));
}

/// For as many calls as make them cheapest: each looks at all of the list, the first finds it.
std::span<const KeptPairs::Slack> KeptPairs::plan(const Surroundings& around) {
  double best = 0, least = search + 1;
  if (known_)
    for (const double calls : {1, 2, 4, 6, 9, 12}) {
      set_slack(calls);
      const double cost = growth_of_list() * (search / (calls + 1) + 1);
      if (cost < least) best = calls, least = cost;
    }
  seen_.resize(around.size());
  set_slack(best);
  return slack_;
}

std::vector<CandidatePair>& KeptPairs::renew(const Surroundings& around, std::span<const WallSurface> walls) {
  const BodySet& bodies = around.bodies;
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
