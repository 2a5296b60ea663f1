#pragma once
// Cut links. A link from fluid cell x along c_i is cut where it meets a solid surface at x + q c_i, q in (0,
// 1]. The dense kernel ignores cut links; this sparse pass then writes the populations that the surface
// returns (wall_formula.hpp). A link alone uses its two slots, so the order of links does not matter, except
// for links cut at both ends (groups `crossing`), whose ends write what the other end reads. These groups
// come last, since other links read there too, and the two ends lie side by side in one vector of links.
//
// All links of a group have one scheme; a link whose cell x - c_i is not fluid belongs to a group of
// `single_cell_gap`, which does not read there.
//
// A group is applied at once: links of one surface, in all directions, whose fluid cells lie in one plane, or
// in a few planes if these are small. Inner groups follow the dense pass as soon as their cells and
// neighbours have collided (part `ready`, pass_order.hpp), while the populations are cached. Groups at the
// rim of the block, which touch ghost cells, follow the halo exchange.
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

/// Groups are padded to a multiple of this with copies of their last link, which is written twice with the
/// same value but counted once.
inline constexpr int link_lanes = 16;
constexpr std::uint32_t padded(std::uint32_t links) {
  return (links + link_lanes - 1) / link_lanes * link_lanes;
}

/// Packs the fluid cell of a link, counted from the corner of its group, and its direction into 32 bits.
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
  std::uint32_t begin, count;  // in the arrays of CutLinks
  WallScheme scheme;
  Int3 corner;                     // origin of the places in the block (may lie outside it)
  std::int32_t ready;              // last part of the dense pass whose cells the links use; -1: at the rim
  std::uint32_t opposite = 0;      // for `single_cell_gap`: first index in opposite_q and opposite_u
  bool across = false;             // x - c_i lies in another block, or beyond a period: see CutLinks::across
  std::uint32_t across_begin = 0;  // first index in CutLinks::across
  bool crossing = false;           // cut at both ends: applied after all others
};

/// The frame of a surface's reference point, from which the centre of block cell `cell` is at `offset`.
struct SurfaceFrame {
  Int3 cell;
  double offset[3];
  double reach;  // largest distance of a link's cell from the reference point
  bool whole;    // all links of the surface are inner groups of this block
  bool operator==(const SurfaceFrame&) const = default;
};

/// The links of one surface in one block: 4 + sizeof(T) bytes per link, 4 + 2 sizeof(T) if the surface moves.
template <class T>
struct CutLinks {
  WallFluid<T> fluid;  // the fluid at the links
  SurfaceFrame frame;
  std::vector<LinkGroup> groups;
  DeviceArray<std::uint32_t> place;       // of all groups, padded
  DeviceArray<T> q;                       // wall distance when `age` was 0
  DeviceArray<T> rate;                    // change of q per step; empty: all zero
  T age = 0;                              // steps since q was measured; may be negative
  DeviceArray<T> opposite_q, opposite_u;  // OppositeWall of `single_cell_gap` links; empty: unknown
  /// For each link of groups `across`, padded: the index of its pair in the block's PairsAcross.
  DeviceArray<std::uint32_t> across;

  /// Returns a surface without links whose arrays are in this memory, e.g. of a device.
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

  /// Prefetches the arrays of a group.
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

/// The two populations that move between x - c_i and x - 2 c_i: f*_opp(x - c_i) and f*_i(x - 2 c_i).
template <class T>
struct BeyondPair {
  T away, toward;
};

/// The components of the directions, two bits each, so that one look-up gives all three.
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

/// The slots of a link's populations, by its direction i, relative to Block::middle() plus the offset of its
/// cell. Those further from the surface are found at either parity by steps: f*_i(x - c_i) at out - step,
/// f*_i(x - 2 c_i) at out - 2 step, f*_opp(x) at back - step, f*_opp(x - c_i) at back - 2 step.
struct LinkSlots {
  std::int32_t out[32] = {};         // f*_i(x)
  std::int32_t back[32] = {};        // f_opp(x, t + 1), which the surface returns
  std::int32_t step[32] = {};        // offset of x + c_i from x
  std::int32_t components[32] = {};  // silt::lbm::components, in memory of the device
  bool operator==(const LinkSlots&) const = default;
};
/// The largest block for which 32-bit offsets reach 9 directions from the middle.
inline constexpr std::int64_t most_cells_with_links = 220'000'000;
/// Returns the slots at `parity`, that of the block after the pass. Throws std::invalid_argument for a block
/// too large for 32-bit offsets.
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

/// The motion of a surface as a rigid body: velocity of its reference point in cells per step, angular
/// velocity in radians per step.
struct SurfaceMotion {
  double v[3] = {}, omega[3] = {};
  std::int64_t mass_by_link = 0;  // that each link also adds to its cell, in quanta of excess.hpp
};

/// Returns where a cell is from the reference point of a surface.
SILT_DEVICE inline std::array<double, 3> arm_of(const SurfaceFrame& frame, Int3 cell) {
  const Int3 from_frame = cell - frame.cell;
  return {from_frame.x + frame.offset[0], from_frame.y + frame.offset[1], from_frame.z + frame.offset[2]};
}

/// Returns the velocity of a rigid surface along c at the cell of a link; along c it equals that at the wall.
SILT_DEVICE inline double velocity_along(const SurfaceFrame& frame, const SurfaceMotion& m, Int3 cell,
                                         Int3 c) {
  const std::array<double, 3> r = arm_of(frame, cell);
  double sum = 0;
  for (int d = 0; d < 3; ++d) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    sum += c[d] * (m.v[d] + (m.omega[e] * r[f] - m.omega[f] * r[e]));
  }
  return sum;
}

