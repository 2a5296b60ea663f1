#pragma once
// Cut links: where a link from a fluid cell x along c_i meets a solid surface at a distance q c_i, q in (0,
// 1]. The dense kernel ignores them; this sparse pass then overwrites what the surface returns (NUMERICS: one
// link owns the two slots it uses, so the order of links cannot matter).
//
// Runs after the halo exchange of the same pass: a link's solid cell, and the cell behind x, may be ghosts.
//
// What comes back is the formula of lbm/wall_scheme.hpp. All links of a run are of one scheme: where x - c_i
// is not fluid (a narrow gap) a link is put into a run of a scheme that does not read there.
#include <cstdint>
#include <vector>

#include "lbm/block.hpp"
#include "lbm/wall_scheme.hpp"

namespace silt::lbm {

/// Links of one direction and scheme on one surface: [begin, end) of the arrays of CutLinks.
struct LinkRun {
  std::uint32_t begin, end;
  std::int32_t surface;
  std::uint8_t direction;
  WallScheme scheme;
};

/// The links of one block. A structure of arrays: 4 + 4 sizeof(T) bytes a link.
template <class T>
struct CutLinks {
  std::vector<LinkRun> runs;
  std::vector<std::int32_t> cell;  // Block::cell of the fluid cell
  std::vector<T> q, rx, ry, rz;    // r: the fluid cell's centre from the surface's reference point
  std::size_t size() const { return cell.size(); }
  void clear() { runs.clear(), cell.clear(), q.clear(), rx.clear(), ry.clear(), rz.clear(); }
};

/// Rigid motion of a surface: velocity of its reference point, angular velocity. Cells a step, radians a
/// step.
struct SurfaceMotion {
  double v[3] = {}, omega[3] = {};
};

/// Fixed point: sums that do not depend on the order or the partition of links. Each term is rounded once to
/// a whole number of quanta: force and torque 2^-44 (a term below 2^6 in magnitude, a sum below 2^19),
/// stiffness 2^-30 (2^20, 2^33), mass 2^-40 (2^10, 2^23); lattice units. A term out of range, or not a
/// number, sets `invalid`. Sums wrap on the way without harm: only the result must be in range.
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
  bool invalid = false;
};

/// `galilean`: Wen et al. 2014, F = sum c (f* + f_opp) - u_w (f* - f_opp). `exact`: equation 6 alone.
enum class ForceForm : std::uint8_t { galilean, exact };

/// Writes what every surface returns, and adds force, torque and mass to sums[run.surface]. `parity` is the
/// block's parity after the pass.
template <class T>
void apply_cut_links(Block<T>&, Parity, const CutLinks<T>&, const SurfaceMotion* motions, ForceForm,
                     LinkSums* sums);

/// Changes what was returned as if the surfaces had moved faster by `increments`; adds the mass only.
template <class T>
void correct_cut_links(Block<T>&, Parity, const CutLinks<T>&, const SurfaceMotion* increments,
                       LinkSums* sums);

/// Adds the links' share to sums[run.surface]; depends on geometry only.
template <class T>
void sum_stiffness(const CutLinks<T>&, StiffnessSums* sums);

}  // namespace silt::lbm
