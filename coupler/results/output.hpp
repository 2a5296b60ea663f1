#pragma once
// What a run writes while it goes on: fields of the fluid and the series of the bodies.
#include <filesystem>
#include <optional>

#include "adapters/hdf5/body_series.hpp"
#include "adapters/hdf5/boxes.hpp"
#include "coupler/simulation.hpp"

namespace silt::coupler {

/// Returns the boxes of this rank's blocks; empty without a flow.
std::vector<adapters::CellBox> boxes_of(const Flow*);

/// Writes velocity and density of every cell, in the units of the case (velocity, density as output.fields
/// names them). A solid cell has the velocity of its body and the reference density. Collective;
/// std::runtime_error on every rank.
void write_flow_fields(const Simulation&, const std::filesystem::path& folder, const adapters::Provenance&);

/// Writes the series of the bodies of a run, in the units of the case.
class BodyOutput {
 public:
  /// Collective. resumed: goes on with the series in the folder (or starts one, if there is none) at the
  /// simulation's step.
  BodyOutput(const Simulation&, const std::filesystem::path& folder, const adapters::Provenance&,
             bool resumed);
  /// Collective. Force and torque are those of the fluid in the last step.
  void append(const Simulation&);

 private:
  std::optional<adapters::BodySeries> series_;
};

}  // namespace silt::coupler