/// Returns the largest |f* + f_opp| whose terms stay in range (method.md, equation 22).
SILT_DEVICE inline double largest_exchange(double reach, const SurfaceMotion& m) {
  double u = 0;
  for (int k = 0; k < 3; ++k) u += std::fabs(m.v[k]) + reach * std::fabs(m.omega[k]);
  return 32 / ((1 + reach) * (1 + u));
}

/// The quantum of force and torque in lattice units. Sums are in fixed point, so that they do not depend on
/// the order or partition of links (method.md, equation 22).
inline constexpr double link_quantum = 0x1p-44;

/// The sums of the momentum exchange on one surface in one step (method.md, equation 22).
struct LinkSums {
  std::int64_t force[3] = {}, torque[3] = {};
  std::int64_t invalid = 0;  // not 0: a term may be out of range or not a number
};

/// The resistance of a surface, H = sum 6 w J J^T with J = [c, r x c]: the decrease of force and torque with
/// its velocity (method.md, equation 23). Upper triangle, rows vx vy vz wx wy wz; in quanta of
/// resistance_quantum for the first three rows and columns, times 2^exponent >= |r x c| for each of the
/// others. In single precision the terms of 64 links fit 32 bits. `push` is sum 6 w J in the same quanta: its
/// product with the velocity (v, omega) is the mass that the links take from the fluid.
struct ResistanceSums {
  std::int64_t h[21] = {}, push[6] = {};
};
template <class T>
inline constexpr double resistance_quantum = sizeof(T) == 4 ? 0x1p-24 : 0x1p-44;
/// Returns the exponent for a surface whose cells are within `radius` of its reference point.
inline int resistance_exponent(double radius) {
  int e = 0;
  while (double(1 << e) < 1.5 * (radius + 2)) ++e;
  return e;
}

/// The group of the next call, in the same block: looked up, and prefetched if far, in the meantime.
template <class T>
struct NextGroup {
  const CutLinks<T>* links = nullptr;
  const LinkGroup* group = nullptr;
};

/// The slots of the next links: a call lists those of the next group in advance (LinkFetch in
/// cut_links_kernel.cpp).
struct ListedLinks {
  static constexpr int most = 128, most_rows = D3Q19::directions + 2;  // links of a window; slots per link
  const LinkGroup* group = nullptr;                                    // of the listed links
  int count = 0, rows = 0, half = 0;  // number of links; slots per link; array in use
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
  const BeyondPair<T>* pairs_across = nullptr;  // of the block, for groups `across`
  ListedLinks* listed = nullptr;                // shared by calls that name each other as next
  bool far = false;                             // populations are not cached: prefetch them
};

/// The link kernels of each build (cut_links_kernel.cpp, link_resistance_kernel.cpp).
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

/// Writes the populations that the surface returns along a group's links; adds to the excess of their cells
/// (excess.hpp), and to the sums of force and torque.
template <class T>
void apply_cut_links(const GroupInBlock<T>& at, const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  link_kernels<T>().apply(at, motion, form, sums);
}

/// Corrects the returned populations as if the surface had moved faster by `increment`.
template <class T>
void correct_cut_links(const GroupInBlock<T>& at, const SurfaceMotion& increment) {
  link_kernels<T>().correct(at, increment);
}

/// Returns the resistance of all links of a surface, which depends on geometry alone, for an exponent from
/// resistance_exponent().
template <class T>
ResistanceSums resistance_of(const CutLinks<T>& links, int exponent) {
  return SILT_CHOSEN(resistance<T>)()(links, exponent);
}

}  // namespace silt::lbm
