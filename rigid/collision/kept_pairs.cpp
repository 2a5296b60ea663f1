#include "rigid/collision/kept_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace silt::rigid {

namespace {

// in shares of a body's reach
constexpr double least_slack = 0.05;     // a sixth more pairs
constexpr double most_slack = 0.2;       // three quarters more
constexpr double slack_rounding = 1e-3;  // of the slack

constexpr double calls_wanted = 6;  // that a list should serve

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

/// Two bodies have at most one image of each other in reach. Else another one may come to meet, where one of
/// them passes a periodic side, that was none when the pairs were found.
bool KeptPairs::images_are_few() const {
  double largest = 0;
  for (const Seen& body : seen_) largest = std::max(largest, body.reach);
  for (int d = 0; d < 3; ++d)
    if (extent_.periodic[d] && extent_.size[d] <= 2 * (1 + slack_) * largest) return false;
  return true;
}

bool KeptPairs::hold(const Surroundings& around, std::span<const WallSurface> walls) {
  ++calls_;
  wrapped_ = false;
  known_ = same_surroundings(around, walls);
  if (!known_) return false;
  for (std::size_t row = 0; row < seen_.size(); ++row) {
    const double before = seen_[row].reach;
    const double spare = (1 - slack_rounding) * slack_ * before + (before - around.reach[row].sum());
    if (spare < 0 || displacement_of(around, row).squaredNorm() > spare * spare) return false;
    wrapped_ |= differ(around.bodies.image[row], seen_[row].image);
  }
  return !wrapped_ || few_images_;
}

double KeptPairs::slack_of(const Surroundings& around) const {
  if (!known_) return 0;
  double most = 0;
  for (std::size_t row = 0; row < seen_.size(); ++row) {
    const double before = seen_[row].reach, grown = std::max(0.0, around.reach[row].sum() - before);
    if (before > 0) most = std::max(most, (displacement_of(around, row).norm() + grown) / before);
  }
  const double wanted = calls_wanted / calls_ * most;
  return wanted <= most_slack ? std::max(wanted, least_slack) : 0;
}

std::vector<CandidatePair>& KeptPairs::renew(const Surroundings& around, std::span<const WallSurface> walls,
                                             double slack) {
  const BodySet& bodies = around.bodies;
  seen_.resize(around.size());
  for (std::size_t row = 0; row < around.size(); ++row)
    seen_[row] = {bodies.id[row], bodies.position[row], bodies.image[row], bodies.is_dynamic(row),
                  around.reach[row].sum()};
  walls_.assign(walls.begin(), walls.end());
  extent_ = around.extent;
  slack_ = slack;
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
