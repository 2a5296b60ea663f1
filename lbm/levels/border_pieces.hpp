#pragma once
// Cuts faces of boxes of coarse cells into rectangles whose cells have the same leaves of the tree of cuts
// around them. All ranks that know these leaves find the same rectangles in the same order.
#include <cstdint>
#include <vector>

#include "lbm/exchange/ghost_home.hpp"

namespace silt::lbm {

/// The levels around a coarse cell, and along each axis the number of cells from it on that have the same
/// leaves around them.
struct Surroundings {
  bool any_outside = false, any_far = false;
  std::uint32_t fine = 0;  // a bit for each of the 27 cells
  Int3 alike{1 << 30, 1 << 30, 1 << 30};

  static constexpr std::uint32_t bit(Int3 v) { return 1u << (13 + v.x + 3 * v.y + 9 * v.z); }
  /// Returns whether the cell at v from this one, by one along each axis at most, is fine.
  bool is_fine(Int3 v) const { return (fine & bit(v)) != 0; }

  /// Returns whether a population that moves along j may enter fine cells.
  template <class Lattice>
  bool may_meet(int j) const {
    bool found = any_outside;
    for (int k = 1; k < 8; ++k) {
      const Int3 v = corner(k), c = Lattice::c[j];
      found |= is_fine({v.x * c.x, v.y * c.y, v.z * c.z});
    }
    return found;
  }
};

class BorderSurroundings {
 public:
  BorderSurroundings(const Domain& fine, const Domain& coarse) : fine_(fine), coarse_(coarse) {}
  Surroundings around(Int3 coarse_cell);

 private:
  const Domain &fine_, &coarse_;
  BlockPlace recent_[3][3][3] = {};  // leaves of the last cell's neighbours: often the same again
};

/// Moves packets by fine cells in and beside a coarse cell y. Where no side of the domain is around y, their
/// ways are straight, through cells that are not wrapped.
template <class Lattice>
class PacketWays {
 public:
  PacketWays(const Domain& fine, Leaves& leaves) : fine_(fine), leaves_(leaves) {}
  Flight moved(Flight packet, const Surroundings& around_y, bool back = false) const {
    if (around_y.any_outside)
      return back ? step_back<Lattice>(fine_, packet) : one_step<Lattice>(fine_, packet);
    packet.cell = packet.cell + Lattice::c[back ? opposite(packet.direction) : packet.direction];
    return packet;
  }
  /// Returns whether a packet is in a fine cell now.
  bool is_fine(const Flight& packet, Int3 y, const Surroundings& around_y) const {
    if (around_y.any_outside) return leaves_.level(packet.cell) == fine_.level();
    return around_y.is_fine(halved(packet.cell) - y);
  }

 private:
  const Domain& fine_;
  Leaves& leaves_;
};

/// Cells from `first` on, in rows along one axis, one after another along another.
struct BorderPiece {
  Int3 first;
  int length, rows;
  Surroundings around;
};

/// Returns the pieces of a face beside fine cells, except those that touch leaves that this rank does not
/// know, by their places along `outer`, then along `axis`.
std::vector<BorderPiece> alike_pieces(BorderSurroundings&, const CellBox& face, int axis, int outer);

}  // namespace silt::lbm
