#include "coupler/flow_totals.hpp"

#include <algorithm>
#include <cmath>

#include "coupler/mapping/solid_map.hpp"
#include "lbm/fluid.hpp"
#include "lbm/walls/cut_links.hpp"

namespace silt::coupler {

using lbm::Int3;

void FlowSums::add(Int3 g, const lbm::Moments& m, const std::array<double, 3>& u) {
  using lbm::CellTotals;
  constexpr double no_flow_is_so_fast = 1e3;  // reported as a speed, not as not-a-number
  const auto quanta = [](double x, double quantum) { return std::int64_t(std::llrint(x / quantum)); };
  CellTotals t;
  t.speed_squared = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
  if (!std::isfinite(m.density_deviation) || !(t.speed_squared < no_flow_is_so_fast * no_flow_is_so_fast)) {
    first_bad_ = std::min(first_bad_, index_of(g));
    return;
  }
  t.mass = lbm::mass_quanta(m);
  t.mass_square = quanta(m.density_deviation * m.density_deviation, CellTotals::square_quantum);
  for (int d = 0; d < 3; ++d) t.momentum[d] = quanta(m.momentum[d], CellTotals::momentum_quantum);
  t.energy = quanta(0.5 * t.speed_squared, CellTotals::energy_quantum);
  t.energy_rest = quanta(0.5 * t.speed_squared - double(t.energy) * CellTotals::energy_quantum,
                         CellTotals::energy_rest_quantum);
  t.least_deviation = t.most_deviation = m.density_deviation;
  add(1, t);
  see(g, t);
}

void FlowSums::add(int cells, const lbm::CellTotals& t) {
  const auto of_finest = [volume = std::int64_t{1} << 3 * level_](rigid::FixedSum x) { return x * volume; };
  count_ += std::uint64_t(cells) << 3 * level_;
  forces_ += std::uint64_t(cells) << 4 * level_;
  mass_ += of_finest(t.mass), mass_square_ += of_finest(t.mass_square);
  for (int d = 0; d < 3; ++d) momentum_[d] += of_finest(t.momentum[d]);
  energy_ += of_finest(t.energy), energy_rest_ += of_finest(t.energy_rest);
  max_excess_ = std::max(max_excess_, t.most_deviation);
}

void FlowSums::add(const FlowSums& other) {
  count_ += other.count_, forces_ += other.forces_;
  mass_ += other.mass_, mass_square_ += other.mass_square_;
  for (int d = 0; d < 3; ++d) momentum_[d] += other.momentum_[d];
  energy_ += other.energy_, energy_rest_ += other.energy_rest_;
  max_excess_ = std::max(max_excess_, other.max_excess_);
  speed_squared_.see(other.speed_squared_.value, other.speed_squared_.cell);
  deficit_.see(other.deficit_.value, other.deficit_.cell);
  cold_.see(other.cold_.value, other.cold_.cell);
  heat_.see(other.heat_.value, other.heat_.cell);
  first_bad_ = std::min(first_bad_, other.first_bad_);
}

void FlowSums::see(Int3 g, const lbm::CellTotals& t) {
  speed_squared_.see(t.speed_squared, index_of(g));
  deficit_.see(-t.least_deviation, index_of(g));
  cold_.see(-t.least_temperature, index_of(g));
  heat_.see(t.most_temperature, index_of(g));
}

FlowTotals FlowSums::over_ranks(MPI_Comm comm) const {
  using lbm::CellTotals;
  struct Sums {
    std::uint64_t cells, forces;
    parallel::WideSum mass, mass_square, momentum[3], energy, energy_rest;
  };
  const Sums sums = parallel::sum_over_ranks(comm, Sums{count_,
                                                        forces_,
                                                        mass_,
                                                        mass_square_,
                                                        {momentum_[0], momentum_[1], momentum_[2]},
                                                        energy_,
                                                        energy_rest_});
  const auto in_all = [](const parallel::WideSum& sum, double quantum) {
    return double(sum.value()) * quantum;
  };
  Extreme speed_squared = speed_squared_, deficit = deficit_, cold = cold_, heat = heat_;
  for (Extreme* const extreme : {&speed_squared, &deficit, &cold, &heat}) extreme->over_ranks(comm);
  const auto bad = std::int64_t(parallel::least_over_ranks(comm, std::uint64_t(first_bad_)));
  FlowTotals t;
  t.fluid_cells = sums.cells, t.forces = sums.forces;
  t.mass_deviation = in_all(sums.mass, lbm::mass_quantum);
  if (sums.cells > 0)
    t.density_deviation =
        std::sqrt(in_all(sums.mass_square, CellTotals::square_quantum) / double(sums.cells));
  for (int d = 0; d < 3; ++d) t.momentum[d] = in_all(sums.momentum[d], CellTotals::momentum_quantum);
  t.energy = in_all(sums.energy, CellTotals::energy_quantum) +
             in_all(sums.energy_rest, CellTotals::energy_rest_quantum);
  t.max_speed = std::sqrt(std::max(speed_squared.value, 0.0)), t.min_density = 1 - deficit.value;
  t.max_density = 1 + parallel::max_over_ranks(comm, max_excess_);
  t.finite = bad == none;
  t.bad_cell = cell_at(bad), t.fastest_cell = cell_at(speed_squared.cell);
  t.thinnest_cell = cell_at(deficit.cell);
  t.min_temperature = -cold.value, t.coldest_cell = cell_at(cold.cell);
  t.max_temperature = heat.value, t.hottest_cell = cell_at(heat.cell);
  return t;
}

void FlowSums::Extreme::over_ranks(MPI_Comm comm) {
  const double largest = parallel::max_over_ranks(comm, value);
  cell = std::int64_t(parallel::least_over_ranks(comm, std::uint64_t(value == largest ? cell : none)));
  value = largest;
}

lbm::Int3 FlowSums::cell_at(std::int64_t index) const {
  if (index == none) return {};
  const std::int64_t x = cells_.x << level_, y = cells_.y << level_;
  return {int(index % x), int(index / x % y), int(index / x / y)};
}

namespace {

/// Sums a block's fluid cells in runs; then finds the cells with extremes within their runs.
template <class T>
class BlockSums {
 public:
  BlockSums(const lbm::Fluid<T>& fluid, int b, FlowSums& sums)
      : fluid_(fluid),
        block_(b),
        lower_(fluid.blocks()[b].box().lower),
        sums_(sums),
        found_(memory_of(fluid.device())) {}

