#include "coupler/forces/owed_mass.hpp"

#include <cmath>

namespace silt::coupler {

bool crosses_open_side(const lbm::Domain& domain, const rigid::Vec3& centre, double radius) {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true}) {
      const lbm::SideCondition& side = domain.side(axis, upper);
      const bool open = side.kind == lbm::SideKind::pressure ||
                        (side.kind == lbm::SideKind::bounce && side.velocity[axis] != 0);
      const double inside = upper ? domain.cells()[axis] - centre[axis] : centre[axis];
      if (open && inside < radius) return true;
    }
  return false;
}

void owe_mass(rigid::BodySet& bodies, std::size_t row, const RowSums& sums, const Vec6& motion,
              double resistance_quantum, int exponent, double mass_quantum) {
  const std::int64_t *const h = sums.resistance(row), *const push = sums.push(row);
  // 6 w |c|^2 is 1/3 along every link
  const std::int64_t links = std::llround(3 * double(h[0] + h[6] + h[11]) * resistance_quantum);
  double carried = 0;
  for (int d = 0; d < 6; ++d) carried += double(push[d]) * std::ldexp(motion[d], d < 3 ? 0 : exponent);
  std::int64_t &owed = mass_owed(bodies, row)[0], &by_each_link = mass_owed(bodies, row)[1];
  owed += std::llround(carried * resistance_quantum / mass_quantum) - links * by_each_link;
  by_each_link = links > 0 ? owed / links : 0;
}

}  // namespace silt::coupler
