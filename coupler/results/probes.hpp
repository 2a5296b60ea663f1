#pragma once
// Fields of the fluid at points, for [[output.probes]]: trilinear between the centres of the cells around a
// point, of the level that the point's cell has. Of these only fluid cells of that level count, by their
// weights; where there is none there is no value.
#include <string>
#include <vector>

#include "coupler/case/output_spec.hpp"
#include "coupler/results/run_tables.hpp"
#include "coupler/simulation.hpp"
#include "parallel/sums_under_way.hpp"
#include "rigid/math/exact_sum.hpp"

namespace silt::coupler {

class Probes {
 public:
  explicit Probes(const ProbesSpec& spec) : spec_(spec) {}

  /// Collective: begins a look at the fluid, and waits only for the one before.
  void look(const Simulation&);
  /// Collective: waits for the look under way. Returns the rows of the looks since the last call, a point
  /// each; the same on every rank and any number of ranks.
  TableRows take_rows(const Case&);
  std::string columns() const;
  /// Returns the fields of a row that say which point it is of: its number and its coordinates.
  std::vector<std::string> places(const Case&) const;

 private:
  int terms() const;  // of a level: the weights, and the weighted numbers
  void add(const FluidFields&, const rigid::Vec3& point, std::span<rigid::ExactSum>) const;
  void finish(const Case&);
  void add_cell(const FluidFields&, int block, lbm::Int3 cell, double weight,
                std::span<rigid::ExactSum>) const;

  ProbesSpec spec_;
  std::int64_t step_ = 0;  // of the look under way
  int levels_ = 0;         // the same; 0: there is none
  TableRows rows_;
  // of each point: the level of its cell, counted from 1, and the terms of each level
  parallel::SumsUnderWay<std::vector<rigid::ExactSum>> sums_;
};

}  // namespace silt::coupler
