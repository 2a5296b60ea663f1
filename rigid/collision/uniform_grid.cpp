#include "rigid/collision/uniform_grid.hpp"

#include <algorithm>
#include <cmath>

namespace silt::rigid {

void UniformGrid::build_levels(const Surroundings& around) {
  // the level of a body is the power of two, counted from the smallest body, below which its reach is
  constexpr int most_levels = 24;  // size ratios beyond 2^23 share the last level
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

/// Sets cells across which two bodies of the level cannot reach. The keys leave room for two cells on each
/// side, so that a neighbour's key is never that of another cell.
void UniformGrid::set_cells(Level& level, const Surroundings& around, double largest_reach) {
  level.largest_reach = largest_reach;
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

/// Cells beyond the level's outermost bodies count as the first one beyond.
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

/// Sorts the bodies of one level by their cells in the grid of another, by radix sort.
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
                 around.bodies.is_dynamic(row)};
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

/// Writes the cells x + first_offset to x + 1 along x, split into runs at periodic sides.
int UniformGrid::Level::runs(std::int32_t x, int first_offset, std::array<Run, 3>& out) const {
  int count = 0;
  for (int offset = first_offset; offset <= 1; ++offset) {
    std::int8_t image;
    const std::int32_t cell = stepped(0, x + offset, image);
    if (count > 0 && out[count - 1].image == image)
      out[count - 1].last = cell;
    else
      out[count++] = {cell, cell, image};
  }
  return count;
}

/// Wraps a cell's index into the grid along a periodic axis and sets `image` to that of the bodies there.
std::int32_t UniformGrid::Level::stepped(int axis, std::int32_t cell, std::int8_t& image) const {
  const std::int32_t n = cells[axis];
  image = n == 0 || (cell >= 0 && cell < n) ? 0 : cell < 0 ? -1 : 1;
  return cell - image * n;
}

/// Finds pairs of a body of `from` and one of `in`, whose grid this is. A row of three cells along x is
/// consecutive and searched at once. Within a level half of the rows suffices.
void UniformGrid::search(const Surroundings& around, const Level& level, const std::vector<Entry>& from,
                         const std::vector<Entry>& in, bool same_level, std::vector<CandidatePair>& found) {
  constexpr int own_row = 4, images = 27;
  std::array<std::array<std::uint32_t, images>, 9> cursors{};  // by row and periodic image
  std::array<Run, 3> whole, own_half;
  int whole_count = 0, own_count = 0;
  Cell c{};
  std::int64_t last_key = -1;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const Entry& own = from[k];
    if (own.key != last_key) {
      c = level.cell_of(own.position);
      whole_count = level.runs(c[0], -1, whole);
      own_count = level.runs(c[0], 0, own_half);
    }
    last_key = own.key;
    for (int row = same_level ? own_row : 0; row < 9; ++row) {
      const bool half = same_level && row == own_row;
      Image image;
      const std::int32_t y = level.stepped(1, c[1] + row % 3 - 1, image.y),
                         z = level.stepped(2, c[2] + row / 3 - 1, image.z);
      for (int r = 0; r < (half ? own_count : whole_count); ++r) {
        const Run& run = half ? own_half[r] : whole[r];
        image.x = run.image;
        const std::int64_t first = level.key_of({run.first, y, z}), last = first + run.last - run.first;
        std::uint32_t& cursor = cursors[row][(image.x + 1) + 3 * (image.y + 1) + 9 * (image.z + 1)];
        while (cursor < in.size() && in[cursor].key < first) ++cursor;
        for (std::size_t e = half && r == 0 ? k + 1 : cursor; e < in.size() && in[e].key <= last; ++e)
          add_if_near(around, own, in[e], image, found);
      }
    }
  }
}

/// Returns the range of cells that can contain bodies of this level within the distance; along a periodic
/// axis it spans three images, from -cells on.
UniformGrid::Run UniformGrid::Level::cells_within(int axis, double x, double distance) const {
  const std::int32_t n = cells[axis], least = n ? -n : lowest[axis], most = n ? 2 * n - 1 : highest[axis];
  constexpr double rounding = 1e-9;  // cells
  const auto cell = [&](double at) {
    return static_cast<std::int32_t>(std::clamp<double>(std::floor(at), least, most));
  };
  return {cell((x - distance) / width[axis] - rounding), cell((x + distance) / width[axis] + rounding), 0};
}

/// Estimates the number of rows of cells to be searched for a body of this reach.
double UniformGrid::Level::rows_around(double reach) const {
  double rows = 1;
  for (int d = 1; d < 3; ++d) {
    const double most = cells[d] ? 3.0 * cells[d] : highest[d] - lowest[d] + 1.0;
    rows *= std::min(most, 2 * (reach + largest_reach) / width[d] + 1);
  }
  return rows;
}

/// Finds pairs of a large body and one of `in`, sorted by the cells of `grid`.
void UniformGrid::search_around(const Surroundings& around, const Level& large, const Level& grid,
                                const std::vector<Entry>& in, std::vector<CandidatePair>& found) {
  for (const std::uint32_t row : large.rows) {
    const Entry own{0,   around.bodies.id[row],        around.bodies.position[row], around.reach[row].sum(),
                    row, around.bodies.is_dynamic(row)};
    std::array<Run, 3> within;
    for (int d = 0; d < 3; ++d)
      within[d] = grid.cells_within(d, own.position[d], own.reach + grid.largest_reach);
    Image image;
    for (std::int32_t z = within[2].first; z <= within[2].last; ++z)
      for (std::int32_t y = within[1].first; y <= within[1].last; ++y)
        for (std::int32_t x = within[0].first, last; x <= within[0].last; x = last + 1) {
          const Cell cell{grid.stepped(0, x, image.x), grid.stepped(1, y, image.y),
                          grid.stepped(2, z, image.z)};
          const std::int32_t n = grid.cells[0];
          last = n ? std::min(within[0].last, x + n - 1 - cell[0]) : within[0].last;  // in the same image
          const std::int64_t first_key = grid.key_of(cell), last_key = first_key + (last - x);
          for (auto e = std::lower_bound(in.begin(), in.end(), first_key,
                                         [](const Entry&entry, std::int64_t key) { return entry.key < key; });
               e != in.end() && e->key <= last_key; ++e)
            add_if_near(around, own, *e, image, found);
        }
  }
}

void UniformGrid::add_if_near(const Surroundings& around, const Entry& own, const Entry& other, Image image,
                              std::vector<CandidatePair>& found) {
  if (other.id == own.id || (!own.dynamic && !other.dynamic)) return;
  const bool first = own.id < other.id;
  const CandidatePair pair =
      first ? CandidatePair{own.row, other.row, image} : CandidatePair{other.row, own.row, opposite(image)};
  const Vec3 &a = first ? own.position : other.position, &b = first ? other.position : own.position;
  if (around.near(a, b, pair.image, own.reach + other.reach)) found.push_back(pair);
}

void UniformGrid::find_pairs(const Surroundings& around, std::vector<CandidatePair>& found) {
  build_levels(around);
  entries_.resize(levels_.size());
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const Level& large = levels_[k];
    sort_by_cell(around, large, large, entries_[k]);
    search(around, large, entries_[k], entries_[k], true, found);
    for (std::size_t j = 0; j < k; ++j) {
      const Level& small = levels_[j];
      constexpr double rows_of_a_small_one = 5;  // cost of a small body's search, in rows
      if (small.rows_around(large.largest_reach) * double(large.rows.size()) <
          rows_of_a_small_one * double(small.rows.size())) {
        search_around(around, large, small, entries_[j], found);
        continue;
      }
      sort_by_cell(around, small, large, others_);
      search(around, large, others_, entries_[k], false, found);
    }
  }
}

}  // namespace silt::rigid
