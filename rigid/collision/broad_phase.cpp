#include "rigid/collision/broad_phase.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace silt::rigid {

namespace {

constexpr double least_slack = 0.05;                   // relative to a body's reach; adds a sixth of pairs
constexpr double ahead = 1.2;                          // factor on displacements, for bodies that accelerate
constexpr double slack_rounding = 1e-3;                // relative to the slack
constexpr double search = 14;                          // cost of finding a pair over that of testing it
constexpr double widest_cells = 2;                     // by slack; larger bodies have their own grid
constexpr std::size_t sample = 256;                    // bodies from which the common motion is estimated
constexpr double tried_calls[] = {1, 2, 4, 6, 9, 12};  // calls that a list shall serve after the first
constexpr std::size_t most_newcomers = 40;             // per call; with more, a new search costs less
constexpr std::size_t share_in_all = 4;                // at most one body in this many may be a newcomer
constexpr double rounding = 1e-12;                     // relative, of distances

bool differ(const std::array<std::int32_t, 3>& a, const std::array<std::int32_t, 3>& b) {
  return ((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2])) != 0;
}

}  // namespace

bool VerletList::same_extent_and_walls(const Surroundings& around, std::span<const WallSurface> walls) const {
  return !snapshots_.empty() && around.extent.size == extent_.size &&
         around.extent.periodic == extent_.periodic &&
         std::equal(walls.begin(), walls.end(), walls_.begin(), walls_.end());
}

bool VerletList::same_rows(const Surroundings& around) const {
  const BodyId* const ids = around.bodies.id.data();
  return std::equal(rows_.ids.begin(), rows_.ids.end(), ids, ids + around.size());
}

/// Finds the current rows of the bodies of the list, and the rows of new bodies.
void VerletList::find_rows(const Surroundings& around) {
  const BodySet& bodies = around.bodies;
  rows_.snapshot.assign(around.size(), none);
  rows_.ids.assign(bodies.id.data(), bodies.id.data() + around.size());
  for (std::uint32_t n = 0; n < snapshots_.size(); ++n) {
    if (rows_.of_snapshot[n] == none) continue;
    const std::size_t row = bodies.row_of(snapshots_[n].id);
    const bool here = row < around.size() && bodies.id[row] == snapshots_[n].id;
    rows_.of_snapshot[n] = here ? static_cast<std::uint32_t>(row) : none;
    if (here) rows_.snapshot[row] = n;
  }
  for (std::uint32_t row = 0; row < around.size(); ++row)
    if (rows_.snapshot[row] == none) rows_.newcomers.push_back(row);
}

/// Returns the displacement of a body, including periods of the sides it has crossed.
Vec3 VerletList::displacement_of(const Surroundings& around, std::size_t n) const {
  const Snapshot& then = snapshots_[n];
  const std::size_t row = rows_.of_snapshot[n];
  const auto& image = around.bodies.image[row];
  Vec3 displacement = around.bodies.position[row] - then.position;
  if (differ(image, then.image))
    for (int d = 0; d < 3; ++d) displacement[d] += (image[d] - then.image[d]) * around.extent.size[d];
  return displacement;
}

/// Returns the mean displacement of the bodies. Slack is used up only by displacements relative to it.
Vec3 VerletList::common_displacement(const Surroundings& around) const {
  Vec3 sum = Vec3::Zero();
  std::size_t count = 0;
  for (std::size_t n = 0; n < snapshots_.size(); n += snapshots_.size() / sample | 1) {
    if (rows_.of_snapshot[n] == none) continue;
    sum += displacement_of(around, n) + snapshots_[n].common;
    ++count;
  }
  return count ? Vec3(sum / double(count)) : sum;
}

/// A body in reach is less than a period away, hence one of the images -1, 0 and 1, whichever periodic sides
/// both have crossed. If not, another image may come into reach.
bool VerletList::images_are_few() const {
  for (int d = 0; d < 3; ++d)
    if (extent_.periodic[d] && extent_.size[d] <= 2 * plan_.largest) return false;
  return true;
}

