#pragma once
// The solid cells of a block, and the bodies that cover them, each with its own bits.
#include <algorithm>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "coupler/mapping/bit_kernel.hpp"
#include "coupler/mapping/bit_window.hpp"
#include "coupler/mapping/cell_bits.hpp"
#include "coupler/mapping/reflection.hpp"
#include "cpu/prefetch.hpp"
#include "lbm/blocks/block.hpp"
#include "lbm/blocks/moments.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

using lbm::for_cells;

/// The cells of a block whose centres are inside one periodic image of a body, or its mirror image beyond a
/// free-slip side, which covers ghost cells alone and these are solid anyhow. Windows reach two cells beyond
/// the cells that the body can cover in the block and its ghost layers.
struct BodyMask {
  rigid::BodyId id = 0;
  std::size_t row = 0;      // in the BodySet, in this step
  lbm::Int3 shift;          // image: cells added to the canonical position (multiples of the domain)
  Reflection reflection;    // of the image
  rigid::Pose pose;         // canonical
  std::int64_t mapped = 0;  // MappedMotion::steps.first
  BitWindow inside;         // centre inside the body
  BitWindow bits;           // of `inside`, those not of walls or lower ids; equal for a mirror image
  bool any = false;         // any bit set in `bits`
  bool hollow = false;      // solid around a tube or hollow mesh
  BitWindow near;           // cells that its links may read; empty until needed
  int before = -1;          // index of the same image in masks_before; -1: new
  bool kept = false;        // neither it nor its links need an update

  const BitFrame& frame() const { return bits.frame(); }
  /// Returns the vector from this image's centre of mass to a cell's centre (global, not wrapped).
  rigid::Vec3 arm(lbm::Int3 cell) const {
    return {(cell.x - shift.x + 0.5) - pose.position[0], (cell.y - shift.y + 0.5) - pose.position[1],
            (cell.z - shift.z + 0.5) - pose.position[2]};
  }
};

/// Calls visit(k) for each mask, with its bits prefetched.
template <class Visit>
void for_masks(const std::vector<BodyMask>& masks, Visit&& visit) {
  for_ahead(
      masks, 4, [](const BodyMask& m) { prefetch_to_read(&m.bits); }, 2,
      [](const BodyMask& m) { m.bits.prefetch(); }, visit);
}

/// The map of one block.
struct BlockMap {
  lbm::CellBox box;
  CellBits walls, solid, before;              // walls with ghosts; walls and bodies; the latter one step ago
  std::vector<BodyMask> masks, masks_before;  // by (id, shift, side of the mirror)
  bool changed = false;                       // in the last mapping
  std::vector<std::uint8_t> changed_rows;     // in the last mapping with a change; see row_changed()

  /// Returns whether a cell of a row, which may be of ghost cells, turned solid or fluid.
  bool row_changed(int y, int z) const {
    constexpr int ghosts = CellBits::ghosts;
    return changed_rows[std::size_t(z + ghosts) * (box.size.y + 2 * ghosts) + (y + ghosts)];
  }
  /// Returns whether a cell is inside the block.
  bool has(lbm::Int3 c) const { return lbm::CellBox{{}, box.size}.contains(c); }
  bool was_and_is_fluid(lbm::Int3 c) const { return !solid.test(c) && !before.test(c); }
  /// Returns whether a cell inside the block is fluid.
  bool has_fluid() const {
    for (int z = 0; z < box.size.z; ++z)
      for (int y = 0; y < box.size.y; ++y)
        for (int x = 0; x < box.size.x; x += 64)
          if (first_cells(~solid.from(x, y, z), box.size.x - x)) return true;
    return false;
  }
};

/// Returns the reference point of an image relative to the frame of its cells.
inline PointInFrame centre_in(const BlockMap& map, const BodyMask& mask, const Reflection& reflection) {
  const rigid::Vec3 x = reflection.point(mask.pose.position);
  return {x[0], x[1], x[2], map.box.lower + mask.inside.frame().low - mask.shift};
}

inline PointInFrame centre_in(const BlockMap& map, const BodyMask& mask) {
  return centre_in(map, mask, mask.reflection);
}

/// Calls visit(block, local cell) for every fluid cell inside the blocks, x fastest.
template <class Visit>
void for_fluid_cells(std::span<const BlockMap> maps, Visit&& visit) {
  for (int b = 0; b < int(maps.size()); ++b)
    for_cells({}, maps[b].box.size, [&](lbm::Int3 x) {
      if (!maps[b].solid.test(x)) visit(b, x);
    });
}

/// Calls visit(runs) for runs of at most most_cells fluid cells along x in a block; rows without a solid cell
/// are joined. The runs are in `memory`.
template <class Visit>
void for_fluid_runs(const BlockMap& map, int most_cells, std::pmr::memory_resource* memory, Visit&& visit) {
  constexpr std::size_t at_once = 2048;
  std::pmr::vector<lbm::LocalRows> runs(memory);
  const auto add = [&](const lbm::LocalRows& run) {
    runs.push_back(run);
    if (runs.size() == at_once) visit(runs), runs.clear();
  };
  const lbm::Int3 size = map.box.size;
  const auto next = [&](lbm::Int3 x, bool solid) {  // next solid or fluid cell of the row, or its end
    for (; x.x < size.x; x.x += 64) {
      const std::uint64_t cells = map.solid.from(x.x, x.y, x.z) ^ (solid ? 0 : ~std::uint64_t{0});
      if (cells) return std::min(x.x + __builtin_ctzll(cells), size.x);
    }
    return size.x;
  };
  const int most_rows = most_cells / size.x;  // 0: rows are too long
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y;) {
      int rows = 0;
      while (rows < most_rows && y + rows < size.y && next({0, y + rows, z}, true) == size.x) ++rows;
      if (rows > 0) {
        add({{0, y, z}, size.x, rows});
        y += rows;
        continue;
      }
      for (lbm::Int3 x{0, y++, z}; (x.x = next(x, false)) < size.x;) {
        const int end = std::min(next(x, true), x.x + most_cells);
        add({x, end - x.x, 1});
        x.x = end;
      }
    }
  visit(runs);
}

}  // namespace silt::coupler
