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
  if ((seen_.size() + newcomers_.size()) * share_in_all > numbers_.size() * (share_in_all + 1)) return false;
  added_.clear();
  for (const std::uint32_t row : newcomers_) {
    const auto n = static_cast<std::uint32_t>(seen_.size());
    const double reach = around.reach[row].sum();
    largest_ = std::max(largest_, reach + typical_.to_bodies);
    if (!one_image_is_in_reach()) return false;
    seen_.push_back({bodies.id[row], bodies.position[row], common, bodies.image[row], bodies.is_dynamic(row),
                     calls_, reach, typical_, Vec3::Zero(), no_end});
    rows_.push_back(row);
    numbers_[row] = n;
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
    if (rows_[other] == none || (!seen.dynamic && !own.dynamic)) continue;
    Vec3 between = bodies.position[rows_[other]] - own.position;
    for (int d = 0; d < 3; ++d)
      if (extent_.periodic[d]) between[d] -= extent_.size[d] * std::round(between[d] / extent_.size[d]);
    const double square = between.squaredNorm() * (1 - rounding);
    const double range = own.reach + own.slack.to_bodies + seen.reach + seen.slack.to_bodies,
                 most = range + seen.reach + seen.slack.to_bodies;  // of what it may be from where it was
    if (square > most * most) continue;
    const double exact = range + apart(around, other, common).norm();
    if (square > exact * exact) continue;
    const bool first = own.id < seen.id;
    const std::size_t a = first ? n : other, b = first ? other : n;
    added_.push_back({a, b, image_stored(bodies, a, b)});
  }
}

/// The image of b seen from a that is nearest, as it would have been when both were seen.
Image KeptPairs::image_stored(const BodySet& bodies, std::size_t a, std::size_t b) const {
  const std::size_t row_a = rows_[a], row_b = rows_[b];
  const Vec3 between = bodies.position[row_b] - bodies.position[row_a];
  std::array<std::int8_t, 3> image{};
  for (int d = 0; d < 3; ++d) {
    if (!extent_.periodic[d]) continue;
    const auto now = -static_cast<std::int32_t>(std::round(between[d] / extent_.size[d]));
    image[d] = static_cast<std::int8_t>(now - (bodies.image[row_b][d] - seen_[b].image[d]) +
                                        (bodies.image[row_a][d] - seen_[a].image[d]));
  }
  return {image[0], image[1], image[2]};
}

}  // namespace silt::rigid