bool VerletList::is_valid(const Surroundings& around, std::span<const WallSurface> walls) {
  ++calls_;
  wrapped_ = false;
  rows_.newcomers.clear();
  walls_outdated_.clear();
  known_ = same_extent_and_walls(around, walls);
  if (!known_) return false;
  if (!same_rows(around)) find_rows(around);
  // without slack the list is valid only if nothing has moved: not even rounding may differ
  const Vec3 common = plan_.has_slack ? common_displacement(around) : Vec3(Vec3::Zero());
  const auto used_up = [](double moved, double left) { return left < 0 || moved > left * left; };
  for (std::uint32_t n = 0; n < snapshots_.size(); ++n) {
    const Snapshot& snapshot = snapshots_[n];
    if (rows_.of_snapshot[n] == none) continue;
    const std::size_t row = rows_.of_snapshot[n];
    if (around.bodies.is_dynamic(row) != snapshot.dynamic) return known_ = false;
    const double grown = around.reach[row].sum() - snapshot.reach, sure = 1 - slack_rounding;
    const Vec3 moved = displacement_of(around, n);
    if (used_up(snapshot.relative(moved, common).squaredNorm(), sure * snapshot.slack.to_bodies - grown))
      return false;
    if (used_up((moved - snapshot.at_walls).squaredNorm(), sure * snapshot.to_next_wall - grown))
      walls_outdated_.push_back(n);
    wrapped_ |= differ(around.bodies.image[row], snapshot.image);
  }
  if (wrapped_ && !images_are_few()) return false;
  if (!rows_.newcomers.empty() && !add_newcomers(around, common)) return false;
  update_walls(around, walls);
  return true;
}

/// Returns a body's displacement per call, relative to the mean (to bodies) and absolute (to walls).
VerletList::Slack VerletList::motion_of(const Surroundings& around, std::size_t n, const Vec3& common) const {
  const Snapshot& snapshot = snapshots_[n];
  if (snapshot.calls == calls_) return {};
  const Vec3 moved = displacement_of(around, n);
  const double grown = std::max(0.0, around.reach[rows_.of_snapshot[n]].sum() - snapshot.reach),
               share = ahead / (calls_ - snapshot.calls);
  return {float(share * (snapshot.relative(moved, common).norm() + grown)),
          float(share * (moved.norm() + grown))};
}

