#include "rigid/collision/kept_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace silt::rigid {
namespace {

constexpr double least_slack = 0.05;                   // of a body's reach: a sixth more pairs
constexpr double ahead = 1.2;                          // bodies that gather speed move further than they did
constexpr double slack_rounding = 1e-3;                // of the slack
constexpr double search = 14;                          // looks at a pair cost as much as finding it
constexpr double widest_cells = 2;                     // by slack: what reaches further has its own grid
constexpr std::size_t sample = 256;                    // bodies that tell what all have in common
constexpr double tried_calls[] = {1, 2, 4, 6, 9, 12};  // that a list is to serve after the first
constexpr std::size_t most_newcomers = 40;  // in a call: of more, finding all pairs again costs less
constexpr std::size_t share_in_all = 4;     // as much as one body in so many may have come
constexpr double rounding = 1e-12;          // relative, of distances

bool differ(const std::array<std::int32_t, 3>& a, const std::array<std::int32_t, 3>& b) {
  return ((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2])) != 0;
}

}  // namespace

bool KeptPairs::same_extent_and_walls(const Surroundings& around, std::span<const WallSurface> walls) const {
  return !seen_.empty() && around.extent.size == extent_.size && around.extent.periodic == extent_.periodic &&
         std::equal(walls.begin(), walls.end(), walls_.begin(), walls_.end());
}

bool KeptPairs::same_rows(const Surroundings& around) const {
  const BodyId* const ids = around.bodies.id.data();
  return std::equal(rows_.ids.begin(), rows_.ids.end(), ids, ids + around.size());
}

/// Finds the rows in which the bodies are now, and those with bodies that were not there before.
void KeptPairs::find_rows(const Surroundings& around) {
  const BodySet& bodies = around.bodies;
  rows_.seen.assign(around.size(), none);
  rows_.ids.assign(bodies.id.data(), bodies.id.data() + around.size());
  for (std::uint32_t n = 0; n < seen_.size(); ++n) {
    if (rows_.of_seen[n] == none) continue;
    const std::size_t row = bodies.row_of(seen_[n].id);
    const bool here = row < around.size() && bodies.id[row] == seen_[n].id;
    rows_.of_seen[n] = here ? static_cast<std::uint32_t>(row) : none;
    if (here) rows_.seen[row] = n;
  }
  for (std::uint32_t row = 0; row < around.size(); ++row)
    if (rows_.seen[row] == none) rows_.newcomers.push_back(row);
}

/// Returns the displacement, periods of sides that were passed included.
Vec3 KeptPairs::displacement_of(const Surroundings& around, std::size_t n) const {
  const Seen& then = seen_[n];
  const std::size_t row = rows_.of_seen[n];
  const auto& image = around.bodies.image[row];
  Vec3 displacement = around.bodies.position[row] - then.position;
  if (differ(image, then.image))
    for (int d = 0; d < 3; ++d) displacement[d] += (image[d] - then.image[d]) * around.extent.size[d];
  return displacement;
}

/// Returns the mean displacement of the bodies. Only their displacements apart from it count, whatever it is.
Vec3 KeptPairs::common_displacement(const Surroundings& around) const {
  Vec3 sum = Vec3::Zero();
  std::size_t count = 0;
  for (std::size_t n = 0; n < seen_.size(); n += seen_.size() / sample | 1) {
    if (rows_.of_seen[n] == none) continue;
    sum += displacement_of(around, n) + seen_[n].common;
    ++count;
  }
  return count ? Vec3(sum / double(count)) : sum;
}

/// A body in reach is less than a period away, hence one of the images -1, 0 and 1, whatever periodic sides
/// both have passed. Else an image may come to meet that was none of these when the pairs were found.
bool KeptPairs::images_are_few() const {
  for (int d = 0; d < 3; ++d)
    if (extent_.periodic[d] && extent_.size[d] <= 2 * plan_.largest) return false;
  return true;
}

