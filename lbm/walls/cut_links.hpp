#pragma once
// Cut links: a link from a fluid cell x along c_i is cut where it meets a solid surface at x + q c_i, q in
// (0, 1]. The dense kernel ignores them; this sparse pass then overwrites what the surface returns
// (wall_formula.hpp). One link owns the two slots it uses, so the order of links cannot matter. But a link
// may be cut at both ends, each of which writes what the other one reads (a group `crossing`): these groups
// come last, for other links may read there, and the two ends are beside one another, in one vector of links.
//
// All links of a group are of one scheme: where x - c_i is not fluid a link is put into a group of
// `single_cell_gap`, which does not read there.
//
// A group is what is applied at a time: links of a surface, of all directions, whose fluid cells lie in one
// plane, or in a few if these are small. It may be applied once its cells and their neighbours have collided:
// inner groups as soon as the dense pass is done with part `ready` (pass_order.hpp), while the populations
// are still in cache; groups at the rim of the block, which touch ghost cells, after the halo exchange.
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <stdexcept>
#include <vector>

#include "cpu/isa.hpp"
#include "cpu/prefetch.hpp"
#include "device/device.hpp"
#include "lbm/blocks/block.hpp"
#include "lbm/blocks/moments.hpp"
#include "lbm/walls/wall_formula.hpp"

namespace silt::lbm {

/// Groups are padded to a multiple of this with copies of their last link (which then is written twice, with
/// the same value, and counted once).
inline constexpr int link_lanes = 16;
constexpr std::uint32_t padded(std::uint32_t links) {
  return (links + link_lanes - 1) / link_lanes * link_lanes;
}

/// The place of a link packs where its fluid cell is, counted from its group's corner, and its direction.
inline constexpr int place_x_bits = 12, place_y_bits = 12, place_z_bits = 3;
inline constexpr int place_z_shift = place_x_bits + place_y_bits,
                     place_direction_shift = place_z_shift + place_z_bits;
inline constexpr std::uint32_t link_place(Int3 cell, int direction) {
  return std::uint32_t(cell.x) | std::uint32_t(cell.y) << place_x_bits |
         std::uint32_t(cell.z) << place_z_shift | std::uint32_t(direction) << place_direction_shift;
}
inline constexpr int place_x(std::uint32_t p) {
  return int(p & ((1u << place_x_bits) - 1));
}
inline constexpr int place_y(std::uint32_t p) {
  return int(p >> place_x_bits & ((1u << place_y_bits) - 1));
}
inline constexpr int place_z(std::uint32_t p) {
  return int(p >> place_z_shift & ((1u << place_z_bits) - 1));
}
inline constexpr Int3 place_cell(std::uint32_t p) {
  return {place_x(p), place_y(p), place_z(p)};
}
inline constexpr int place_direction(std::uint32_t p) {
  return int(p >> place_direction_shift);
}

struct LinkGroup {
  std::uint32_t begin, count;  // of the arrays of CutLinks
  WallScheme scheme;
  Int3 corner;                     // cell of the block that places count from (may lie outside of it)
  std::int32_t ready;              // last part of the dense pass that the links read or write; -1: at the rim
  std::uint32_t opposite = 0;      // under `single_cell_gap`: first in CutLinks::opposite_q and opposite_u
  bool across = false;             // x - c_i lies in another block, or beyond a period: see CutLinks::across
  std::uint32_t across_begin = 0;  // first in CutLinks::across
  bool crossing = false;           // cut at both ends: applied after all others, see above
};

/// The frame of a surface is fixed to its reference point: the centre of block cell `cell` is at `offset`
/// from it.
struct SurfaceFrame {
  Int3 cell;
  double offset[3];
  double reach;  // no link's cell is further away
  bool whole;    // all links of the surface are inner groups of this block
};

/// The links of one surface in one block. A structure of arrays: 4 + sizeof(T) bytes a link, of a surface
/// that moves 4 + 2 sizeof(T).
template <class T>
struct CutLinks {
  WallFluid<T> fluid;  // that the links stand in
  SurfaceFrame frame;
  std::vector<LinkGroup> groups;
  DeviceArray<std::uint32_t> place;       // of whole groups, padded
  DeviceArray<T> q;                       // at a time that `age` counts from
  DeviceArray<T> rate;                    // of q, a step; empty: of none
  T age = 0;                              // steps since then; may be negative
  DeviceArray<T> opposite_q, opposite_u;  // OppositeWall of the links of `single_cell_gap`; empty: of none
  /// The index of its pair in the block's PairsAcross, for each link of groups `across`, padded as they are.
  DeviceArray<std::uint32_t> across;

