#pragma once
// Writes fields of the fluid during a run.
#include <filesystem>
#include <vector>

#include "adapters/hdf5/field_file.hpp"
#include "silt/case/output_spec.hpp"
#include "silt/case/units.hpp"
#include "silt/simulation.hpp"

namespace silt {

/// Returns the boxes of this rank's blocks.
std::vector<adapters::CellBox> boxes_of(const coupler::FluidFields&);

/// Returns the smallest box around the blocks of all levels, in finest cells; empty if there are none.
adapters::CellBox box_of(const coupler::Flow&);

/// A field on that box, in lattice units; finest cells have the value of the coarse cell that they lie in.
struct FieldHere {
  adapters::CellBox box;
  int components = 1;          // or 3
  std::vector<double> values;  // x fastest, components innermost; NaN in cells of other ranks
};

/// Returns a field as it is written to files. Needs a flow; collective for the vorticity.
FieldHere field_here(const Simulation&, Field);

/// Returns the density, pressure or shear rate of a fluid cell, in units of the finest lattice.
double scalar_of(const coupler::FluidFields&, Field, const lbm::Moments&);
Dimension dimension_of(Field);

/// Returns an empty snapshot for a box of a part of [output]; by level, for the whole domain.
adapters::FieldSnapshot snapshot_of(const Simulation&, const FieldsSpec&, bool by_level);

/// Writes the fields of a part of [output] in its box, in units of the case. A solid cell has the velocity,
/// vorticity and id of its body (walls: no id), the reference density, zero pressure and shear; `solid` is 1
/// in bodies, 2 in walls. Levels are written as such. Collective; throws std::runtime_error on every rank.
void write_flow_fields(const Simulation&, const FieldsSpec&, const std::filesystem::path& folder,
                       const adapters::Provenance&);

}  // namespace silt
