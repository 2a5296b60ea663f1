#pragma once
// The files of a run that pictures show: scene.h5, and the series of the bodies, bodies.h5.
#include <filesystem>
#include <vector>

#include "adapters/hdf5/body_series.hpp"
#include "silt/simulation.hpp"

namespace silt {

/// Writes scene.h5: the sides, gravity, walls and driven kinds of a case (scene_output.cpp).
/// std::runtime_error.
void write_scene_file(const Case&, const std::filesystem::path& folder);

/// Returns the kinds of bodies of a case with their surfaces, as the series holds them.
std::vector<adapters::BodyKind> drawn_kinds(const Case&);

/// BodyOutput writes the series of the bodies of a run, in the units of the case.
class BodyOutput {
 public:
  /// Collective. Starts a series in the folder; if `resumed`, continues the one there at the simulation's
  /// step.
  BodyOutput(const Simulation&, const std::filesystem::path& folder, const adapters::Provenance&,
             bool resumed);
  /// Collective. Appends the bodies as they are now; forces and torques are those of the last step.
  void append(const Simulation&);

 private:
  std::filesystem::path path_;
  adapters::BodySeries series_;
};

}  // namespace silt
