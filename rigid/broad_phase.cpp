#include "rigid/broad_phase.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace silt::rigid {

namespace {

using Cell = std::array<std::int32_t, 3>;

std::uint32_t bucket(const Cell& c, std::uint32_t mask) {
  std::uint64_t h = static_cast<std::uint32_t>(c[0]) * 0x9E3779B97F4A7C15ull;
  h ^= static_cast<std::uint32_t>(c[1]) * 0xC2B2AE3D27D4EB4Full;
  h ^= static_cast<std::uint32_t>(c[2]) * 0x165667B19E3779F9ull;
  return static_cast<std::uint32_t>(h >> 32) & mask;
}

Image mirrored(Image i) {
  return {static_cast<std::int8_t>(-i.x), static_cast<std::int8_t>(-i.y), static_cast<std::int8_t>(-i.z)};
}

}  // namespace

void BroadPhase::build_levels(const BodySet& bodies, const Extent& extent, std::span<const Reach> reach) {
  // level of a body: the power of two its reach (radius + margin) fits under, counted from the smallest
  constexpr int most_levels = 24;  // size ratios beyond 2^23 share the last
  levels_.clear();
  const std::size_t count = bodies.first_wall();
  if (count == 0) return;
  double least = reach[0].radius + reach[0].margin;
  for (std::size_t row = 0; row < count; ++row)
    least = std::min(least, reach[row].radius + reach[row].margin);
  std::array<std::vector<std::uint32_t>, most_levels> members;
  std::array<double, most_levels> largest{};
  for (std::size_t row = 0; row < count; ++row) {
    const double r = reach[row].radius + reach[row].margin;
    const int level = least > 0 ? std::clamp(std::ilogb(r / least), 0, most_levels - 1) : 0;
    members[level].push_back(static_cast<std::uint32_t>(row));
    largest[level] = std::max(largest[level], r);
  }
  for (int k = 0; k < most_levels; ++k) {
    if (members[k].empty()) continue;
    Level level;
    level.rows = std::move(members[k]);
    for (int d = 0; d < 3; ++d) {
      const double wanted = 2 * largest[k] * (1 + 1e-12);
      level.cells[d] = extent.periodic[d]
                           ? static_cast<std::int32_t>(std::max(1.0, std::floor(extent.size[d] / wanted)))
                           : 0;
      level.width[d] = extent.periodic[d] ? extent.size[d] / level.cells[d] : wanted;
    }
    levels_.push_back(std::move(level));
  }
}

namespace {

/// The cell of x. Inside [0, cells) along periodic axes; unbounded along the others.
template <class Level>
Cell cell_of(const Level& level, const Vec3& x) {
  Cell c;
  for (int d = 0; d < 3; ++d) {
    constexpr double far = 1e9;  // keeps the index an int32 for bodies that left the domain
    c[d] = static_cast<std::int32_t>(std::clamp(std::floor(x[d] / level.width[d]), -far, far));
    if (level.cells[d]) c[d] = std::clamp(c[d], 0, level.cells[d] - 1);
  }
  return c;
}

template <class Level>
void fill(Level& level, const BodySet& bodies) {
  const std::size_t n = level.rows.size();
  level.mask = std::bit_ceil(static_cast<std::uint32_t>(2 * n)) - 1;
  level.first.assign(level.mask + 2, 0);
  level.entries.resize(n);
  std::vector<std::uint32_t> at(n);
  std::vector<Cell> cells(n);
  for (std::size_t k = 0; k < n; ++k) {
    cells[k] = cell_of(level, bodies.position[level.rows[k]]);
    ++level.first[(at[k] = bucket(cells[k], level.mask)) + 1];
  }
  std::partial_sum(level.first.begin(), level.first.end(), level.first.begin());
  std::vector<std::uint32_t> next(level.first.begin(), level.first.end() - 1);
  for (std::size_t k = 0; k < n; ++k) level.entries[next[at[k]]++] = {cells[k], level.rows[k]};
}

}  // namespace

void BroadPhase::search(const BodySet& bodies, const Extent& extent, std::span<const Reach> reach,
                        std::size_t row, const Level& level, bool same_level) {
  const Vec3& x = bodies.position[row];
  const BodyId id = bodies.id[row];
  const bool free = bodies.is_free(row);
  const Reach own = reach[row];
  const Cell centre = cell_of(level, x);
  Cell c;
  std::array<std::int8_t, 3> image;
  const auto step = [&](int d,
                        int offset) {  // neighbour cell along d and the image it belongs to; false: outside
    c[d] = centre[d] + offset;
    image[d] = 0;
    const std::int32_t n = level.cells[d];
    if (n == 0) return;
    if (c[d] < 0) c[d] += n, image[d] = -1;
    if (c[d] >= n) c[d] -= n, image[d] = 1;
  };
  for (int i = -1; i <= 1; ++i) {
    step(0, i);
    for (int j = -1; j <= 1; ++j) {
      step(1, j);
      for (int k = -1; k <= 1; ++k) {
        step(2, k);
        const std::uint32_t b = bucket(c, level.mask);
        const Image other_image{image[0], image[1], image[2]};
        for (std::uint32_t e = level.first[b]; e < level.first[b + 1]; ++e) {
          const Entry& entry = level.entries[e];
          if (entry.cell != c) continue;
          const std::size_t other = entry.row;
          const BodyId other_id = bodies.id[other];
          if (other_id == id || (same_level && other_id < id)) continue;
          if (!free && !bodies.is_free(other)) continue;
          const double range = own.radius + own.margin + reach[other].radius + reach[other].margin;
          const Vec3 apart = bodies.position[other] + extent.shift(other_image) - x;
          if (apart.squaredNorm() > range * range) continue;
          if (id < other_id)
            found_.push_back({row, other, other_image});
          else
            found_.push_back({other, row, mirrored(other_image)});
        }
      }
    }
  }
}

void BroadPhase::search_walls(const BodySet& bodies, std::span<const Reach> reach,
                              std::span<const Vec3> normals) {
  for (std::size_t w = 0; w < bodies.walls; ++w) {
    const std::size_t wall = bodies.first_wall() + w;
    const double offset = normals[w].dot(bodies.position[wall]);
    for (std::size_t row = 0; row < bodies.first_wall(); ++row)
      if (bodies.is_free(row) &&
          normals[w].dot(bodies.position[row]) - offset <= reach[row].radius + reach[row].margin)
        found_.push_back({row, wall, Image{}});
  }
}

void BroadPhase::sort_into(const BodySet& bodies, std::vector<CandidatePair>& pairs) {
  // by the lower id: counting sort over the ranks of the ids; then each body's few partners by themselves
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

void BroadPhase::operator()(const BodySet& bodies, const Extent& extent, std::span<const Reach> reach,
                            std::span<const Vec3> wall_normals, std::vector<CandidatePair>& pairs) {
  found_.clear();
  pairs.clear();
  build_levels(bodies, extent, reach);
  for (Level& level : levels_) fill(level, bodies);
  for (std::size_t small = 0; small < levels_.size(); ++small)
    for (std::size_t large = small; large < levels_.size(); ++large)
      for (const std::uint32_t row : levels_[small].rows)
        search(bodies, extent, reach, row, levels_[large], small == large);
  search_walls(bodies, reach, wall_normals);
  if (!found_.empty()) sort_into(bodies, pairs);
}

}  // namespace silt::rigid
