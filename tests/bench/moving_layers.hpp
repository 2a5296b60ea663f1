#pragma once
// Layers of bodies (layers.hpp) in motion, timed stage by stage.
#include <array>
#include <vector>

#include "silt/simulation.hpp"
#include "tests/bench/figures.hpp"
#include "tests/bench/layers.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::bench {

/// Steps from one mapping of all bodies to the next, as fast as they are (mapping_poses.cpp).
inline constexpr int round_of_mapping = 9;

/// A scene, and the seconds a step of it took: all, and stage by stage.
class MovingLayers {
 public:
  explicit MovingLayers(const Layers& layers, const std::vector<std::string>& overrides = {})
      : layers_(layers), simulation_(testing::simulation_of(layers.text(), MPI_COMM_SELF, overrides)) {
    for (int t = 0; t < round_of_mapping; ++t) step();
  }
  void take_turn(int steps) {
    const coupler::StageSeconds before = simulation_.stage_seconds();
    for (int t = 0; t < steps; ++t) step();
    double all = 0;
    for (std::size_t k = 0; k < stages_.size(); ++k) {
      const double seconds = (simulation_.stage_seconds()[k] - before[k]) / steps;
      all += seconds;
      stages_[k].add(seconds);
    }
    whole_.add(all);
  }
  const Layers& layers() const { return layers_; }
  Simulation& simulation() { return simulation_; }
  double links() const { return double(simulation_.links()); }
  double fluid_cells() { return double(simulation_.checked_totals().fluid_cells); }
  const Spread& whole() const { return whole_; }
  double seconds_of(coupler::Stage stage) const { return stages_[int(stage)].middle(); }

 private:
  /// The fluid would slow the bodies down: they are set going again before every step (not timed).
  void step() {
    const auto v = layers_.velocity();
    rigid::BodySet& bodies = simulation_.bodies();
    for (std::size_t row = 0; row < bodies.owned; ++row)
      bodies.set_velocity(row, {v[0], v[1], v[2]}, rigid::Vec3::Zero());
    simulation_.step();
  }
  Layers layers_;
  Simulation simulation_;
  Spread whole_;
  std::array<Spread, std::size_t(coupler::Stage::count)> stages_;
};

}  // namespace silt::bench
