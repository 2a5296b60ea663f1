#pragma once
// The cut links of a block, built from its map: for every fluid cell next to a body's cell, the distance of
// the surface.
#include "coupler/mapping/block_links.hpp"
#include "coupler/mapping/device_mapping.hpp"
#include "coupler/mapping/mesh_distances.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "coupler/spec/coupling_spec.hpp"
#include "lbm/blocks/pass_order.hpp"
#include "lbm/walls/cut_links.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

/// The rules by which the links of a block are built: the coupling, the fluid that they stand in, and the
/// pass they wait for.
template <class T>
struct LinkRules {
  const CouplingSpec& coupling;
  const lbm::WallFluid<T>& fluid;
  const lbm::PassOrder& sweep;
  MeshDistances* meshes = nullptr;     // whose memory serves from one mapping to the next; none: its own
  DeviceMapping<T>* device = nullptr;  // of the device that the links are for; none: the cpu
};

/// Builds the links of the block's masks, surface by surface, with the resistance of free bodies under
/// implicit coupling; those that the last mapping kept are kept, given the surfaces of the mapping before.
/// Links whose formula would read the cell behind where that is not fluid (a single-cell gap) go into groups
/// of `single_cell_gap`; those that would read beyond it where that is not fluid, into groups of
/// lbm::two_cell_gap_scheme; those that would and whose cell behind is not of the block, into groups
/// `across`, with pairs at the block's lbm::PlacesAcross.
/// Crossing links (crossing_links.hpp) have groups `crossing`.
template <class T>
void build_links(const BlockMap&, const rigid::World&, const rigid::BodySet&, const LinkRules<T>&,
                 std::vector<SurfaceLinks<T>>&);

}  // namespace silt::coupler
