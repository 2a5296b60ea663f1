#pragma once
// A link from x along c_i may read the populations between x - c_i and x - 2 c_i (BeyondPair). If x - c_i is
// a cell of another block, or of the same block through a period, that block holds the pair in its own slots
// or those of its ghost layer, and PairsAcross copies it. No such slot is overwritten between the halo
// exchange and the next pass: a ghost slot that was returned to its home keeps its value. Both ranks know the
// solid cells on either side of a face, from which the pairs to copy follow without requests.
#include <mpi.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "lbm/blocks/domain.hpp"
#include "lbm/exchange/slot_exchange.hpp"
#include "lbm/walls/cut_links.hpp"
#include "lbm/walls/places_across.hpp"

namespace silt::lbm {

/// Holds copies of the pairs of cells x and directions i with x - c_i outside their block. A pair whose x -
/// c_i is beyond a side of the domain that is not periodic stays 0.
template <class T, class Lattice = D3Q19>
class PairsAcross {
  using Block = lbm::Block<T, Lattice>;

 public:
  /// Takes the local blocks as in domain.blocks_of(rank). Copies all pairs until choose() is called.
  PairsAcross(const Domain&, MPI_Comm, std::span<const Block> blocks, Device = Device::cpu);
  /// Restricts the exchange to pairs that cut links read: those of fluid cells x with x + c_i solid. Others
  /// hold no value. From device to device all pairs are copied, since that takes less time than telling a
  /// device which. solid(block, cell, axis) returns the solid bits of 64 cells of a local block along x or y
  /// from `cell` on, for cells up to two beyond its faces. Call when one of these cells has changed on this
  /// rank. Two ranks must agree on these bits, which determine the lengths of their messages.
  template <class Solid>
  void choose(Solid&& solid);
  /// Returns whether there are pairs to choose.
  bool chooses() const {
    return std::ranges::any_of(lines_, [&](const Line& line) { return !is_direct(line); });
  }
  /// Copies the pairs, after the halo exchange, with the blocks' parity. Pairs of idle blocks are invalid.
  void exchange(std::span<const Block> blocks, Parity);
  /// Returns the pairs of a local block, indexed by its PlacesAcross.
  const BeyondPair<T>* of(int block) const { return pairs_[block].data(); }
  /// Returns the bytes that this rank sends per exchange.
  std::size_t message_bytes() const { return slots_.message_bytes(); }

 private:
  /// Consecutive cells x, along x or y, whose links in a direction may read a pair: of a local block or, if
  /// another rank reads from this one, beyond its faces.
  struct Line {
    int block, direction;
    Int3 first;
    bool along_y;
    std::uint32_t length;
    int from_rank, to_rank;
    SlotRun from, to;  // source of the first pair if it is local; target if it is local
  };
  struct Builder;

  bool is_direct(const Line& line) const {
    return slots_.is_direct(line.from_rank == rank_ ? line.to_rank : line.from_rank);
  }
  /// Adds the pairs of `count` cells of a line, from the n-th on.
  void add(const Line&, std::uint32_t n, std::uint32_t count);

  int rank_;
  Device device_;
  std::vector<std::pmr::vector<BeyondPair<T>>> pairs_;  // per block
  std::vector<Line> lines_;
  SlotExchange<T> slots_;
  Mirror<const T*> sources_[2];  // by parity
  Mirror<T*> targets_;
};

template <class T, class Lattice>
template <class Solid>
void PairsAcross<T, Lattice>::choose(Solid&& solid) {
  slots_.clear(true);
  for (const Line& line : lines_) {
    if (is_direct(line)) continue;
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
