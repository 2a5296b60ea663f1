#pragma once
// Means of the fluid over samples in time, for [output.mean]: of each cell, over the samples in which it was
// fluid, velocity, its covariance, and pressure, over the others the velocity of bodies; and the share of
// samples in which it was solid. They go through checkpoints, so that a resumed run comes to the same numbers
// bitwise (Welford, Technometrics 4 (1962) 419).
#include <cstdint>
#include <filesystem>
#include <vector>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "adapters/hdf5/field_file.hpp"
#include "silt/simulation.hpp"

namespace silt {

class FlowMean {
 public:
  /// Begins without a sample, for a case with output.mean, whose cells stay on their ranks.
  explicit FlowMean(const Simulation&);

  /// Takes a sample, if the step is one of those to be sampled. Local.
  void observe(const Simulation&);
  /// Collective. Writes mean_STEP.hdf, in the units of the case; not without a sample.
  void write(const Simulation&, const std::filesystem::path& folder, const adapters::Provenance&) const;

  /// Collective. Writes the samples to a checkpoint, and reads them from one whose samples were taken as the
  /// case asks for; std::runtime_error for numbers that no samples give.
  void save(adapters::CheckpointWriter&, const Simulation&) const;
  void restore(const adapters::CheckpointReader&, const Simulation&);

 private:
  /// The numbers of a cell, one array after the other: how often it was fluid, mean velocity, sums of the
  /// products of deviations (xx yy zz xy xz yz), mean density deviation, mean velocity of bodies.
  enum Number { count, velocity = 1, products = 4, density = 10, body_velocity = 11, numbers = 14 };
  struct Block {
    std::int64_t cells, of_a_plane;
    std::vector<double> values;
    double* array(int number) { return values.data() + number * cells; }
    const double* array(int number) const { return values.data() + number * cells; }
  };
  adapters::FieldQuantity quantity(const char* name, const char* unit, double scale, int first,
                                   int components, bool of_products) const;

  MeanSpec spec_;
  std::int64_t samples_ = 0;
  std::vector<Block> blocks_;
};

}  // namespace silt