/// Returns the number of calls per list of least cost: each call tests the whole list, which is longer the
/// more calls it serves, and the first call searches for it.
double VerletList::best_calls(const Surroundings& around, const Vec3& common) const {
  std::array<double, std::size(tried_calls)> pairs{};
  std::size_t bodies = 0;
  double most_shares = 0;
  for (std::size_t n = 0; n < snapshots_.size(); ++n) {
    if (rows_.of_snapshot[n] == none) continue;
    ++bodies;
    const double reach = snapshots_[n].reach, motion = motion_of(around, n, common).to_bodies;
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

std::span<const VerletList::Slack> VerletList::plan(const Surroundings& around) {
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
    if (rows_.snapshot[row] == none) continue;
    const Slack motion = motion_of(around, rows_.snapshot[row], common);
    plan_.slack[row] = wider(row, {float(calls) * motion.to_bodies, float(calls) * motion.to_walls});
    to_bodies += plan_.slack[row].to_bodies, to_walls += plan_.slack[row].to_walls, ++known;
  }
  if (known > 0) plan_.typical = {float(to_bodies / double(known)), float(to_walls / double(known))};
  for (const std::uint32_t row : rows_.newcomers) plan_.slack[row] = wider(row, plan_.typical);
  return plan_.slack;
}

void VerletList::add_snapshot(const Surroundings& around, std::size_t row, const Slack& slack,
                              const Vec3& common) {
  const BodySet& bodies = around.bodies;
  snapshots_.push_back({.id = bodies.id[row],
                        .position = bodies.position[row],
                        .common = common,
                        .image = bodies.image[row],
                        .dynamic = bodies.is_dynamic(row),
                        .calls = calls_,
                        .reach = around.reach[row].sum(),
                        .slack = slack});
}

std::vector<CandidatePair>& VerletList::renew(const Surroundings& around,
                                              std::span<const WallSurface> walls) {
  const BodySet& bodies = around.bodies;
  calls_ = 0;
  snapshots_.clear();
  for (std::size_t row = 0; row < around.size(); ++row)
    add_snapshot(around, row, plan_.slack[row], Vec3::Zero());
  rows_.of_snapshot.resize(snapshots_.size());
  std::iota(rows_.of_snapshot.begin(), rows_.of_snapshot.end(), 0u);
  rows_.snapshot = walls_outdated_ = rows_.of_snapshot;
  rows_.ids.assign(bodies.id.data(), bodies.id.data() + around.size());
  rows_.newcomers.clear();
  walls_.assign(walls.begin(), walls.end());
  extent_ = around.extent;
  wrapped_ = false;
  plan_.largest = 0;
  for (const Snapshot& snapshot : snapshots_)
    plan_.largest = std::max(plan_.largest, snapshot.reach + snapshot.slack.to_bodies);
  near_walls_.clear();
  update_walls(around, walls);
  return pairs_;
}

/// Returns the change of the image of b relative to a by the periodic sides that both have crossed.
std::int32_t VerletList::image_change(const BodySet& bodies, const CandidatePair& kept, int axis) const {
  const auto crossed = [&](std::size_t n) {
    return bodies.image[rows_.of_snapshot[n]][axis] - snapshots_[n].image[axis];
  };
  return crossed(kept.row_b) - crossed(kept.row_a);
}

/// Computes the current image of b. Returns whether it is one through which bodies meet.
bool VerletList::image_now(const BodySet& bodies, const CandidatePair& kept, Image& image) const {
  std::int8_t* const of_pair[3] = {&image.x, &image.y, &image.z};
  for (int d = 0; d < 3; ++d) {
    const std::int32_t now = *of_pair[d] + image_change(bodies, kept, d);
    if (now < -1 || now > 1) return false;
    *of_pair[d] = static_cast<std::int8_t>(now);
  }
  return true;
}

void VerletList::select(const Surroundings& around, std::span<const WallSurface> walls,
                        std::vector<CandidatePair>& pairs) const {
  auto near = near_walls_.begin();
  const auto append_walls = [&](auto&& of) {  // after the pairs of bodies, since walls have higher ids
    for (; near != near_walls_.end() && of(snapshots_[near->snapshot].id); ++near)
      if (const std::uint32_t row = rows_.of_snapshot[near->snapshot];
          row != none && around.meets(row, walls[near->wall]))
        pairs.push_back({row, around.size() + near->wall, Image{}});
  };
  for (const CandidatePair& kept : pairs_) {
    append_walls([&](BodyId id) { return id < snapshots_[kept.row_a].id; });
    CandidatePair p{rows_.of_snapshot[kept.row_a], rows_.of_snapshot[kept.row_b], kept.image};
    if (p.row_a == none || p.row_b == none) continue;
    if (wrapped_ && !image_now(around.bodies, kept, p.image)) continue;
    if (around.meet(p)) pairs.push_back(p);
  }
  append_walls([](BodyId) { return true; });
}

// ---- newcomers: bodies that arrived after the search, such as new copies on this rank ----

/// Pairs the newcomers with all other bodies. Returns whether the list is complete then.
bool VerletList::add_newcomers(const Surroundings& around, const Vec3& common) {
  if (rows_.newcomers.size() > most_newcomers) return false;
  if ((snapshots_.size() + rows_.newcomers.size()) * share_in_all >
      rows_.snapshot.size() * (share_in_all + 1))
    return false;
  added_.clear();
  for (const std::uint32_t row : rows_.newcomers) {
    const auto n = static_cast<std::uint32_t>(snapshots_.size());
    const double reach = around.reach[row].sum();
    plan_.largest = std::max(plan_.largest, reach + plan_.typical.to_bodies);
    if (!one_image_is_in_reach()) return false;
    add_snapshot(around, row, plan_.typical, common);
    rows_.of_snapshot.push_back(row);
    rows_.snapshot[row] = n;
    walls_outdated_.push_back(n);
    pair_with_all(around, n, common);
  }
  const auto before = pair_order([&](std::size_t n) { return snapshots_[n].id; });
  std::sort(added_.begin(), added_.end(), before);
  const auto kept = static_cast<std::ptrdiff_t>(pairs_.size());
  pairs_.insert(pairs_.end(), added_.begin(), added_.end());
  std::inplace_merge(pairs_.begin(), pairs_.begin() + kept, pairs_.end(), before);
  return true;
}

/// Returns whether only the nearest image of a body can be within reach.
bool VerletList::one_image_is_in_reach() const {
  for (int d = 0; d < 3; ++d)
    if (extent_.periodic[d] && extent_.size[d] <= 4 * plan_.largest) return false;
  return true;
}

/// Adds the pairs of the n-th body with earlier ones that can come within reach before either uses up its
/// slack, counted from the other's snapshot.
void VerletList::pair_with_all(const Surroundings& around, std::size_t n, const Vec3& common) {
  const BodySet& bodies = around.bodies;
  const Snapshot& own = snapshots_[n];
  for (std::size_t other = 0; other < n; ++other) {
    const Snapshot& snapshot = snapshots_[other];
    if (rows_.of_snapshot[other] == none || (!snapshot.dynamic && !own.dynamic)) continue;
    Vec3 between = bodies.position[rows_.of_snapshot[other]] - own.position, periods = Vec3::Zero();
    for (int d = 0; d < 3; ++d)
      if (extent_.periodic[d]) periods[d] = std::round(between[d] / extent_.size[d]);
    between -= periods.cwiseProduct(extent_.size);
    const double square = between.squaredNorm() * (1 - rounding);
    const double range = own.reach + own.slack.to_bodies + snapshot.reach + snapshot.slack.to_bodies,
                 most = range + snapshot.reach +
                        snapshot.slack.to_bodies;  // bound on the distance of the snapshots
    if (square > most * most) continue;
    const double exact = range + snapshot.relative(displacement_of(around, other), common).norm();
    if (square > exact * exact) continue;
    CandidatePair pair{n, other, {}};
    if (snapshot.id < own.id) std::swap(pair.row_a, pair.row_b), periods = -periods;
    std::int8_t* const of_pair[3] = {&pair.image.x, &pair.image.y, &pair.image.z};
    for (int d = 0; d < 3; ++d)  // the image as of both snapshots
      *of_pair[d] = static_cast<std::int8_t>(-periods[d] - image_change(bodies, pair, d));
    added_.push_back(pair);
  }
}

// ---- walls within a body's slack ----

/// Lists the walls within the body's slack, and stores its distance to the nearest other wall.
template <class List>
void VerletList::update_walls(const Surroundings& around, std::span<const WallSurface> walls, std::uint32_t n,
                              List&& list) {
  Snapshot& snapshot = snapshots_[n];
  const std::size_t row = rows_.of_snapshot[n];
  snapshot.at_walls = displacement_of(around, n);
  snapshot.to_next_wall = unlimited;
  if (!snapshot.dynamic) return;
  const double near = around.reach[row].sum() + snapshot.slack.to_walls;
  for (std::uint32_t w = 0; w < walls.size(); ++w) {
    const double distance = walls[w].distance(around.bodies.position[row]);
    if (distance > near)
      snapshot.to_next_wall = std::min(snapshot.to_next_wall, distance - snapshot.reach);
    else
      list(w);
  }
}

/// Updates the walls of all bodies that have used up their slack to walls or are new.
void VerletList::update_walls(const Surroundings& around, std::span<const WallSurface> walls) {
  if (walls.empty() || walls_outdated_.empty()) return;
  const auto before = [&](const NearWall& p, const NearWall& q) {
    return std::tuple(snapshots_[p.snapshot].id, p.snapshot, p.wall) <
           std::tuple(snapshots_[q.snapshot].id, q.snapshot, q.wall);
  };
  const auto known = static_cast<std::ptrdiff_t>(near_walls_.size());
  for (const std::uint32_t n : walls_outdated_)
    update_walls(around, walls, n, [&](std::uint32_t wall) {
      const NearWall near{n, wall};
      if (!std::binary_search(near_walls_.begin(), near_walls_.begin() + known, near, before))
        near_walls_.push_back(near);
    });
  std::sort(near_walls_.begin() + known, near_walls_.end(), before);
  std::inplace_merge(near_walls_.begin(), near_walls_.begin() + known, near_walls_.end(), before);
}

void BroadPhase::sort_into(const BodySet& bodies, std::vector<CandidatePair>& pairs) {
  pairs.clear();
  if (found_.empty()) return;
  // a counting sort by the lower id; then each body's few partners are sorted
  const std::size_t n = bodies.first_wall();
  order_.resize(n);
  std::iota(order_.begin(), order_.end(), 0u);
  std::sort(order_.begin(), order_.end(), [&](auto i, auto j) { return bodies.id[i] < bodies.id[j]; });
  rank_.resize(n);
  for (std::size_t k = 0; k < n; ++k) rank_[order_[k]] = static_cast<std::uint32_t>(k);
  start_.assign(n + 1, 0);
  for (const CandidatePair& p : found_) ++start_[rank_[p.row_a] + 1];
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  pairs.resize(found_.size());
  std::vector<std::uint32_t>& next = order_;
  std::copy(start_.begin(), start_.end() - 1, next.begin());
  for (const CandidatePair& p : found_) pairs[next[rank_[p.row_a]]++] = p;
  for (std::size_t k = 0; k < n; ++k)
    std::sort(pairs.begin() + start_[k], pairs.begin() + start_[k + 1], [&](const auto& p, const auto& q) {
      return std::tuple(bodies.id[p.row_b], p.image) < std::tuple(bodies.id[q.row_b], q.image);
    });
}

/// Finds pairs within reach, or within reach plus slack if a Verlet list is worthwhile.
void BroadPhase::find_candidates(const Surroundings& around, std::span<const WallSurface> walls) {
  const std::span slack = list_.plan(around);
  wider_.assign(around.reach.begin(), around.reach.end());
  for (std::size_t row = 0; row < around.size(); ++row) wider_[row].margin += slack[row].to_bodies;
  found_.clear();
  find_pairs({around.bodies, around.extent, wider_}, found_);
  sort_into(around.bodies, list_.renew(around, walls));
}

void BroadPhase::operator()(const BodySet& bodies, const Extent& extent, std::span<const Reach> reach,
                            std::span<const WallSurface> walls, std::vector<CandidatePair>& pairs) {
  pairs.clear();
  const Surroundings around{bodies, extent, reach};
  if (around.size() == 0) return;
  if (!list_.is_valid(around, walls)) find_candidates(around, walls);
  list_.select(around, walls, pairs);
}

}  // namespace silt::rigid
