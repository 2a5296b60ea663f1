#include "coupler/fluid_fields.hpp"

#include <xxhash.h>

#include <cmath>
#include <limits>
#include <tuple>

#include "lbm/fluid.hpp"
#include "lbm/heat/heat_links.hpp"
#include "lbm/walls/cut_links.hpp"

namespace silt::coupler {

using lbm::Int3;

namespace {

template <class T>
class FieldsOf final : public FluidFields {
 public:
  FieldsOf(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps, lbm::Temperature<T>* temperature)
      : FluidFields(fluid.domain(), fluid.spec(), maps), fluid_(fluid), temperature_(temperature) {}

  void moments(int b, const lbm::CellBox& box, lbm::MomentArrays& moments) const override {
    fluid_.moments(b, box, moments);
  }
  bool has_temperature() const override { return temperature_ != nullptr; }
  double temperature(int b, Int3 x) const override {
    return temperature_->spec().reference + temperature_->at(b, x);
  }
  void read(int b, const lbm::CellBox& box, int i, double* g) const override {
    if (i < lbm::D3Q19::directions) return fluid_.read(b, box, i, g);
    for_cells(box.lower, box.lower + box.size,
              [&](Int3 x) { *g++ = temperature_->arriving(b, x, i - lbm::D3Q19::directions); });
  }
  std::pair<double, double> link(int b, Int3 x, int i) const override {
    return {fluid_.leaving(b, x, i), came_back(b, x, i)};
  }
  std::optional<Fast> too_fast() const override {
    const auto order = [](const Fast& f) { return std::tuple(-f.speed, f.cell.z, f.cell.y, f.cell.x); };
    std::optional<Fast> first;
    for (const auto& found : fluid_.fast_cells()) {
      if (!is_fluid(found.block, found.cell)) continue;
      const double speed = std::isnan(found.speed) ? std::numeric_limits<double>::infinity() : found.speed;
      const Fast here{finest(block(found.block).lower + found.cell), speed};
      if (!first || order(here) < order(*first)) first = here;
    }
    return first;
  }
  std::uint64_t hash() const override {
    std::uint64_t sum = 0;
    const Int3 n = domain().cells();
    for_fluid_cells(maps(), [&](int b, Int3 x) {
      const Int3 g = block(b).lower + x;
      struct {
        std::int64_t cell;
        T g[20];  // one unused, so that neither precision has padding bytes
      } record{(std::int64_t(g.z) * n.y + g.y) * n.x + g.x, {}};
      record.g[lbm::D3Q19::directions] = T(level());
      for (int i = 0; i < lbm::D3Q19::directions; ++i) record.g[i] = fluid_.arriving(b, x, i);
      sum += XXH3_64bits(&record, sizeof record);
      if (!temperature_) return;
      record.g[lbm::D3Q7::directions] = T(lbm::D3Q7::directions);
      for (int i = 0; i < lbm::D3Q7::directions; ++i) record.g[i] = temperature_->arriving(b, x, i);
      sum += XXH3_64bits(&record, sizeof record);
    });
    return sum;
  }
  rigid::FixedSum heat() const override {
    rigid::FixedSum sum = 0;
    for (int b = 0; b < blocks(); ++b) {
      const lbm::Block<T, lbm::D3Q7>& of = temperature_->blocks()[b];
      const T* g[lbm::D3Q7::directions];
      for (int i = 0; i < lbm::D3Q7::directions; ++i) g[i] = of.data() + of.arriving(i, fluid_.parity());
      for_fluid_runs_of(b, {}, block(b).size, [&](std::ptrdiff_t first, int cells) {
        for (std::ptrdiff_t k = first; k < first + cells; ++k) {
          double temperature = 0;
          for (const T* const population : g) temperature += population[k];
          sum += lbm::heat_quanta(temperature);
        }
      });
    }
    return sum * volume();
  }
  rigid::FixedSum side_heat(int axis, bool upper) const override {
    rigid::FixedSum sum = 0;
    const int i = 2 * axis + (upper ? 1 : 2);
    const double conducted = -temperature_->spec().diffusivity * temperature_->spec().gradient_along(i);
    for_layer(axis, upper ? domain().cells()[axis] - 1 : 0, [&](int b, Int3 low, Int3 high) {
      for_cells(low, high, [&](Int3 x) {
        if (!is_fluid(b, x)) return;
        const double lost =
            double(temperature_->leaving(b, x, i)) - temperature_->arriving(b, x, lbm::opposite(i));
        sum += lbm::heat_quanta(lost + conducted);
      });
    });
    return sum * width() * width();
  }
  std::array<rigid::FixedSum, 3> side_force(int axis, bool upper) const override {
    std::array<rigid::FixedSum, 3> sums{};
    if (domain().side(axis, upper).kind != lbm::SideKind::bounce) return sums;
    std::vector<int> across;
    for (int i = 1; i < lbm::D3Q19::directions; ++i)
      if (lbm::D3Q19::c[i][axis] == (upper ? 1 : -1)) across.push_back(i);
    for_layer(axis, upper ? domain().cells()[axis] - 1 : 0, [&](int b, Int3 low, Int3 high) {
      add_exchanged(across, b, low, high, width() * width(), sums);
      for (const int i : across) leave_to_other_side(axis, i, b, low, high, sums);
    });
    return sums;
  }
  rigid::FixedSum flow_through(int axis, int b, const lbm::CellBox& cells, double share) const override {
    const Int3 low = cells.lower, high = low + cells.size;
    const lbm::Block<T>& block = fluid_.blocks()[b];
    const T *along[5], *against[5];
    for (int i = 1, k = 0; i < lbm::D3Q19::directions; ++i) {
      if (lbm::D3Q19::c[i][axis] != 1) continue;
      along[k] = block.data() + block.arriving(i, fluid_.parity());
      against[k++] = block.data() + block.arriving(lbm::opposite(i), fluid_.parity());
    }
    const double half_force = 0.5 * spec().force[axis];
    rigid::FixedSum sum = 0;
    for_fluid_runs_of(b, low, high, [&](std::ptrdiff_t first, int cells) {
      std::int64_t of_run = 0;
      for (std::ptrdiff_t cell = first; cell < first + cells; ++cell) {
        double u = half_force;
        for (int k = 0; k < 5; ++k) u += double(along[k][cell]) - double(against[k][cell]);
        of_run += std::llrint(share * u / flow_quantum);
      }
      sum += of_run;
    });
    sum -= flow_into_surfaces(axis, b, low, high, share);
    return sum * width() * width();
  }
  std::size_t bytes() const override { return fluid_.bytes(); }

