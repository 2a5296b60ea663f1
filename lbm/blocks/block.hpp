#pragma once
// The populations of one block of cells and its ghost layer, streamed in place by the AA pattern (method.md,
// equations 1 and 8): one array of deviations from rest per direction, x fastest.
//
// Slot (x, i) is element i of cell x. Where the population that arrives at x along i is stored between two
// steps depends on the parity of the steps done so far:
//
//     parity    population i arriving at x      population i leaving x (= arriving at x + c_i)
//     settled   slot (x, i)                     slot (x + c_i, i)
//     crossed   slot (x - c_i, opposite i)      slot (x, opposite i)
//
// Code outside the kernel finds a slot with `arriving` and `leaving` alone.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "device/device.hpp"
#include "lbm/blocks/excess.hpp"
#include "lbm/blocks/large_memory.hpp"
#include "lbm/blocks/lattice.hpp"

namespace silt::lbm {

enum class Parity : std::uint8_t { settled = 0, crossed = 1 };
inline Parity flipped(Parity p) {
  return p == Parity::settled ? Parity::crossed : Parity::settled;
}

/// Rows [y0, y1) of the planes [z0, z1) of a block.
struct RowRange {
  int y0, y1, z0, z1;
};

/// A population that leaves a row at its end moves to the other end of the row, or returns from a wall, which
/// adds `addend` by its motion. The slots are offsets from those of the row's first cell.
template <class T>
struct RowEnd {
  std::ptrdiff_t from, to;
  bool wall;
  T addend;
  /// Moves the population; `first` is the place of the row's first cell.
  SILT_DEVICE void move(T* first) const { first[to] = wall ? first[from] + addend : first[from]; }
};

template <class T, class Lattice = D3Q19>
class Block {
 public:
  static constexpr int directions = Lattice::directions;

  /// Allocates zeros. A row has one element more than the block has cells, and a plane one row more: no
  /// direction crosses out of the block on both sides, so the ghost after one row is the ghost before the
  /// next. Rows are not padded on a CPU, where a gap costs the bandwidth of a cache line or more. On a GPU,
  /// whose threads read 32 elements together, each row begins at a multiple of 32 elements.
  explicit Block(const CellBox& box, Device device = Device::cpu) : box_(box), of_array_(box) {
    constexpr int line = 64 / sizeof(T), page = 4096 / sizeof(T), together = 32;  // elements
    row_ = box.size.x + 1;
    if (device != Device::cpu) row_ = (row_ + together - 1) / together * together;
    plane_ = row_ * (box.size.y + 1);
    if (plane_ % page == 0) plane_ += 5 * line;  // planes must not share cache sets
    direction_ = plane_ * (box.size.z + 1) + line;
    constexpr int skew = 27 * line;  // spreads 19 directions evenly over a page, and fewer well enough
    direction_ += (skew - direction_ % page + page) % page;
    if (device != Device::cpu) direction_ = (direction_ + together - 1) / together * together;
    if (device != Device::cpu)
      memory_ = std::static_pointer_cast<T[]>(zeroed_on(device, bytes()));
    else
      memory_ = zeroed<T>(std::size_t(direction_) * directions);
    first_ = memory_.get();
  }
  /// Makes a block that shares another block's array, of cells of array_box(). The slot of a ghost cell is
  /// then the slot of the cell at that place in the array.
  Block(const Block& other, const CellBox& box)
      : box_(box),
        of_array_(other.of_array_),
        row_(other.row_),
        plane_(other.plane_),
        direction_(other.direction_),
        memory_(other.memory_),
        first_(other.first_ + cell(box.lower - other.box_.lower)) {}
  Block(Block&&) = default;
  Block& operator=(Block&&) = default;

  const CellBox& box() const { return box_; }
  Int3 size() const { return box_.size; }
  /// Returns the box of cells for which the array was made.
  const CellBox& array_box() const { return of_array_; }
  bool shares_array(const Block& other) const { return memory_ == other.memory_; }
  /// Returns the size of the array of populations.
  std::size_t bytes() const { return std::size_t(direction_) * directions * sizeof(T); }

  /// The element offset of a cell (ghosts: -1 and size) within a direction, and of a step along c_i.
  std::ptrdiff_t cell(int x, int y, int z) const { return x + row_ * y + plane_ * z; }
  std::ptrdiff_t cell(Int3 x) const { return cell(x.x, x.y, x.z); }
  /// The cell (no ghost) at an offset.
  Int3 cell_at(std::ptrdiff_t offset) const {
    return {int(offset % plane_ % row_), int(offset % plane_ / row_), int(offset / plane_)};
  }
  std::ptrdiff_t step(int i) const { return cell(Lattice::c[i]); }
  std::ptrdiff_t row_stride() const { return row_; }
  std::ptrdiff_t plane_stride() const { return plane_; }

