#include "coupler/fluid_fields.hpp"

#include <xxhash.h>

#include <cmath>
#include <limits>
#include <tuple>

#include "lbm/cut_links.hpp"
#include "lbm/fluid.hpp"

namespace silt::coupler {

using lbm::Int3;

namespace {

/// The axis of the side that reverses a population which leaves the domain into cell g: that of the first
/// wall in the order of the axes, as in the halo. -1: there is none.
int reversing_axis(const lbm::Domain& domain, Int3 g) {
  for (int d = 0; d < 3; ++d) {
    if (domain.periodic(d) || (g[d] >= 0 && g[d] < domain.cells()[d])) continue;
    if (domain.side(d, g[d] >= 0).kind == lbm::SideKind::bounce) return d;
  }
  return -1;
}

template <class T>
class FieldsOf final : public FluidFields {
 public:
  FieldsOf(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps)
      : FluidFields(fluid.domain(), fluid.spec(), maps), fluid_(fluid) {}

  void moments(int b, const lbm::CellBox& box, lbm::MomentArrays& moments) const override {
    fluid_.moments(b, box, moments);
  }
  void read(int b, const lbm::CellBox& box, int i, double* g) const override { fluid_.read(b, box, i, g); }
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
  FluidMass mass() const override {
    FluidMass all;
    for_each_fluid_cell(*this, [&](Int3, const lbm::Moments& m) {
      all.cells += std::uint64_t(volume());
      all.mass += volume() * rigid::FixedSum(std::llrint(m.density_deviation / lbm::mass_quantum));
    });
    return all;
  }
  std::uint64_t hash() const override {
    std::uint64_t sum = 0;
    const Int3 n = domain().cells();
    for_fluid_cells(maps(), [&](int b, Int3 x) {
      const Int3 g = block(b).lower + x;
      struct {
        std::int64_t cell;
        T g[20];  // one is spare, so that neither precision has padding bytes
      } record{(std::int64_t(g.z) * n.y + g.y) * n.x + g.x, {}};
      record.g[lbm::directions] = T(level());
      for (int i = 0; i < lbm::directions; ++i) record.g[i] = fluid_.arriving(b, x, i);
      sum += XXH3_64bits(&record, sizeof record);
    });
    return sum;
  }
  std::array<rigid::FixedSum, 3> side_force(int axis, bool upper) const override {
    std::array<rigid::FixedSum, 3> sums{};
    for (int b = 0; b < blocks(); ++b) {
      const lbm::CellBox& box = block(b);
      const int at = (upper ? domain().cells()[axis] - 1 : 0) - box.lower[axis];
      if (at < 0 || at >= box.size[axis]) continue;
      Int3 low{}, high = box.size;
      low[axis] = at, high[axis] = at + 1;
      for_cells(low, high, [&](Int3 x) {
        if (is_fluid(b, x)) add_links_across(axis, upper ? 1 : -1, b, x, sums);
      });
    }
    return sums;
  }
  std::size_t bytes() const override { return fluid_.bytes(); }

 private:
  void add_links_across(int axis, int outward, int b, Int3 x, std::array<rigid::FixedSum, 3>& sums) const {
    for (int i = 1; i < lbm::directions; ++i) {
      const Int3 c = lbm::c[i];
      if (c[axis] != outward || reversing_axis(domain(), block(b).lower + x + c) != axis) continue;
      const double out = fluid_.leaving(b, x, i), back = fluid_.arriving(b, x, lbm::opposite(i));
      const std::int64_t exchanged = std::llrint((out + back) / lbm::link_quantum) * width() * width();
      for (int d = 0; d < 3; ++d) sums[d] += c[d] * exchanged;
    }
  }
  void set(int b, const lbm::CellBox& box, int i, const double* g) override { fluid_.write(b, box, i, g); }
  FlowSums count() const override { return flow_sums<T>(fluid_, maps()); }

  lbm::Fluid<T>& fluid_;
};

}  // namespace

template <class T>
std::unique_ptr<FluidFields> make_fields(lbm::Fluid<T>& fluid, const std::vector<BlockMap>& maps) {
  return std::make_unique<FieldsOf<T>>(fluid, maps);
}

template std::unique_ptr<FluidFields> make_fields(lbm::Fluid<float>&, const std::vector<BlockMap>&);
template std::unique_ptr<FluidFields> make_fields(lbm::Fluid<double>&, const std::vector<BlockMap>&);

}  // namespace silt::coupler
