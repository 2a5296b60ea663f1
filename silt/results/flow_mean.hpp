#pragma once
// Time averages of the fluid for [output.mean]. Per cell: velocity, its covariance and pressure over the
// samples in which it was fluid, velocity of bodies over the others, and the share of samples in which it was
// solid. Checkpoints keep the sums, so that a resumed run gets the same results bitwise (Welford,
// Technometrics 4 (1962) 419).
#include <cstdint>
#include <filesystem>
#include <vector>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "adapters/hdf5/field_file.hpp"
#include "silt/simulation.hpp"

namespace silt {

class FlowMean {
 public:
  /// Has no sample yet; the case must have output.mean, whose cells stay on their ranks.
  explicit FlowMean(const Simulation&);

  /// Adds a sample if the step is to be sampled. Local.
  void observe(const Simulation&);
  /// Writes mean_STEP.hdf in units of the case, unless there is no sample. Collective.
  void write(const Simulation&, const std::filesystem::path& folder, const adapters::Provenance&) const;

  /// Write the sums to a checkpoint and read them; the checkpoint must have been sampled as the case asks.
  /// Collective. restore() throws std::runtime_error for impossible values.
  void save(adapters::CheckpointWriter&, const Simulation&) const;
  void restore(const adapters::CheckpointReader&, const Simulation&);

 private:
  /// The arrays of a block: number of fluid samples, mean velocity, sums of products of deviations (xx yy zz
  /// xy xz yz), mean density deviation, mean velocity of bodies.
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