bool KeptPairs::hold(const Surroundings& around, std::span<const WallSurface> walls) {
  ++calls_;
  wrapped_ = false;
  rows_.newcomers.clear();
  to_look_at_.clear();
  known_ = same_extent_and_walls(around, walls);
  if (!known_) return false;
  if (!same_rows(around)) find_rows(around);
  // without slack only what has not moved at all is sure: not even rounding may differ
  const Vec3 common = plan_.has_slack ? common_displacement(around) : Vec3(Vec3::Zero());
  const auto used_up = [](double moved, double left) { return left < 0 || moved > left * left; };
  for (std::uint32_t n = 0; n < seen_.size(); ++n) {
    const Seen& seen = seen_[n];
    if (rows_.of_seen[n] == none) continue;
    const std::size_t row = rows_.of_seen[n];
    if (around.bodies.is_dynamic(row) != seen.dynamic) return known_ = false;
    const double grown = around.reach[row].sum() - seen.reach, sure = 1 - slack_rounding;
    const Vec3 moved = displacement_of(around, n);
    if (used_up(seen.relative(moved, common).squaredNorm(), sure * seen.slack.to_bodies - grown))
      return false;
    if (used_up((moved - seen.at_walls).squaredNorm(), sure * seen.to_next_wall - grown))
      to_look_at_.push_back(n);
    wrapped_ |= differ(around.bodies.image[row], seen.image);
  }
  if (wrapped_ && !images_are_few()) return false;
  if (!rows_.newcomers.empty() && !take_in(around, common)) return false;
  look_at_walls(around, walls);
  return true;
}

/// Returns a body's motion in a call, apart from the others and in all, as it was since it was seen.
KeptPairs::Slack KeptPairs::motion_of(const Surroundings& around, std::size_t n, const Vec3& common) const {
  const Seen& seen = seen_[n];
  if (seen.calls == calls_) return {};
  const Vec3 moved = displacement_of(around, n);
  const double grown = std::max(0.0, around.reach[rows_.of_seen[n]].sum() - seen.reach),
               share = ahead / (calls_ - seen.calls);
  return {float(share * (seen.relative(moved, common).norm() + grown)),
          float(share * (moved.norm() + grown))};
}

/// Returns the number of calls that makes them cheapest: each looks at all of the list, which has the more
/// pairs the longer it is to last, and the first one finds it.
double KeptPairs::best_calls(const Surroundings& around, const Vec3& common) const {
  std::array<double, std::size(tried_calls)> pairs{};
  std::size_t bodies = 0;
  double most_shares = 0;
  for (std::size_t n = 0; n < seen_.size(); ++n) {
    if (rows_.of_seen[n] == none) continue;
    ++bodies;
    const double reach = seen_[n].reach, motion = motion_of(around, n, common).to_bodies;
    const double shares = reach > 0 ? motion / reach : 0;
    most_shares = std::max(most_shares, shares);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const double wider = 1 + std::max(least_slack, tried_calls[k] * shares);
      pairs[k] += wider * wider * wider;
    }
  }
  double best = 0, least = (search + 1) * double(bodies);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const double widest = std::min(widest_cells, 1 + std::max(least_slack, tried_calls[k] * most_shares));
    const double cost = search * double(bodies) * widest * widest * widest / (tried_calls[k] + 1) + pairs[k];
    if (cost < least) best = tried_calls[k], least = cost;
  }
  return best;
}

std::span<const KeptPairs::Slack> KeptPairs::plan(const Surroundings& around) {
  plan_.slack.assign(around.size(), {0, 0});
  plan_.typical = {0, 0};
  plan_.has_slack = false;
  if (!known_) return plan_.slack;
  const Vec3 common = common_displacement(around);
  const double calls = best_calls(around, common);
  if (calls == 0) return plan_.slack;
  plan_.has_slack = true;
  double to_bodies = 0, to_walls = 0;
  const auto wider = [&](std::size_t row, const Slack& slack) -> Slack {
    const float least = float(least_slack * around.reach[row].sum());
    return {std::max(least, slack.to_bodies), std::max(least, slack.to_walls)};
  };
  std::size_t known = 0;
  for (std::size_t row = 0; row < around.size(); ++row) {
    if (rows_.seen[row] == none) continue;
    const Slack motion = motion_of(around, rows_.seen[row], common);
    plan_.slack[row] = wider(row, {float(calls) * motion.to_bodies, float(calls) * motion.to_walls});
    to_bodies += plan_.slack[row].to_bodies, to_walls += plan_.slack[row].to_walls, ++known;
  }
  if (known > 0) plan_.typical = {float(to_bodies / double(known)), float(to_walls / double(known))};
  for (const std::uint32_t row : rows_.newcomers) plan_.slack[row] = wider(row, plan_.typical);
  return plan_.slack;
}