  /// Returns slot (cell 0, i), to which callers add the offset of a cell. Valid for every cell of the block
  /// and for the ghost cells that a population enters along i; no other ghost cell has a slot. The array of
  /// direction i begins with the first such slot.
  std::ptrdiff_t slot(int i) const {
    return direction_ * i -
           cell(std::min(Lattice::c[i].x, 0), std::min(Lattice::c[i].y, 0), std::min(Lattice::c[i].z, 0));
  }
  /// Returns the slot in the middle of the array, from which all offsets fit 32 bits.
  std::ptrdiff_t middle() const { return slot(directions / 2); }
  std::ptrdiff_t arriving(int i, Parity p) const {
    return p == Parity::settled ? slot(i) : slot(opposite(i)) - step(i);
  }
  std::ptrdiff_t leaving(int i, Parity p) const {
    return p == Parity::settled ? slot(i) + step(i) : slot(opposite(i));
  }
  /// Returns the excess of the cells, indexed by their offsets; null before the first hold_excess().
  ExcessQuanta<T>* excess() { return excess_.get(); }
  const ExcessQuanta<T>* excess() const { return excess_.get(); }
  /// Returns the number of elements of excess(): up to the last cell of the block, and the rest of its
  /// vector.
  std::size_t excess_cells() const {
    constexpr int most_lanes = 16;
    return std::size_t(cell(box_.size.x, box_.size.y - 1, box_.size.z - 1)) + most_lanes;
  }
  /// Returns whether cells of a row may have an excess.
  bool has_excess(int y, int z) const { return excess_ && excess_rows_[y + box_.size.y * z]; }
  /// Returns the share of their bulk stress that cells with an excess give up together with it.
  T stress_share() const { return stress_share_; }
  /// Declares that cells in rows [y0, y1) of planes [z0, z1) may have links. Calls add up.
  void hold_excess(const RowRange& rows, T stress_share, Device device = Device::cpu) {
    stress_share_ = stress_share;
    if (!excess_) {
      const std::size_t cells = excess_cells();
      if (device != Device::cpu)
        excess_ =
            std::static_pointer_cast<ExcessQuanta<T>[]>(zeroed_on(device, cells * sizeof(ExcessQuanta<T>)));
      else
        excess_ = zeroed<ExcessQuanta<T>>(cells);
      excess_rows_.assign(std::size_t(box_.size.y) * box_.size.z, 0);
    }
    for (int z = std::max(rows.z0, 0); z < std::min(rows.z1, box_.size.z); ++z)
      for (int y = std::max(rows.y0, 0); y < std::min(rows.y1, box_.size.y); ++y)
        excess_rows_[y + box_.size.y * z] |= has_links;
  }
  /// Declares that no cell has links any more. Excess that is left stays until the next pass; rows may have
  /// it until the next call of this function.
  void hold_no_more_excess() {
    for (std::uint8_t& row : excess_rows_) row = row & has_links ? had_links : 0;
  }
  /// The temperature of the cells, which the fluid carries; null: none.
  Block<T, D3Q7>* temperature() const { return temperature_; }
  void carry(Block<T, D3Q7>& temperature) { temperature_ = &temperature; }
  T* data() { return first_; }
  const T* data() const { return first_; }

  /// Returns the ghost slots (halo.hpp) that each row exchanges with itself or a wall, by the parity at the
  /// start of a pass. The dense pass moves their populations at the row's ends while they are cached.
  const std::vector<RowEnd<T>>& row_ends(Parity p) const { return row_ends_[int(p)]; }
  void add_row_end(Parity p, const RowEnd<T>& end) { row_ends_[int(p)].push_back(end); }
  void clear_row_ends() {
    for (auto& ends : row_ends_) ends.clear();
  }
  /// Moves the populations at the ends of the row that begins with the cell at this offset.
  [[gnu::always_inline]] void close_row(std::ptrdiff_t first, Parity parity) {
    for (const RowEnd<T>& end : row_ends(parity)) end.move(first_ + first);
  }

 private:
  CellBox box_, of_array_;
  std::ptrdiff_t row_, plane_, direction_;
  std::shared_ptr<T[]> memory_;
  T* first_;  // slot (cell 0, 0)
  std::shared_ptr<ExcessQuanta<T>[]> excess_;
  T stress_share_ = 0;
  static constexpr std::uint8_t has_links = 1, had_links = 2;
  std::vector<std::uint8_t> excess_rows_;  // y fastest: has_links, had_links or 0
  std::vector<RowEnd<T>> row_ends_[2];
  Block<T, D3Q7>* temperature_ = nullptr;
};

}  // namespace silt::lbm
