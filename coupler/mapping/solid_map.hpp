#pragma once
// Which cells of a block are solid, as bits: one word holds 64 cells of a row, ghost cells included. And the
// bodies that make them so, each with the bits of its own.
#include <cstdint>
#include <span>
#include <vector>

#include "coupler/mapping/bit_window.hpp"
#include "coupler/mapping/for_cells.hpp"
#include "lbm/block.hpp"
#include "lbm/prefetch.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

/// Rows of bits over a block and `ghosts` layers of ghost cells: bit x + ghosts of row (y, z). A word before
/// and three after them may be read.
class CellBits {
 public:
  static constexpr int ghosts = 2;  // a link asks for the cell behind its own and the one beyond that
  CellBits() = default;
  explicit CellBits(lbm::Int3 size)
      : size_(size),
        words_((size.x + 2 * ghosts + 63) / 64),
        bits_(std::size_t(words_) * (size.y + 2 * ghosts) * (size.z + 2 * ghosts) + 4) {}
  int words() const { return words_; }
  std::size_t row(int y, int z) const {
    return 1 + std::size_t(words_) * ((z + ghosts) * (size_.y + 2 * ghosts) + (y + ghosts));
  }
  std::uint64_t* at(int y, int z) { return bits_.data() + row(y, z); }
  const std::uint64_t* at(int y, int z) const { return bits_.data() + row(y, z); }
  /// 64 cells of a row from cell x on; beyond the row: anything.
  std::uint64_t from(int x, int y, int z) const {
    const int bit = x + ghosts;
    const std::uint64_t* const w = at(y, z) + (bit >> 6);
    return w[0] >> (bit & 63) | w[1] << 1 << (63 - (bit & 63));
  }
  /// Sets the cells whose bits are set, bit 0 being cell x.
  void add(int x, int y, int z, std::uint64_t cells) {
    const int bit = x + ghosts;
    std::uint64_t* const w = at(y, z) + (bit >> 6);
    w[0] |= cells << (bit & 63);
    if (const std::uint64_t beyond = cells >> 1 >> (63 - (bit & 63))) w[1] |= beyond;
  }
  bool test(lbm::Int3 c) const {
    const int bit = c.x + ghosts;
    return at(c.y, c.z)[bit >> 6] >> (bit & 63) & 1;
  }
  void set(lbm::Int3 c) {
    const int bit = c.x + ghosts;
    at(c.y, c.z)[bit >> 6] |= std::uint64_t{1} << (bit & 63);
  }
  std::vector<std::uint64_t>& all() { return bits_; }
  const std::vector<std::uint64_t>& all() const { return bits_; }
  lbm::Int3 size() const { return size_; }
  /// Bits of the cells inside the block (no ghosts) in word k of a row.
  std::uint64_t interior(int k) const {
    std::uint64_t m = ~std::uint64_t{0};
    const int first = k * 64, last = size_.x + ghosts - 1;  // bits ghosts .. last are inside
    if (first == 0) m <<= ghosts;
    if (last < first + 63) m &= last < first ? 0 : (~std::uint64_t{0} >> (63 - (last - first)));
    return m;
  }

 private:
  lbm::Int3 size_;
  int words_ = 0;
  std::vector<std::uint64_t> bits_;
};

/// Calls f(x) for every set bit of word k (x: local coordinate of the cell).
template <class F>
void for_bits(std::uint64_t word, int k, F&& f) {
  for (; word; word &= word - 1) f(k * 64 + __builtin_ctzll(word) - CellBits::ghosts);
}

/// One periodic image of a body in a block: the cells whose centres are inside it. The windows reach two
/// cells beyond what the body can cover in the block and its ghost layers.
struct BodyMask {
  rigid::BodyId id = 0;
  std::size_t row = 0;  // in the BodySet, this step
  lbm::Int3 shift;      // the image: cells added to the canonical position (multiples of the domain)
  rigid::Pose pose;     // canonical
  BitWindow inside;     // centre inside the body
  BitWindow bits;       // the same less what walls and lower ids have
  bool any = false;     // in bits
  int before = -1;      // index in masks_before of the same image; -1: it is new
  bool kept = false;    // neither its cells nor others around it have changed sides, nor has it moved

  const BitFrame& frame() const { return bits.frame(); }
  /// A cell's centre from the centre of mass of this image; `cell` global and unwrapped (lower corner +
  /// local).
  rigid::Vec3 arm(lbm::Int3 cell) const {
    return {(cell.x - shift.x + 0.5) - pose.position[0], (cell.y - shift.y + 0.5) - pose.position[1],
            (cell.z - shift.z + 0.5) - pose.position[2]};
  }
};

/// A hint that the bits of the masks after the k-th will be asked for, one after the other.
inline void prefetch_bits(const std::vector<BodyMask>& masks, std::size_t k) {
  if (k + 4 < masks.size()) lbm::prefetch_to_read(&masks[k + 4].bits);
  if (k + 2 < masks.size()) masks[k + 2].bits.prefetch();
}

/// The map of one block.
struct BlockMap {
  lbm::CellBox box;
  CellBits walls, solid, before;              // ghosts beyond walls; walls and bodies; the same a step ago
  std::vector<BodyMask> masks, masks_before;  // by (id, shift)
  bool changed = false;                       // in the last mapping

  bool was_and_is_fluid(lbm::Int3 c) const { return !solid.test(c) && !before.test(c); }
  /// Of the cells inside the block.
  bool has_fluid() const {
    for (int z = 0; z < box.size.z; ++z)
      for (int y = 0; y < box.size.y; ++y)
        for (int k = 0; k < solid.words(); ++k)
          if (~solid.at(y, z)[k] & solid.interior(k)) return true;
    return false;
  }
};

/// Calls visit(block, local cell) for every fluid cell inside the blocks, x fastest.
template <class Visit>
void for_fluid_cells(std::span<const BlockMap> maps, Visit&& visit) {
  for (int b = 0; b < int(maps.size()); ++b)
    for_cells({}, maps[b].box.size, [&](lbm::Int3 x) {
      if (!maps[b].solid.test(x)) visit(b, x);
    });
}

}  // namespace silt::coupler