std::vector<CandidatePair>& KeptPairs::renew(const Surroundings& around, std::span<const WallSurface> walls) {
  const BodySet& bodies = around.bodies;
  seen_.clear();
  for (std::size_t row = 0; row < around.size(); ++row)
    seen_.push_back({bodies.id[row], bodies.position[row], Vec3::Zero(), bodies.image[row],
                     bodies.is_dynamic(row), 0, around.reach[row].sum(), plan_.slack[row], Vec3::Zero(),
                     unlimited});
  rows_.of_seen.resize(seen_.size());
  std::iota(rows_.of_seen.begin(), rows_.of_seen.end(), 0u);
  rows_.seen = to_look_at_ = rows_.of_seen;
  rows_.ids.assign(bodies.id.data(), bodies.id.data() + around.size());
  rows_.newcomers.clear();
  walls_.assign(walls.begin(), walls.end());
  extent_ = around.extent;
  calls_ = 0;
  wrapped_ = false;
  plan_.largest = 0;
  for (const Seen& seen : seen_) plan_.largest = std::max(plan_.largest, seen.reach + seen.slack.to_bodies);
  near_walls_.clear();
  look_at_walls(around, walls);
  return pairs_;
}

/// Returns the change of the image of b relative to a, by the periodic sides that both have passed.
std::int32_t KeptPairs::image_change(const BodySet& bodies, const CandidatePair& kept, int axis) const {
  const auto passed = [&](std::size_t n) {
    return bodies.image[rows_.of_seen[n]][axis] - seen_[n].image[axis];
  };
  return passed(kept.row_b) - passed(kept.row_a);
}

/// Returns whether it is one that bodies meet through.
bool KeptPairs::image_now(const BodySet& bodies, const CandidatePair& kept, Image& image) const {
  std::int8_t* const of_pair[3] = {&image.x, &image.y, &image.z};
  for (int d = 0; d < 3; ++d) {
    const std::int32_t now = *of_pair[d] + image_change(bodies, kept, d);
    if (now < -1 || now > 1) return false;
    *of_pair[d] = static_cast<std::int8_t>(now);
  }
  return true;
}

void KeptPairs::select(const Surroundings& around, std::span<const WallSurface> walls,
                       std::vector<CandidatePair>& pairs) const {
  auto near = near_walls_.begin();
  const auto take_walls = [&](auto&& of) {  // come after the bodies that one meets: their ids are higher
    for (; near != near_walls_.end() && of(seen_[near->seen].id); ++near)
      if (const std::uint32_t row = rows_.of_seen[near->seen];
          row != none && around.meets(row, walls[near->wall]))
        pairs.push_back({row, around.size() + near->wall, Image{}});
  };
  for (const CandidatePair& kept : pairs_) {
    take_walls([&](BodyId id) { return id < seen_[kept.row_a].id; });
    CandidatePair p{rows_.of_seen[kept.row_a], rows_.of_seen[kept.row_b], kept.image};
    if (p.row_a == none || p.row_b == none) continue;
    if (wrapped_ && !image_now(around.bodies, kept, p.image)) continue;
    if (around.meet(p)) pairs.push_back(p);
  }
  take_walls([](BodyId) { return true; });
}

// ---- bodies that have come since the pairs were found, as copies on a rank of many do ----

/// Looks at the newcomers with all the others. Returns whether it did: all is sure then.
bool KeptPairs::take_in(const Surroundings& around, const Vec3& common) {
  const BodySet& bodies = around.bodies;
  if (rows_.newcomers.size() > most_newcomers) return false;
  if ((seen_.size() + rows_.newcomers.size()) * share_in_all > rows_.seen.size() * (share_in_all + 1))
    return false;
  added_.clear();
  for (const std::uint32_t row : rows_.newcomers) {
    const auto n = static_cast<std::uint32_t>(seen_.size());
    const double reach = around.reach[row].sum();
    plan_.largest = std::max(plan_.largest, reach + plan_.typical.to_bodies);
    if (!one_image_is_in_reach()) return false;
    seen_.push_back({bodies.id[row], bodies.position[row], common, bodies.image[row], bodies.is_dynamic(row),
                     calls_, reach, plan_.typical, Vec3::Zero(), unlimited});
    rows_.of_seen.push_back(row);
    rows_.seen[row] = n;
    to_look_at_.push_back(n);
    pair_with_all(around, n, common);
  }
  const auto before = pair_order([&](std::size_t n) { return seen_[n].id; });
  std::sort(added_.begin(), added_.end(), before);
  const auto kept = static_cast<std::ptrdiff_t>(pairs_.size());
  pairs_.insert(pairs_.end(), added_.begin(), added_.end());
  std::inplace_merge(pairs_.begin(), pairs_.begin() + kept, pairs_.end(), before);
  return true;
}

