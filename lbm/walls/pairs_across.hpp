#pragma once
// A link from x along c_i may read what passes between x - c_i and x - 2 c_i (BeyondPair). Where x - c_i is a
// cell of another block, or of the same one through a period, that block has the pair, in slots of its own or
// of its ghost layer; this brings it. No slot of a pair is overwritten between the halo exchange and the next
// pass: where a ghost slot was returned to its home, it keeps what was sent.
//
// Which pairs are read follows from the solid cells on either side of a face, which both ranks know: nothing
// is asked for, and only these pairs move.
#include <mpi.h>

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "lbm/blocks/domain.hpp"
#include "lbm/exchange/slot_exchange.hpp"
#include "lbm/walls/cut_links.hpp"

namespace silt::lbm {

/// The places of a block's pairs across (PairsAcross): one for each cell x and direction i with x - c_i
/// outside the block. Faces of the block are counted whole, so some places are of no cell.
template <class Lattice>
class PlacesAcross {
 public:
  explicit PlacesAcross(Int3 block_size) : size_(block_size) {
    for (int i = 1; i < Lattice::directions; ++i)
      for (int d = 0; d < 3; ++d) {
        first_[i][d] = count_;
        if (Lattice::c[i][d] != 0)
          count_ += std::uint32_t(size_[(d + 1) % 3]) * std::uint32_t(size_[(d + 2) % 3]);
      }
  }
  /// The last axis along which a link of a cell enters a block.
  static int axis_of(Int3 cell, int direction, Int3 block_size) {
    int d = 2;
    while (Lattice::c[direction][d] == 0 || cell[d] != (Lattice::c[direction][d] > 0 ? 0 : block_size[d] - 1))
      --d;
    return d;
  }
  /// The cell lies in the block, the one behind it outside.
  std::uint32_t operator()(Int3 cell, int direction) const {
    const int d = axis_of(cell, direction, size_);
    const int e = d == 0 ? 1 : 0, f = d == 2 ? 1 : 2;  // along the face, in the order of cells in memory
    return first_[direction][d] + std::uint32_t(cell[f]) * std::uint32_t(size_[e]) + std::uint32_t(cell[e]);
  }
  /// All places are less than this.
  std::uint32_t count() const { return count_; }

 private:
  Int3 size_;
  std::array<std::array<std::uint32_t, 3>, Lattice::directions>
      first_{};  // by direction and the axis of the face
  std::uint32_t count_ = 0;
};

/// The pairs of cells x and directions i with x - c_i outside their block, brought from where x - c_i is. A
/// pair whose x - c_i is beyond a side of the domain that is not periodic does not exist; it stays 0.
template <class T, class Lattice = D3Q19>
class PairsAcross {
  using Block = lbm::Block<T, Lattice>;

 public:
  /// `blocks` are the local ones, in the order of domain.blocks_of(rank). All pairs come until some are
  /// chosen.
  PairsAcross(const Domain&, MPI_Comm, std::span<const Block> blocks, Device = Device::cpu);
  /// Restricts the exchange to the pairs of cut links: of fluid cells x with x + c_i solid; other pairs hold
  /// no value. solid(block, cell, axis) returns 64 cells of a local block along x or y as bits, from `cell`
  /// on, for cells up to two beyond its faces. Each rank calls this function when one of these cells of its
  /// blocks has changed. Two ranks must agree on the same cells, for the lengths of their messages follow
  /// from them.
  template <class Solid>
  void choose(Solid&& solid);
  /// Call after the halo exchange, with the parity of the blocks then. Pairs of an idle block mean nothing.
  void exchange(std::span<const Block> blocks, Parity);
  /// The pairs of a local block lie in the order of its PlacesAcross.
  const BeyondPair<T>* of(int block) const { return pairs_[block].data(); }
  /// The bytes that this rank sends in one exchange.
  std::size_t message_bytes() const { return slots_.message_bytes(); }

 private:
  /// Cells x one after the other, along x or along y, whose links along a direction may read a pair: of a
  /// local block or, as another rank's that reads here, beyond its faces.
  struct Line {
    int block, direction;
    Int3 first;
    bool along_y;
    std::uint32_t length;
    int from_rank, to_rank;
    SlotRun from, to;  // that of the first pair which is read here; where it goes, if that is here
  };
  struct Builder;

  /// Adds the pairs of `count` cells of a line, from the n-th on.
  void add(const Line&, std::uint32_t n, std::uint32_t count);

  int rank_;
  Device device_;
  std::vector<std::pmr::vector<BeyondPair<T>>> pairs_;  // of the blocks
  std::vector<Line> lines_;
  SlotExchange<T> slots_;
  Mirror<const T*> sources_;  // of the exchange under way
  Mirror<T*> targets_;
};

template <class T, class Lattice>
template <class Solid>
void PairsAcross<T, Lattice>::choose(Solid&& solid) {
  slots_.clear();
  for (const Line& line : lines_) {
    const int axis = line.along_y ? 1 : 0;
    for (std::uint32_t n = 0; n < line.length; n += 64) {
      Int3 x = line.first;
      x[axis] += int(n);
      std::uint64_t cut =
          ~solid(line.block, x, axis) & solid(line.block, x + Lattice::c[line.direction], axis);
      if (line.length - n < 64) cut &= (std::uint64_t{1} << (line.length - n)) - 1;
      while (cut) {
        const int begin = std::countr_zero(cut), count = std::countr_one(cut >> begin);
        add(line, n + std::uint32_t(begin), std::uint32_t(count));
        cut &= count < 64 ? ~(((std::uint64_t{1} << count) - 1) << begin) : 0;
      }
    }
  }
}

}  // namespace silt::lbm
