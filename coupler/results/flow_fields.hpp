#pragma once
// Fields of the fluid, which a run writes while it goes on.
#include <filesystem>
#include <vector>

#include "adapters/hdf5/boxes.hpp"
#include "adapters/hdf5/provenance.hpp"
#include "coupler/case/output_spec.hpp"
#include "coupler/simulation.hpp"

namespace silt::coupler {

/// Returns the boxes of this rank's blocks; empty without a flow.
std::vector<adapters::CellBox> boxes_of(const Flow*);

/// Writes the fields that a part of [output] asks for, in its box, in the units of the case. A solid cell has
/// the velocity, the vorticity and the id of its body (in a wall: none), the reference density, no pressure
/// and no shear.
/// Collective; std::runtime_error on every rank.
void write_flow_fields(const Simulation&, const FieldsSpec&, const std::filesystem::path& folder,
                       const adapters::Provenance&);

}  // namespace silt::coupler
