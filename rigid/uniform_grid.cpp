#include "rigid/uniform_grid.hpp"

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

}  // namespace

void UniformGrid::build_levels(const Surroundings& around) {
  // level of a body: the power of two its reach (radius + margin) fits under, counted from the smallest
  constexpr int most_levels = 24;  // size ratios beyond 2^23 share the last
  levels_.clear();
  const Extent& extent = around.extent;
  double least = around.reach[0].sum();
  for (std::size_t row = 0; row < around.size(); ++row) least = std::min(least, around.reach[row].sum());
  std::array<std::vector<std::uint32_t>, most_levels> members;
  std::array<double, most_levels> largest{};
  for (std::size_t row = 0; row < around.size(); ++row) {
    const double r = around.reach[row].sum();
    const int level = least > 0 ? std::clamp(std::ilogb(r / least), 0, most_levels - 1) : 0;
    members[level].push_back(static_cast<std::uint32_t>(row));
    largest[level] = std::max(largest[level], r);
  }
  for (int k = 0; k < most_levels; ++k) {
    if (members[k].empty()) continue;
    Level level;
    level.rows = std::move(members[k]);
    for (int d = 0; d < 3; ++d) {
      const double wanted = largest[k] > 0 ? 2 * largest[k] * (1 + 1e-12) : 1.0;
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

void UniformGrid::search(const Surroundings& around, std::size_t row, const Level& level, bool same_level,
                         std::vector<CandidatePair>& found) {
  const BodySet& bodies = around.bodies;
  const BodyId id = bodies.id[row];
  const Cell centre = cell_of(level, bodies.position[row]);
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
          const BodyId other_id = bodies.id[entry.row];
          if (other_id == id || (same_level && other_id < id)) continue;
          const CandidatePair pair = around.in_order(row, entry.row, other_image);
          if (around.meet(pair)) found.push_back(pair);
        }
      }
    }
  }
}

void UniformGrid::find_pairs(const Surroundings& around, std::vector<CandidatePair>& found) {
  build_levels(around);
  for (Level& level : levels_) fill(level, around.bodies);
  for (std::size_t small = 0; small < levels_.size(); ++small)
    for (std::size_t large = small; large < levels_.size(); ++large)
      for (const std::uint32_t row : levels_[small].rows)
        search(around, row, levels_[large], small == large, found);
}

}  // namespace silt::rigid
