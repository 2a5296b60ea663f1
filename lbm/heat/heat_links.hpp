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

/// The links along the axes of one surface in a block, between the exchange of a pass and the next pass; the
/// parity is that after the exchange.
template <class T>
class SurfaceHeatLinks {
 public:
  SurfaceHeatLinks(Block<T, D3Q7>&, Parity, const CutLinks<T>&, const SurfaceMotion&,
                   std::span<const HeatLink>);

  std::int64_t count() const { return std::int64_t(along_axes_.size()); }
  /// Lets the links of an insulating surface that lead into pockets tell of themselves.
  void tell_pockets(const HeatSpec&, std::span<PocketLink>) const;
  /// Writes what the surface returns along its links, once pockets are told.
  HeatSums apply(const SurfaceHeat&, PocketLinks) const;
  /// Corrects what the surface returned as if it were warmer by `increment`. Returns what the surface gets by
  /// that, in heat_quantum.
  std::int64_t correct(double increment) const;

 private:
  double out(const HeatLink& l) const { return data_[leaving_[l.direction] + l.cell]; }
  double against(const HeatLink& l) const { return data_[leaving_[opposite(l.direction)] + l.cell]; }
  double behind(const HeatLink& l) const { return data_[arriving_[l.direction] + l.cell]; }
  T& back(const HeatLink& l) const { return data_[arriving_[opposite(l.direction)] + l.cell]; }
  double distance(const HeatLink&) const;
  double swept(const HeatLink&) const;
  double temperature_at(const SurfaceHeat&, const HeatLink&, double q) const;

  const Block<T, D3Q7>& block_;
  const CutLinks<T>& links_;
  const SurfaceMotion& motion_;
  std::span<const HeatLink> along_axes_;
  T* data_;
  // Where the populations lie that left cells, and those that arrive: from behind, or from the surface.
  std::ptrdiff_t leaving_[D3Q7::directions], arriving_[D3Q7::directions];
};

}  // namespace silt::lbm
