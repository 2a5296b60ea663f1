#include "rigid/collision/broad_phase.hpp"

#include <algorithm>
#include <numeric>

namespace silt::rigid {

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
