#pragma once
// Builds the cut links of a block: from each fluid cell to neighbours in a body, with wall distances.
#include "coupler/mapping/block_links.hpp"
#include "coupler/mapping/device_mapping.hpp"
#include "coupler/mapping/mesh_distances.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "coupler/spec/flow_spec.hpp"
#include "lbm/blocks/pass_order.hpp"
#include "lbm/walls/cut_links.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::coupler {

/// The context of a block's links: coupling, fluid, and the dense pass that groups wait for.
template <class T>
struct LinkRules {
  const CouplingSpec& coupling;
  const lbm::WallFluid<T>& fluid;
  const lbm::PassOrder& sweep;
  MeshDistances* meshes = nullptr;            // reuses its memory between mappings; null: own memory
  DeviceMapping<T>* device = nullptr;         // of the device for which links are built; null: CPU
  rigid::Vec3 periods = rigid::Vec3::Zero();  // of the domain, cells; 0: not periodic
};

/// Builds the links of the block's masks, surface by surface, and under implicit coupling the resistance of
/// free bodies. Takes the surfaces of the last mapping and keeps links of masks marked as kept. Special
/// groups:
/// - `single_cell_gap`: the formula would read the cell behind, which is not fluid;
/// - lbm::two_cell_gap_scheme: it would read the second cell behind, which is not fluid;
/// - `across`: it would, but the cell behind is in another block; pairs are at the block's lbm::PlacesAcross;
/// - `crossing`: crossing links (crossing_links.hpp).
template <class T>
void build_links(const BlockMap&, const rigid::World&, const rigid::BodySet&, const LinkRules<T>&,
                 std::vector<SurfaceLinks<T>>&);

}  // namespace silt::coupler
