#include "rigid/uniform_grid.hpp"

#include <algorithm>
#include <cmath>

namespace silt::rigid {

void UniformGrid::build_levels(const Surroundings& around) {
  // level of a body: the power of two its reach (radius + margin) fits under, counted from the smallest
  constexpr int most_levels = 24;  // size ratios beyond 2^23 share the last
  levels_.clear();
  double least = around.reach[0].sum();
  for (std::size_t row = 0; row < around.size(); ++row) least = std::min(least, around.reach[row].sum());
  std::array<Level, most_levels> levels;
  std::array<double, most_levels> largest{};
  for (std::size_t row = 0; row < around.size(); ++row) {
    const double r = around.reach[row].sum();
    const int level = least > 0 ? std::clamp(std::ilogb(r / least), 0, most_levels - 1) : 0;
    levels[level].rows.push_back(static_cast<std::uint32_t>(row));
    largest[level] = std::max(largest[level], r);
  }
  for (int k = 0; k < most_levels; ++k) {
    if (levels[k].rows.empty()) continue;
    set_cells(levels[k], around, largest[k]);
    levels_.push_back(std::move(levels[k]));
  }
}

/// Cells that two bodies of the level cannot reach across. Their keys leave room for two cells on each side,
/// so that a neighbour's key is never that of another cell.
void UniformGrid::set_cells(Level& level, const Surroundings& around, double largest_reach) {
  const double wanted = largest_reach > 0 ? 2 * largest_reach * (1 + 1e-12) : 1.0;
  for (int d = 0; d < 3; ++d) {
    const double size = around.extent.size[d];
    const bool periodic = around.extent.periodic[d];
    level.cells[d] =
        periodic ? static_cast<std::int32_t>(std::clamp(std::floor(size / wanted), 1.0, 1e6)) : 0;
    level.width[d] = periodic ? size / level.cells[d] : wanted;
  }
  constexpr std::int32_t far = 1 << 19;
  level.lowest.fill(-far);
  level.highest.fill(far);
  Cell lowest = level.highest, highest = level.lowest;
  for (const std::uint32_t row : level.rows) {
    const Cell c = level.cell_of(around.bodies.position[row]);
    for (int d = 0; d < 3; ++d) {
      lowest[d] = std::min(lowest[d], c[d]);
      highest[d] = std::max(highest[d], c[d]);
    }
  }
  std::int64_t stride = 1;
  for (int d = 0; d < 3; ++d) {
    level.lowest[d] = level.cells[d] ? 0 : lowest[d];
    level.highest[d] = level.cells[d] ? level.cells[d] - 1 : highest[d];
    level.stride[d] = stride;
    stride *= level.highest[d] - level.lowest[d] + 5;
  }
}

/// One beyond the level's outermost bodies stands for everything further out.
UniformGrid::Cell UniformGrid::Level::cell_of(const Vec3& x) const {
  Cell c;
  for (int d = 0; d < 3; ++d) {
    const int beyond = cells[d] ? 0 : 1;
    c[d] = static_cast<std::int32_t>(
        std::clamp<double>(std::floor(x[d] / width[d]), lowest[d] - beyond, highest[d] + beyond));
  }
  return c;
}

std::int64_t UniformGrid::Level::key_of(const Cell& c) const {
  std::int64_t key = 0;
  for (int d = 0; d < 3; ++d) key += stride[d] * (c[d] - lowest[d] + 2);
  return key;
}

/// The bodies of one level by their cells in the grid of another: least significant digit first.
void UniformGrid::sort_by_cell(const Surroundings& around, const Level& of, const Level& grid,
                               std::vector<Entry>& sorted) {
  constexpr int bits = 11;
  constexpr std::uint64_t mask = (1u << bits) - 1;
  std::int64_t largest = 0;
  sorted.resize(of.rows.size());
  unsorted_.resize(of.rows.size());
  for (std::size_t k = 0; k < of.rows.size(); ++k) {
    const std::uint32_t row = of.rows[k];
    const Vec3& x = around.bodies.position[row];
    sorted[k] = {grid.key_of(grid.cell_of(x)), around.bodies.id[row], x, around.reach[row].sum(), row,
                 around.bodies.is_free(row)};
    largest = std::max(largest, sorted[k].key);
  }
  for (int shift = 0; largest >> shift; shift += bits) {
    std::swap(sorted, unsorted_);
    std::array<std::uint32_t, mask + 2> next{};
    for (const Entry& e : unsorted_) ++next[((e.key >> shift) & mask) + 1];
    for (std::size_t digit = 1; digit < next.size(); ++digit) next[digit] += next[digit - 1];
    for (const Entry& e : unsorted_) sorted[next[(e.key >> shift) & mask]++] = e;
  }
}

/// Pairs of a body of `from` and one of `in`, whose grid this is. Within a level only the offsets of one half
/// are looked at, and in a body's own cell those after it.
void UniformGrid::search(const Surroundings& around, const Level& level, const std::vector<Entry>& from,
                         const std::vector<Entry>& in, bool same_level, std::vector<CandidatePair>& found) {
  const auto periodic_step = [&](int d, std::int32_t cell, std::int8_t& image) {
    const std::int32_t n = level.cells[d];
    image = n == 0 || (cell >= 0 && cell < n) ? 0 : cell < 0 ? -1 : 1;
    return image == 0 ? cell : cell - image * n;
  };
  std::array<std::array<std::uint32_t, 8>, 27> cursors{};
  Cell c;
  std::int64_t last_key = -1;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const Entry& own = from[k];
    if (own.key != last_key) c = level.cell_of(own.position);
    last_key = own.key;
    for (int offset = same_level ? 13 : 0; offset < 27; ++offset) {
      Image image;
      const Cell there{periodic_step(0, c[0] + offset % 3 - 1, image.x),
                       periodic_step(1, c[1] + offset / 3 % 3 - 1, image.y),
                       periodic_step(2, c[2] + offset / 9 - 1, image.z)};
      const std::int64_t key = level.key_of(there);
      const int crossed = (image.x != 0) + 2 * (image.y != 0) + 4 * (image.z != 0);
      std::uint32_t& cursor = cursors[offset][crossed];
      while (cursor < in.size() && in[cursor].key < key) ++cursor;
      const bool own_cell = same_level && offset == 13;
      for (std::size_t e = own_cell ? k + 1 : cursor; e < in.size() && in[e].key == key; ++e) {
        const Entry& other = in[e];
        if (other.id == own.id || (!own.free && !other.free)) continue;
        const double range = own.reach + other.reach;
        const bool first = own.id < other.id;
        const CandidatePair pair = first ? CandidatePair{own.row, other.row, image}
                                         : CandidatePair{other.row, own.row, opposite(image)};
        const Vec3 &a = first ? own.position : other.position, &b = first ? other.position : own.position;
        if (around.near(a, b, pair.image, range)) found.push_back(pair);
      }
    }
  }
}

void UniformGrid::find_pairs(const Surroundings& around, std::vector<CandidatePair>& found) {
  build_levels(around);
  for (const Level& large : levels_) {
    sort_by_cell(around, large, large, entries_);
    search(around, large, entries_, entries_, true, found);
    for (const Level* small = levels_.data(); small != &large; ++small) {
      sort_by_cell(around, *small, large, others_);
      search(around, large, others_, entries_, false, found);
    }
  }
}

}  // namespace silt::rigid
