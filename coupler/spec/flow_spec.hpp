#pragma once
// A flow with bodies: domain, fluid and coupling, in lattice units (cell = step = reference density = 1).
#include <array>
#include <optional>

#include "coupler/spec/coarsening_spec.hpp"
#include "coupler/spec/coupling_spec.hpp"
#include "coupler/spec/fluid_spec.hpp"
#include "coupler/spec/heat_spec.hpp"
#include "coupler/spec/sides.hpp"
#include "device/device.hpp"
#include "rigid/bodies/body_exchange.hpp"

namespace silt::coupler {

struct FlowSpec {
  std::array<int, 3> cells{};
  std::array<BoundarySpec, 6> boundary;           // by Side
  std::optional<std::array<int, 3>> block_cells;  // none: "auto"
  std::optional<FluidSpec> fluid;                 // none: bodies alone
  std::optional<HeatSpec> heat;                   // none: the fluid has no temperature
  std::optional<CoarseningSpec> coarsening;       // none: every cell is finest
  CouplingSpec coupling;
  Device device = Device::cpu;

  bool periodic(int axis) const { return boundary[2 * axis].is_periodic(); }
  double volume() const { return 1. * cells[0] * cells[1] * cells[2]; }  // in cells
};

/// Returns the extent of the domain for bodies.
rigid::Extent extent_of(const FlowSpec&);
rigid::BoundingBox box_of(const FlowSpec&);
/// Returns the sides of the domain for the fluid.
std::array<lbm::SideCondition, 6> sides_of(const FlowSpec&);

/// Returns the shortest displacement between a point and the periodic images of another.
rigid::Vec3 nearest_image(rigid::Vec3 displacement, const rigid::Extent&);

/// Returns the number of finest cells needed between a surface and the nearest coarser cell in every step:
/// the reach of links, the distance mapped ahead, and the two cells filled at a border.
int least_margin(const CouplingSpec&);

}  // namespace silt::coupler
