#pragma once
// The series of the bodies, bodies.h5 and what goes on from it, which a run writes while it goes on.
#include <filesystem>
#include <vector>

#include "adapters/hdf5/body_series.hpp"
#include "coupler/simulation.hpp"

namespace silt::coupler {

/// Returns the kinds of bodies of a case with their surfaces, as the series holds them.
std::vector<adapters::BodyKind> drawn_kinds(const Case&);

/// BodyOutput writes the series of the bodies of a run, in the units of the case.
class BodyOutput {
 public:
  /// Starts a series in the folder; if `resumed`, continues the one there at the simulation's step.
  /// Collective.
  BodyOutput(const Simulation&, const std::filesystem::path& folder, const adapters::Provenance&,
             bool resumed);
  /// Appends the bodies as they are now; forces and torques are those of the last step.
  /// Collective.
  void append(const Simulation&);

 private:
  std::filesystem::path path_;
  adapters::BodySeries series_;
};

}  // namespace silt::coupler