/// No other image of a body than the nearest can meet another.
bool KeptPairs::one_image_is_in_reach() const {
  for (int d = 0; d < 3; ++d)
    if (extent_.periodic[d] && extent_.size[d] <= 4 * plan_.largest) return false;
  return true;
}

/// Adds the pairs of the n-th with those before it that may come to meet it, while neither uses up its slack:
/// another one may go back from where it is.
void KeptPairs::pair_with_all(const Surroundings& around, std::size_t n, const Vec3& common) {
  const BodySet& bodies = around.bodies;
  const Seen& own = seen_[n];
  for (std::size_t other = 0; other < n; ++other) {
    const Seen& seen = seen_[other];
    if (rows_.of_seen[other] == none || (!seen.dynamic && !own.dynamic)) continue;
    Vec3 between = bodies.position[rows_.of_seen[other]] - own.position, periods = Vec3::Zero();
    for (int d = 0; d < 3; ++d)
      if (extent_.periodic[d]) periods[d] = std::round(between[d] / extent_.size[d]);
    between -= periods.cwiseProduct(extent_.size);
    const double square = between.squaredNorm() * (1 - rounding);
    const double range = own.reach + own.slack.to_bodies + seen.reach + seen.slack.to_bodies,
                 most = range + seen.reach + seen.slack.to_bodies;  // of what it may be from where it was
    if (square > most * most) continue;
    const double exact = range + seen.relative(displacement_of(around, other), common).norm();
    if (square > exact * exact) continue;
    CandidatePair pair{n, other, {}};
    if (seen.id < own.id) std::swap(pair.row_a, pair.row_b), periods = -periods;
    std::int8_t* const of_pair[3] = {&pair.image.x, &pair.image.y, &pair.image.z};
    for (int d = 0; d < 3; ++d)  // as it would have been when both were seen
      *of_pair[d] = static_cast<std::int8_t>(-periods[d] - image_change(bodies, pair, d));
    added_.push_back(pair);
  }
}

// ---- walls that bodies may come to meet ----

/// Lists the walls within its slack, and notes how far it is to the others.
template <class List>
void KeptPairs::look_at_walls(const Surroundings& around, std::span<const WallSurface> walls, std::uint32_t n,
                              List&& list) {
  Seen& seen = seen_[n];
  const std::size_t row = rows_.of_seen[n];
  seen.at_walls = displacement_of(around, n);
  seen.to_next_wall = unlimited;
  if (!seen.dynamic) return;
  const double near = around.reach[row].sum() + seen.slack.to_walls;
  for (std::uint32_t w = 0; w < walls.size(); ++w) {
    const double distance = walls[w].distance(around.bodies.position[row]);
    if (distance > near)
      seen.to_next_wall = std::min(seen.to_next_wall, distance - seen.reach);
    else
      list(w);
  }
}

/// All bodies that have used up their room, or have come.
void KeptPairs::look_at_walls(const Surroundings& around, std::span<const WallSurface> walls) {
  if (walls.empty() || to_look_at_.empty()) return;
  const auto before = [&](const NearWall& p, const NearWall& q) {
    return std::tuple(seen_[p.seen].id, p.seen, p.wall) < std::tuple(seen_[q.seen].id, q.seen, q.wall);
  };
  const auto known = static_cast<std::ptrdiff_t>(near_walls_.size());
  for (const std::uint32_t n : to_look_at_)
    look_at_walls(around, walls, n, [&](std::uint32_t wall) {
      const NearWall near{n, wall};
      if (!std::binary_search(near_walls_.begin(), near_walls_.begin() + known, near, before))
        near_walls_.push_back(near);
    });
  std::sort(near_walls_.begin() + known, near_walls_.end(), before);
  std::inplace_merge(near_walls_.begin(), near_walls_.begin() + known, near_walls_.end(), before);
}

}  // namespace silt::rigid