  void add(const BlockMap& map) {
    for_fluid_runs(map, CellTotals::most_cells, memory_of(fluid_.device()),
                   [&](std::span<const Run> runs) { add(runs); });
    for (const Extreme& extreme : extremes_) see(extreme);
  }

 private:
  using CellTotals = lbm::CellTotals;
  using Run = lbm::LocalRows;
  /// The largest, or with the sign -1 the least, of a value so far, and the first run that has it.
  struct Extreme {
    double CellTotals::*of;
    int sign;
    double value = CellTotals().*of;
    Run run{{}, 0, 0};
  };

  void add(std::span<const Run> runs) {
    found_.resize(runs.size());
    fluid_.totals(block_, runs, found_.data());
    for (std::size_t k = 0; k < runs.size(); ++k) add(runs[k], found_[k]);
  }
  void add(const Run& run, const CellTotals& t) {
    if (!t.sound) return for_cells_of(run, [&](Int3 x) { add_cell(x); });
    sums_.add(run.cells * run.rows, t);
    for (Extreme& e : extremes_)
      if (e.sign * (t.*e.of) > e.sign * e.value) e.value = t.*e.of, e.run = run;
  }
  template <class Visit>
  void for_cells_of(const Run& run, Visit&& visit) const {
    for_cells(run.first, run.first + Int3{run.cells, run.rows, 1}, visit);
  }
  void add_cell(Int3 x) {
    const CellTotals t = fluid_.totals(block_, {x, 1});
    const lbm::Moments m = fluid_.moments(block_, x);
    if (!t.sound) return sums_.add(lower_ + x, m, fluid_.velocity(m));
    sums_.add(1, t);
    sums_.see(lower_ + x, t);
  }
  /// Adds the first cell of a run that has the run's extreme.
  void see(const Extreme& e) {
    for (Int3 x = e.run.first; x.y < e.run.first.y + e.run.rows; ++x.y) {
      if (fluid_.totals(block_, {x, e.run.cells}).*e.of != e.value) continue;
      CellTotals t = fluid_.totals(block_, {x, 1});
      while (t.*e.of != e.value) ++x.x, t = fluid_.totals(block_, {x, 1});
      return sums_.see(lower_ + x, t);
    }
  }

  const lbm::Fluid<T>& fluid_;
  const int block_;
  const Int3 lower_;
  FlowSums& sums_;
  std::pmr::vector<CellTotals> found_;  // of the current runs
  std::array<Extreme, 4> extremes_{{{&CellTotals::speed_squared, 1},
                                    {&CellTotals::least_deviation, -1},
                                    {&CellTotals::least_temperature, -1},
                                    {&CellTotals::most_temperature, 1}}};
};

}  // namespace

template <class T>
FlowSums flow_sums(const lbm::Fluid<T>& fluid, std::span<const BlockMap> maps) {
  FlowSums sums(fluid.domain().cells(), fluid.domain().level());
  for (int b = 0; b < int(maps.size()); ++b) BlockSums<T>(fluid, b, sums).add(maps[b]);
  return sums;
}

template FlowSums flow_sums(const lbm::Fluid<float>&, std::span<const BlockMap>);
template FlowSums flow_sums(const lbm::Fluid<double>&, std::span<const BlockMap>);

}  // namespace silt::coupler
