#pragma once
// Cut links: where a link from a fluid cell x along c_i meets a solid surface at a distance q c_i, q in (0,
// 1]. The dense kernel ignores them; this sparse pass then overwrites what the surface returns (NUMERICS: one
// link owns the two slots it uses, so the order of links cannot matter).
//
// What comes back is the formula of lbm/wall_scheme.hpp. All links of a run are of one scheme: where x - c_i
// is not fluid (a narrow gap) a link is put into a run of a scheme that does not read there.
//
// A group is what is applied at a time: links of one surface in a slab of planes, a run a direction. It may
// be applied once its cells and their neighbours have collided: inner groups as soon as the dense pass is
// done with plane `ready`, while the populations are still in cache; groups at the rim of the block, which
// touch ghost cells, after the halo exchange.
#include <cstdint>
#include <vector>

#include "lbm/block.hpp"
#include "lbm/wall_scheme.hpp"

namespace silt::lbm {

/// Runs are filled up to a multiple of this with copies of their last link (which then is written twice, with
/// the same value, and counted once).
inline constexpr int link_lanes = 16;

/// Links of one direction and scheme: `count` of the arrays of CutLinks from `begin`.
struct LinkRun {
  std::uint32_t begin, count;
  std::uint8_t direction;
  WallScheme scheme;
};

/// Where a link's fluid cell is, counted from its group's corner: x, y below 2^14, z below 2^4.
inline constexpr int place_bits = 14, place_planes = 16;
inline constexpr std::uint32_t link_place(int x, int y, int z) {
  return std::uint32_t(x) | std::uint32_t(y) << place_bits | std::uint32_t(z) << (2 * place_bits);
}

struct LinkGroup {
  std::uint32_t first_run, end_run;
  std::int32_t surface;
  Int3 corner;         // cell of the block that places count from (may lie outside of it)
  std::int32_t ready;  // last plane that the links read or write; -1: at the rim
};

/// Reference point of a surface: the centre of block cell `cell` is at `offset` from it.
struct SurfaceFrame {
  Int3 cell;
  double offset[3];
  double reach;  // no link's cell is further away
  bool whole;    // all links of the surface are inner groups of this block
};

/// The links of one block. A structure of arrays: 4 + sizeof(T) bytes a link.
template <class T>
struct CutLinks {
  WallFluid<T> fluid;  // that the links stand in; not cleared
  std::vector<SurfaceFrame> surfaces;
  std::vector<LinkGroup> groups;
  std::vector<LinkRun> runs;
  std::vector<std::uint32_t> place;  // kept longer than `used`: grown, never shrunk
  std::vector<T> q;
  std::uint32_t used = 0;
  std::size_t count = 0;  // of links, filling not counted

  void clear() { surfaces.clear(), groups.clear(), runs.clear(), used = 0, count = 0; }
  /// Room for `more` links beyond `used`.
  void reserve(std::size_t more) {
    if (used + more <= place.size()) return;
    place.resize((used + more) * 3 / 2), q.resize(place.size());
  }
};

/// Rigid motion of a surface: velocity of its reference point, angular velocity. Cells a step, radians a
/// step.
struct SurfaceMotion {
  double v[3] = {}, omega[3] = {};
};

/// Fixed point: sums that do not depend on the order or the partition of links. Each term is rounded once to
/// a whole number of quanta: force and torque 2^-44 (a term below 2^6 in magnitude, a sum below 2^19),
/// stiffness 2^-30 (2^20, 2^33), mass 2^-40 (2^10, 2^23); lattice units. A term that might be out of range,
/// or not a number, sets `invalid`. Sums wrap on the way without harm: only the result must be in range.
inline constexpr double link_quantum = 0x1p-44, stiffness_quantum = 0x1p-30, mass_quantum = 0x1p-40;

/// Momentum exchange (equation 6 of Goetz et al.) with deviations, on one surface in one step.
struct LinkSums {
  std::int64_t force[3] = {}, torque[3] = {};
  std::int64_t mass = 0;  // density gained by the fluid, in mass quanta
  bool invalid = false;
};

/// Sum of k J J^T, J = [c, r x c]: how force and torque fall with the surface's velocity (implicit coupling).
/// Upper triangle, rows vx vy vz wx wy wz.
struct StiffnessSums {
  std::int64_t h[21] = {};
};

/// `galilean`: Wen et al. 2014, F = sum c (f* + f_opp) - u_w (f* - f_opp). `exact`: equation 6 alone.
enum class ForceForm : std::uint8_t { galilean, exact };

/// Writes what the surface returns along the group's links, and adds force, torque and mass. `parity` is the
/// block's parity after the pass.
template <class T>
void apply_cut_links(Block<T>&, Parity, const CutLinks<T>&, const LinkGroup&, const SurfaceMotion&, ForceForm,
                     LinkSums&);

/// Changes what was returned as if the surface had moved faster by `increment`; adds the mass only.
template <class T>
void correct_cut_links(Block<T>&, Parity, const CutLinks<T>&, const LinkGroup&,
                       const SurfaceMotion& increment, LinkSums&);

/// Adds the group's share; depends on geometry only.
template <class T>
void sum_stiffness(const CutLinks<T>&, const LinkGroup&, StiffnessSums&);

}  // namespace silt::lbm
