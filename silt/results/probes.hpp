#pragma once
// Fields of the fluid at points, for [[output.probes]]: trilinear between the centres of the eight cells
// around a point, on the level of the point's cell. A cell that is not fluid, or of another level, gets the
// value of the linear least-squares fit to the other cells and their outward neighbours, so that linear
// fields are exact up to walls and borders of levels. There is no value if none of the eight is fluid.
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

  /// Starts a sample of the fluid; waits only for the last one. Collective.
  void look(const Simulation&);
  /// Waits for the sample under way. Returns the rows of samples since the last call, one per point, the same
  /// on every rank and any number of ranks. Collective.
  TableRows take_rows(const Case&);
  std::string columns() const;
  /// Returns the fields of a row that identify its point: index and coordinates.
  std::vector<std::string> places(const Case&) const;

 private:
  int numbers() const;  // per cell
  std::size_t width() const;
  void see(const coupler::FluidFields&, const rigid::Vec3& point, std::span<double> of_point) const;
  void see_cell(const coupler::FluidFields&, int block, lbm::Int3 cell, double* numbers) const;
  std::vector<double> at(const rigid::Vec3& point, const double* of_point) const;
  void finish(const Case&);

  ProbesSpec spec_;
  std::int64_t step_ = 0;  // of the sample under way
  int levels_ = 0;         // likewise; 0: none
  TableRows rows_;
  // per point: the level of its cell, and for each level the values of the stencil's cells
  parallel::PendingMaxima<std::vector<double>> seen_;
};

}  // namespace silt
