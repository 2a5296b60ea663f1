#pragma once
// A box of cells as one stream of bits: x fastest, rows `pitch` bits apart, planes whole words apart. A step
// along c shifts the whole stream, without special cases if all cells at the border of the box are unset.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "cpu/prefetch.hpp"
#include "lbm/blocks/block.hpp"

namespace silt::coupler {

struct BitFrame {
  lbm::Int3 low;   // cell of bit 0, in block coordinates
  lbm::Int3 size;  // cells
  int pitch = 0;   // 8, 16, 32 or a multiple of 64
  int plane = 0;   // words per plane

  BitFrame() = default;
  BitFrame(lbm::Int3 corner, lbm::Int3 cells) : low(corner), size(cells) {
    pitch = size.x <= 8 ? 8 : size.x <= 16 ? 16 : size.x <= 32 ? 32 : (size.x + 63) / 64 * 64;
    plane = (pitch * size.y + 63) / 64;
  }
  SILT_DEVICE std::size_t words() const { return std::size_t(plane) * size.z; }
  /// Returns the number of zero words before a stream, so that it can be read one step along any c away;
  /// eight more follow after it, for reads of eight words.
  int margin() const { return plane + pitch / 64 + 2; }
  std::size_t words_with_margins() const { return words() + 2 * margin() + 8; }
  /// Returns the bit of the first cell of row (y, z), block coordinates.
  SILT_DEVICE std::size_t row(int y, int z) const {
    return std::size_t(z - low.z) * plane * 64 + std::size_t(y - low.y) * pitch;
  }
  /// Returns the cell of a bit, block coordinates.
  SILT_DEVICE lbm::Int3 cell(std::uint32_t bit) const {
    const int in_plane = int(bit % (unsigned(plane) * 64));
    return low + lbm::Int3{in_plane % pitch, in_plane / pitch, int(bit / (unsigned(plane) * 64))};
  }
  bool contains(lbm::Int3 c) const { return lbm::CellBox{low, size}.contains(c); }
  /// Returns a mask of the bits of one row in a word.
  SILT_DEVICE std::uint64_t row_bits() const {
    return pitch >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << pitch) - 1;
  }
  bool operator==(const BitFrame& o) const { return low == o.low && size == o.size; }
};

/// The bits of a frame, with margins.
class BitWindow {
 public:
  const BitFrame& frame() const { return frame_; }
  /// Takes a frame and clears all bits.
  void reset(const BitFrame& frame) {
    frame_ = frame;
    bits_.assign(frame.words_with_margins(), 0);
  }
  std::uint64_t* words() { return bits_.data() + frame_.margin(); }
  const std::uint64_t* words() const { return bits_.data() + frame_.margin(); }
  /// Returns the cells of a row from the x-th cell of the frame on, as many as fit a word.
  std::uint64_t row(int x, int y, int z) const {
    const std::size_t bit = frame_.row(y, z) + x;
    return words()[bit >> 6] >> (bit & 63) & frame_.row_bits();
  }
  /// Returns 64 cells of a row from a cell on, maybe before the row; bits beyond the row are undefined.
  std::uint64_t from(lbm::Int3 c) const { return from(frame_, words(), c); }
  SILT_DEVICE static std::uint64_t from(const BitFrame& frame, const std::uint64_t* words, lbm::Int3 c) {
    const std::ptrdiff_t bit = std::ptrdiff_t(frame.row(c.y, c.z)) + (c.x - frame.low.x);
    const std::uint64_t* const w = words + (bit >> 6);
    return w[0] >> (bit & 63) | w[1] << 1 << (63 - (bit & 63));
  }
  bool test(lbm::Int3 c) const {
    if (!frame_.contains(c)) return false;
    const std::size_t bit = frame_.row(c.y, c.z) + std::size_t(c.x - frame_.low.x);
    return words()[bit >> 6] >> (bit & 63) & 1;
  }
  void set(lbm::Int3 c) {
    const std::size_t bit = frame_.row(c.y, c.z) + std::size_t(c.x - frame_.low.x);
    words()[bit >> 6] |= std::uint64_t{1} << (bit & 63);
  }
  /// Prefetches the bits: all of them for a small body.
  void prefetch() const {
    constexpr std::size_t most = 256;
    for (std::size_t word = 0; word < std::min(bits_.size(), most); word += 8)
      prefetch_to_read(bits_.data() + word);
  }
  bool operator==(const BitWindow& o) const { return frame_ == o.frame_ && bits_ == o.bits_; }
  void swap(BitWindow& o) { std::swap(frame_, o.frame_), bits_.swap(o.bits_); }

 private:
  BitFrame frame_;
  std::vector<std::uint64_t> bits_;
};

/// Sets the bits of row(x, y, z), 64 cells from x on, in a window, for rows of the block and of `layers`
/// ghost layers that lie in the window.
template <class Row>
void fill_rows(BitWindow& window, lbm::Int3 block, int layers, Row&& row) {
  const BitFrame& f = window.frame();
  const std::uint64_t width = f.row_bits();
  for (int z = std::max(f.low.z, -layers); z < std::min(f.low.z + f.size.z, block.z + layers); ++z)
    for (int y = std::max(f.low.y, -layers); y < std::min(f.low.y + f.size.y, block.y + layers); ++y) {
      const std::size_t bit = f.row(y, z);
      for (int x = 0; x < f.pitch; x += 64)
        window.words()[(bit + x) >> 6] |= (row(f.low.x + x, y, z) & width) << (bit & 63);
    }
}

/// Returns a word of cells from x on, with those in [from, to) set.
SILT_DEVICE inline std::uint64_t cells_between(int x, int from, int to) {
  const int a = std::clamp(from - x, 0, 64), b = std::clamp(to - x, 0, 64);
  if (a >= b) return 0;
  return (~std::uint64_t{0} >> (64 - (b - a))) << a;
}

/// Returns which of 64 cells from x on lie in a frame and may be set: not in its first and last rows and
/// planes.
SILT_DEVICE inline std::uint64_t shared_cells(const BitFrame& f, lbm::Int3 x) {
  if (x.y <= f.low.y || x.z <= f.low.z || x.y >= f.low.y + f.size.y - 1 || x.z >= f.low.z + f.size.z - 1)
    return 0;
  return cells_between(x.x, f.low.x, f.low.x + f.size.x);
}

/// Returns 64 cells of a row of a block of n cells, from x on: set are those at least `reach` cells from the
/// faces, or, for the `rim`, the other cells of the block.
SILT_DEVICE inline std::uint64_t cells_of_block(lbm::Int3 x, lbm::Int3 n, int reach, bool rim) {
  if (x.y < 0 || x.z < 0 || x.y >= n.y || x.z >= n.z) return 0;
  const bool side = x.y < reach || x.z < reach || x.y >= n.y - reach || x.z >= n.z - reach;
  const std::uint64_t inner = side ? 0 : cells_between(x.x, reach, n.x - reach);
  return rim ? cells_between(x.x, 0, n.x) & ~inner : inner;
}

}  // namespace silt::coupler
