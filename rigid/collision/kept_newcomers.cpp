// Bodies that have come since the pairs were found, as copies on a rank of many do.
#include <algorithm>
#include <cmath>

#include "rigid/collision/kept_pairs.hpp"

namespace silt::rigid {

namespace {

constexpr std::size_t most_in_a_call = 40;  // of more, finding all pairs anew costs less
constexpr std::size_t share_in_all = 4;     // of the bodies: as much as one in so many may have come
constexpr double rounding = 1e-12;          // relative, of distances

}  // namespace

/// Looks at the newcomers with all the others. Returns whether it did: all is sure then.
bool KeptPairs::take_in(const Surroundings& around, const Vec3& common) {
  const BodySet& bodies = around.bodies;
  if (newcomers_.size() > most_in_a_call) return false;
  if ((seen_.size() + newcomers_.size()) * share_in_all > seen_of_row_.size() * (share_in_all + 1))
    return false;
  added_.clear();
  for (const std::uint32_t row : newcomers_) {
    const auto n = static_cast<std::uint32_t>(seen_.size());
    const double reach = around.reach[row].sum();
    largest_ = std::max(largest_, reach + typical_.to_bodies);
    if (!one_image_is_in_reach()) return false;
    seen_.push_back({bodies.id[row], bodies.position[row], common, bodies.image[row], bodies.is_dynamic(row),
                     calls_, reach, typical_, Vec3::Zero(), unlimited});
    row_of_seen_.push_back(row);
    seen_of_row_[row] = n;
    to_look_at_.push_back(n);
    pair_with_all(around, n, common);
  }
  const auto before = [&](const CandidatePair& p, const CandidatePair& q) {
    return std::tuple(seen_[p.row_a].id, seen_[p.row_b].id, p.image) <
           std::tuple(seen_[q.row_a].id, seen_[q.row_b].id, q.image);
  };
  std::sort(added_.begin(), added_.end(), before);
  const auto kept = static_cast<std::ptrdiff_t>(pairs_.size());
  pairs_.insert(pairs_.end(), added_.begin(), added_.end());
  std::inplace_merge(pairs_.begin(), pairs_.begin() + kept, pairs_.end(), before);
  return true;
}

/// No other image of a body than the nearest can meet another.
bool KeptPairs::one_image_is_in_reach() const {
  for (int d = 0; d < 3; ++d)
    if (extent_.periodic[d] && extent_.size[d] <= 4 * largest_) return false;
  return true;
}

/// Adds the pairs of the n-th with those before it that may come to meet it, while neither uses up its slack:
/// another one may go back from where it is.
void KeptPairs::pair_with_all(const Surroundings& around, std::size_t n, const Vec3& common) {
  const BodySet& bodies = around.bodies;
  const Seen& own = seen_[n];
  for (std::size_t other = 0; other < n; ++other) {
    const Seen& seen = seen_[other];
    if (row_of_seen_[other] == none || (!seen.dynamic && !own.dynamic)) continue;
    Vec3 between = bodies.position[row_of_seen_[other]] - own.position, periods = Vec3::Zero();
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

}  // namespace silt::rigid
