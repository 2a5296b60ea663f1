#pragma once
// Fields of the fluid, which a run writes while it goes on.
#include <filesystem>
#include <vector>

#include "adapters/hdf5/field_file.hpp"
#include "silt/case/output_spec.hpp"
#include "silt/case/units.hpp"
#include "silt/simulation.hpp"

namespace silt {

/// Returns the boxes of this rank's blocks.
std::vector<adapters::CellBox> boxes_of(const coupler::FluidFields&);

/// Returns the smallest box around those of all levels, in finest cells; an empty one without.
adapters::CellBox box_of(const coupler::Flow&);

/// FieldHere is a field on that box, in lattice units; finest cells have the value of the coarse one they
/// fill.
struct FieldHere {
  adapters::CellBox box;
  int components = 1;          // or 3
  std::vector<double> values;  // x fastest, components innermost; nan in cells of other ranks
};

/// Makes a field as it would be written. Collective if it is the vorticity; needs a flow.
FieldHere field_here(const Simulation&, Field);

/// Returns the density, pressure or shear rate of a fluid cell, in units of the finest lattice.
double scalar_of(const coupler::FluidFields&, Field, const lbm::Moments&);
Dimension dimension_of(Field);

/// Returns a snapshot of the box of a part of [output], without quantities; by level, of the whole domain.
adapters::FieldSnapshot snapshot_of(const Simulation&, const FieldsSpec&, bool by_level);

/// Writes the fields that a part of [output] asks for, in its box, in the units of the case. A solid cell has
/// the velocity, the vorticity and the id of its body (in a wall: none), the reference density, no pressure
/// and no shear; `solid` is 1 in bodies and 2 in walls. Cells of several levels are written as such.
/// Collective; std::runtime_error on every rank.
void write_flow_fields(const Simulation&, const FieldsSpec&, const std::filesystem::path& folder,
                       const adapters::Provenance&);

}  // namespace silt