  /// Returns a surface without links in a memory that a device may reach.
  static CutLinks in(std::pmr::memory_resource* memory) {
    using Values = DeviceArray<T>;
    using Places = DeviceArray<std::uint32_t>;
    return {{},
            {},
            {},
            Places(memory),
            Values(memory),
            Values(memory),
            0,
            Values(memory),
            Values(memory),
            Places(memory)};
  }

  /// A hint that a group will be wanted soon.
  void prefetch(const LinkGroup& g) const {
    constexpr std::uint32_t line = 16;  // places
    for (std::uint32_t l = 0; l < g.count; l += line) {
      prefetch_to_read(place.data() + g.begin + l);
      prefetch_to_read(reinterpret_cast<const char*>(q.data() + g.begin) + l * sizeof(T));
      if (!rate.empty())
        prefetch_to_read(reinterpret_cast<const char*>(rate.data() + g.begin) + l * sizeof(T));
    }
  }
};

/// The two populations that pass between x - c_i and x - 2 c_i: f*_opp(x - c_i) and f*_i(x - 2 c_i).
template <class T>
struct BeyondPair {
  T away, toward;
};

/// Components of the directions, two bits each: one look-up for the three.
struct Components {
  std::int32_t packed[32] = {};
};
template <class Lattice>
constexpr Components components_of() {
  Components all;
  for (int d = 0; d < 3; ++d)
    for (int i = 0; i < Lattice::directions; ++i) all.packed[i] |= (Lattice::c[i][d] & 3) << (2 * d);
  return all;
}
template <class Lattice>
inline constexpr Components components = components_of<Lattice>();

/// The populations of a link along i lie at these slots, by direction, from its cell at Block::middle(). What
/// passes further away from the surface lies as many steps behind, at either parity: f*_i(x - c_i) at out -
/// step, f*_i(x - 2 c_i) at out - 2 step, f*_opp(x) at back - step, f*_opp(x - c_i) at back - 2 step.
struct LinkSlots {
  std::int32_t out[32] = {};         // f*_i(x)
  std::int32_t back[32] = {};        // f_opp(x, t + 1): what the surface returns
  std::int32_t step[32] = {};        // from a cell to the next along c_i
  std::int32_t components[32] = {};  // silt::lbm::components, where a device finds them
};
/// Offsets of 32 bits reach over 9 directions of a block.
inline constexpr std::int64_t most_cells_with_links = 220'000'000;
/// The slots at `parity`, which is the block's after the pass. Throws std::invalid_argument for a block too
/// large for offsets of 32 bits.
template <class T, class Lattice>
LinkSlots link_slots(const Block<T, Lattice>& block, Parity parity) {
  const std::ptrdiff_t furthest =
      block.slot(Lattice::directions - 1) + block.slot(1) - block.middle() + 2 * block.plane_stride();
  if (furthest > std::numeric_limits<std::int32_t>::max())
    throw std::invalid_argument("a block of more than 220 million cells; use smaller domain.blocks");
  const auto from_middle = [&](std::ptrdiff_t slot) { return std::int32_t(slot - block.middle()); };
  LinkSlots s;
  for (int i = 1; i < Lattice::directions; ++i) {
    s.out[i] = from_middle(block.leaving(i, parity));
    s.back[i] = from_middle(block.arriving(opposite(i), parity));
    s.step[i] = std::int32_t(block.step(i));
    s.components[i] = components<Lattice>.packed[i];
  }
  return s;
}

/// A surface moves as a rigid body: velocity of its reference point in cells a step, angular velocity in
/// radians a step.
struct SurfaceMotion {
  double v[3] = {}, omega[3] = {};
  std::int64_t mass_by_link = 0;  // that each link gives its cell besides, in quanta of excess.hpp
};

/// The largest |f* + f_opp| for which no term leaves its range (method.md, equation 22).
inline double largest_exchange(double reach, const SurfaceMotion& m) {
  double u = 0;
  for (int k = 0; k < 3; ++k) u += std::fabs(m.v[k]) + reach * std::fabs(m.omega[k]);
  return 32 / ((1 + reach) * (1 + u));
}

/// Sums are in fixed point, so that they do not depend on the order or the partition of links (method.md,
/// equation 22). This is the quantum of force and torque in lattice units.
inline constexpr double link_quantum = 0x1p-44;

/// The sums of the momentum exchange on one surface in one step (method.md, equation 22).
struct LinkSums {
  std::int64_t force[3] = {}, torque[3] = {};
  std::int64_t invalid = 0;  // not 0: a term might have been out of range, or was not a number
};

/// The resistance of a surface, H = sum 6 w J J^T with J = [c, r x c], is how force and torque fall with its
/// velocity (method.md, equation 23). Upper triangle, rows vx vy vz wx wy wz, in quanta of resistance_quantum
/// for the first three rows and columns, and 2^exponent times that for each of the others: 2^exponent is no
/// less than |r x c|. In single precision the terms of 64 links fit 32 bits.
/// Beside it the push, sum 6 w J, in the same quanta: the mass that the links take from the fluid where the
/// surface moves by (v, omega) is its product with them.
struct ResistanceSums {
  std::int64_t h[21] = {}, push[6] = {};
};
template <class T>
inline constexpr double resistance_quantum = sizeof(T) == 4 ? 0x1p-24 : 0x1p-44;
/// The exponent of a surface no cell of which is further than `radius` from its reference point.
inline int resistance_exponent(double radius) {
  int e = 0;
  while (double(1 << e) < 1.5 * (radius + 2)) ++e;
  return e;
}

/// The group that the next call is for, of the same block: where its populations are is found in the
/// meantime, and they are fetched if they are far.
template <class T>
struct NextGroup {
  const CutLinks<T>* links = nullptr;
  const LinkGroup* group = nullptr;
};

/// The slots of the populations of links that come next: a call lists them for the next group, and the call
/// for that group finds them (link_fetch.hpp).
struct ListedLinks {
  static constexpr int most = 128, most_rows = D3Q19::directions + 2;  // links of a window; slots of a link
  const LinkGroup* group = nullptr;                                    // to which the links belong
  int count = 0, rows = 0, half = 0;  // links; slots of one; where they are listed
  alignas(64) std::int32_t slot[2][most * most_rows];
};

/// A group of links and the block that it lies in.
template <class T>
struct GroupInBlock {
  Block<T>& block;
  const LinkSlots& slots;  // of the block
  const CutLinks<T>& links;
  const LinkGroup& group;  // of the links
  NextGroup<T> next = {};
  const BeyondPair<T>* pairs_across = nullptr;  // of the block, for a group `across`
  ListedLinks* listed = nullptr;                // the same one for calls that name one another as the next
  bool far = false;  // its populations are not at hand: they are fetched ahead of use
};

/// The kernels of links, as each build has them (cut_links_kernel.cpp, link_resistance_kernel.cpp).
template <class T>
struct LinkKernels {
  void (*apply)(const GroupInBlock<T>&, const SurfaceMotion&, ForceForm, LinkSums&);
  void (*correct)(const GroupInBlock<T>&, const SurfaceMotion& increment);
};
template <class T>
using Resistance = ResistanceSums (*)(const CutLinks<T>&, int exponent);
SILT_BUILDS(template <class T> LinkKernels<T> link_kernels(); template <class T> Resistance<T> resistance();)
template <class T>
const LinkKernels<T>& link_kernels() {
  static const LinkKernels<T> kernels = SILT_CHOSEN(link_kernels<T>)();
  return kernels;
}

/// Writes what the surface returns along the group's links, adds to the excess of their cells (excess.hpp),
/// and to force and torque.
template <class T>
void apply_cut_links(const GroupInBlock<T>& at, const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  link_kernels<T>().apply(at, motion, form, sums);
}

/// Changes what was returned as if the surface had moved faster by `increment`.
template <class T>
void correct_cut_links(const GroupInBlock<T>& at, const SurfaceMotion& increment) {
  link_kernels<T>().correct(at, increment);
}

/// The resistance of all links of a surface, which depends on geometry only. `exponent` is that of the
/// surface (resistance_exponent).
template <class T>
ResistanceSums resistance_of(const CutLinks<T>& links, int exponent) {
  return SILT_CHOSEN(resistance<T>)()(links, exponent);
}

}  // namespace silt::lbm