 private:
  /// Calls visit(block, low, high) for this rank's cells of a layer across an axis.
  template <class Visit>
  void for_layer(int axis, int layer, Visit&& visit) const {
    for (int b = 0; b < blocks(); ++b) {
      const lbm::CellBox& box = block(b);
      Int3 low{}, high = box.size;
      low[axis] = layer - box.lower[axis], high[axis] = low[axis] + 1;
      if (low[axis] >= 0 && low[axis] < box.size[axis]) visit(b, low, high);
    }
  }
  /// Returns the population that returned to a cell against c_i, before the cell gave up its excess.
  double came_back(int b, Int3 x, int i) const {
    return fluid_.arriving(b, x, lbm::opposite(i)) + fluid_.given_up(b, fluid_.blocks()[b].cell(x), i);
  }
  /// Calls visit(offset in the block, cells) for runs of at most 64 fluid cells between low and high.
  template <class Visit>
  void for_fluid_runs_of(int b, Int3 low, Int3 high, Visit&& visit) const {
    for (int z = low.z; z < high.z; ++z)
      for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; x += 64) {
          const int cells = std::min(64, high.x - x);
          const std::ptrdiff_t first = fluid_.blocks()[b].cell(x, y, z);
          const std::uint64_t is_solid = first_cells(solid(b).from(x, y, z), cells);
          if (is_solid == 0)
            visit(first, cells);
          else
            for (int k = 0; k < cells; ++k)
              if (!(is_solid >> k & 1)) visit(first + k, 1);
        }
  }
  /// Returns `share` times half the flux along an axis through cut links of bodies and [[walls]] of cells
  /// between low and high: cell velocities contain it, but it passes neither face of the layer.
  rigid::FixedSum flow_into_surfaces(int axis, int b, Int3 low, Int3 high, double share) const {
    rigid::FixedSum sum = 0;
    for_cells(low, high, [&](Int3 x) {
      if (solid(b).test(x)) return;
      for (int i = 1; i < lbm::D3Q19::directions; ++i) {
        const Int3 y = x + lbm::D3Q19::c[i];
        if (lbm::D3Q19::c[i][axis] == 0 || !solid(b).test(y) || maps()[b].walls.test(y)) continue;
        const double out = fluid_.leaving(b, x, i), back = came_back(b, x, i);
        sum += lbm::D3Q19::c[i][axis] * std::llrint(share * 0.5 * (out - back) / flow_quantum);
      }
    });
    return sum;
  }
  /// Adds `times` times c (f out + f back) over the directions `across` and the cells between low and high.
  void add_exchanged(std::span<const int> across, int b, Int3 low, Int3 high, int times,
                     std::array<rigid::FixedSum, 3>& sums) const {
    const lbm::Block<T>& block = fluid_.blocks()[b];
    std::array<const T*, 5> out{}, back{};
    std::array<rigid::FixedSum, 5> exchanged{};
    for (std::size_t k = 0; k < across.size(); ++k) {
      out[k] = block.data() + block.leaving(across[k], fluid_.parity());
      back[k] = block.data() + block.arriving(lbm::opposite(across[k]), fluid_.parity());
    }
    for_fluid_runs_of(b, low, high, [&](std::ptrdiff_t first, int cells) {
      for (std::size_t k = 0; k < across.size(); ++k) {
        std::int64_t of_run = 0;
        for (std::ptrdiff_t cell = first; cell < first + cells; ++cell)
          of_run += std::llrint(
              (double(out[k][cell]) + (double(back[k][cell]) + fluid_.given_up(b, cell, across[k]))) /
              lbm::link_quantum);
        exchanged[k] += of_run;
      }
    });
    for (std::size_t k = 0; k < across.size(); ++k)
      for (int d = 0; d < 3; ++d) sums[d] += times * lbm::D3Q19::c[across[k]][d] * exchanged[k];
  }
  /// Of links along i that cross another wall, too, leaves that wall the component along its normal: so the
  /// pressure at an edge acts on both walls, across each.
  void leave_to_other_side(int axis, int i, int b, Int3 low, Int3 high,
                           std::array<rigid::FixedSum, 3>& sums) const {
    const lbm::CellBox& box = block(b);
    for (int d = 0; d < 3; ++d) {
      const int along = lbm::D3Q19::c[i][d];
      if (d == axis || along == 0 || domain().side(d, along > 0).kind != lbm::SideKind::bounce) continue;
      if (along < 0)
        high[d] = box.lower[d] == 0 ? 1 : 0;
      else
        low[d] = box.lower[d] + box.size[d] == domain().cells()[d] ? high[d] - 1 : high[d];
      std::array<rigid::FixedSum, 3> shared{};
      add_exchanged(std::span(&i, 1), b, low, high, width() * width(), shared);
      sums[d] -= shared[d];
    }
  }
  void set(int b, const lbm::CellBox& box, int i, const double* g) override {
    if (i < lbm::D3Q19::directions) return fluid_.write(b, box, i, g);
    for_cells(box.lower, box.lower + box.size,
              [&](Int3 x) { temperature_->arriving(b, x, i - lbm::D3Q19::directions) = T(*g++); });
  }
  FlowSums count() const override { return flow_sums<T>(fluid_, maps()); }

  lbm::Fluid<T>& fluid_;
  lbm::Temperature<T>* temperature_;  // null: none
};

}  // namespace

lbm::CellBox FluidFields::cells_meeting(const rigid::BoundingBox& box) const {
  lbm::CellBox cells;
  for (int d = 0; d < 3; ++d) {
    cells.lower[d] = int(std::floor(box.lower[d] / width()));
    cells.size[d] = int(std::ceil(box.upper[d] / width())) - cells.lower[d];
  }
  return cells;
}

template <class T>
std::unique_ptr<FluidFields> make_fields(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps,
                                         lbm::Temperature<T>* temperature) {
  return std::make_unique<FieldsOf<T>>(fluid, maps, temperature);
}

template std::unique_ptr<FluidFields> make_fields(lbm::Fluid<float>&, const std::vector<BlockMap>&,
                                                  lbm::Temperature<float>*);
template std::unique_ptr<FluidFields> make_fields(lbm::Fluid<double>&, const std::vector<BlockMap>&,
                                                  lbm::Temperature<double>*);

}  // namespace silt::coupler
