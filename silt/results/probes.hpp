#pragma once
// Fields of the fluid at points, for [[output.probes]]: trilinear between the centres of the eight cells
// around a point, of the level that the point's cell has. One that is not fluid, or of another level, has the
// value there of the linear function that is nearest (least squares) to the others and to the cells next to
// these outward, so that a linear field is exact up to walls and to borders of levels. Where none of the
// eight is there is no value.
#include <string>
#include <vector>

#include "parallel/pending_sums.hpp"
#include "rigid/math/types.hpp"
#include "silt/case/output_spec.hpp"
#include "silt/results/run_tables.hpp"
#include "silt/simulation.hpp"

namespace silt {

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
  int numbers() const;  // of a cell
  std::size_t width() const;
  void see(const coupler::FluidFields&, const rigid::Vec3& point, std::span<double> of_point) const;
  void see_cell(const coupler::FluidFields&, int block, lbm::Int3 cell, double* numbers) const;
  std::vector<double> at(const rigid::Vec3& point, const double* of_point) const;
  void finish(const Case&);

  ProbesSpec spec_;
  std::int64_t step_ = 0;  // of the look under way
  int levels_ = 0;         // the same; 0: there is none
  TableRows rows_;
  // of each point: the level of its cell, and of each level the numbers of its stencil's cells
  parallel::PendingMaxima<std::vector<double>> seen_;
};

}  // namespace silt
