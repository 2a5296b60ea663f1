#include "coupler/side_force.hpp"

#include <cmath>

#include "coupler/mapping/for_cells.hpp"
#include "coupler/mapping/solid_map.hpp"
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

}  // namespace

template <class T>
std::array<rigid::FixedSum, 3> side_force(const lbm::Fluid<T>& fluid, std::span<const BlockMap> maps,
                                          int axis, bool upper) {
  const lbm::Domain& domain = fluid.domain();
  const int last = domain.cells()[axis] - 1, outward = upper ? 1 : -1;
  std::array<rigid::FixedSum, 3> sums{};
  const auto add_links = [&](int b, Int3 x) {
    for (int i = 1; i < lbm::directions; ++i) {
      const Int3 c = lbm::c[i];
      if (c[axis] != outward || reversing_axis(domain, maps[b].box.lower + x + c) != axis) continue;
      const double out = fluid.leaving(b, x, i), back = fluid.arriving(b, x, lbm::opposite(i));
      const std::int64_t exchanged = std::llrint((out + back) / lbm::link_quantum);
      for (int d = 0; d < 3; ++d) sums[d] += c[d] * exchanged;
    }
  };
  for (int b = 0; b < int(maps.size()); ++b) {
    const lbm::CellBox& box = maps[b].box;
    const int at = (upper ? last : 0) - box.lower[axis];
    if (at < 0 || at >= box.size[axis]) continue;
    Int3 low{}, high = box.size;
    low[axis] = at, high[axis] = at + 1;
    for_cells(low, high, [&](Int3 x) {
      if (!maps[b].solid.test(x)) add_links(b, x);
    });
  }
  return sums;
}

template std::array<rigid::FixedSum, 3> side_force(const lbm::Fluid<float>&, std::span<const BlockMap>, int,
                                                   bool);
template std::array<rigid::FixedSum, 3> side_force(const lbm::Fluid<double>&, std::span<const BlockMap>, int,
                                                   bool);

}  // namespace silt::coupler
