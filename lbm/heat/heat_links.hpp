#pragma once
// What cut links return of the temperature (method-heat.md, equation H5). They are those links of the fluid
// that lie along the axes; a link owns its slots as those of the fluid do, so their order does not matter.
// Crossing links pass heat.
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "lbm/heat/temperature.hpp"
#include "lbm/walls/cut_links.hpp"

namespace silt::lbm {

/// The quantum of sums of heat, lattice units.
inline constexpr double heat_quantum = 0x1p-40;
/// Returns heat in quanta, rounded.
inline std::int64_t heat_quanta(double heat) {
  return std::llrint(heat / heat_quantum);
}

struct HeatLink {
  std::int32_t cell;   // Block::cell of the fluid cell
  std::uint32_t link;  // index in CutLinks::q
  std::int8_t direction;
  bool gap;                  // the cell behind is solid
  std::int32_t pocket = -1;  // its place in PocketLinks; -1: none
};

/// What links of an insulating surface tell each other that lead into one solid cell, a pocket: the
/// population less the stream of the surface, and its share (H6). Those of a pocket are `pocket_links` in
/// turn, by direction; a share of 0 is no link.
struct PocketLink {
  double population = 0, share = 0;
};
inline constexpr int pocket_links = D3Q7::directions - 1;
using PocketLinks = std::span<const PocketLink>;

/// What a surface is to the heat of the fluid in a step.
struct SurfaceHeat {
  bool insulates = true;
  double temperature = 0;           // less the reference temperature
  std::int64_t by_each_link = 0;    // heat_quantum that each link also returns
  const HeatSpec* fluid = nullptr;  // of a mean gradient (H9) that the surface lacks; null: none
};

/// What the surface gets over its links in a step, and H of (H7), both in heat_quantum.
struct HeatSums {
  std::int64_t heat = 0, conductance = 0;
};

/// Appends the links of a group that lie along the axes; solid(cell of the block) tells of the cells behind.
template <class T, class Solid>
void add_heat_links(const Block<T, D3Q7>& block, const CutLinks<T>& links, const LinkGroup& group,
                    Solid&& solid, std::vector<HeatLink>& all) {
  if (group.crossing) return;
  for (std::uint32_t l = group.begin; l < group.begin + group.count; ++l) {
    const int i = place_direction(links.place[l]);
    if (i >= D3Q7::directions) continue;
    const Int3 cell = group.corner + place_cell(links.place[l]);
    all.push_back({std::int32_t(block.cell(cell)), l, std::int8_t(i), solid(cell - D3Q7::c[i])});
  }
}

/// Lets the links of an insulating surface that lead into pockets tell of themselves, after the exchange of a
/// pass; `parity` is that after it.
template <class T>
void tell_pockets(Block<T, D3Q7>&, Parity, const CutLinks<T>&, std::span<const HeatLink>,
                  const SurfaceMotion&, const HeatSpec&, std::span<PocketLink>);

/// Writes what a surface returns along its links, once pockets are told. Adds to the sums.
template <class T>
void apply_heat_links(Block<T, D3Q7>&, Parity, const CutLinks<T>&, std::span<const HeatLink>,
                      const SurfaceHeat&, const SurfaceMotion&, PocketLinks, HeatSums&);

/// Corrects what it returned as if it were warmer by `increment`. Returns what the surface gets by that, in
/// heat_quantum.
template <class T>
std::int64_t correct_heat_links(Block<T, D3Q7>&, Parity, const CutLinks<T>&, std::span<const HeatLink>,
                                double increment);

}  // namespace silt::lbm
