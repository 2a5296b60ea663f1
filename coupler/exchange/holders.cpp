#include "coupler/exchange/holders.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace silt::coupler {

namespace {

/// Into [0, length); rounding may not leave it.
double wrapped(double x, double length) {
  if (x >= 0 && x < length) return x;
  const double y = x - std::floor(x / length) * length;
  return y >= 0 && y < length ? y : 0.0;
}

/// The first and the last cell reach to infinity; so does the first for what is not a number.
int clamped(double x, int cells) {
  if (!(x >= 0)) return 0;
  return x >= cells ? cells - 1 : static_cast<int>(x);
}

}  // namespace

Holders::Holders(const lbm::Domain& domain, double rim, int here) : domain_(domain), rim_(rim), here_(here) {
  if (here < 0) return;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const lbm::BlockPlace& place : domain.blocks_of(here)) {
    const lbm::CellBox& box = place.box;
    rigid::BoundingBox& bounds = blocks_here_.emplace_back();
    for (int d = 0; d < 3; ++d) {
      const int lower = box.lower[d], upper = lower + box.size[d];
      const bool ends = !domain.periodic(d);
      bounds.lower[d] = ends && lower == 0 ? -infinity : lower;
      bounds.upper[d] = ends && upper == domain.cells()[d] ? infinity : upper;
    }
  }
}

lbm::Int3 Holders::cell_at(const rigid::Vec3& x) const {
  lbm::Int3 cell;
  for (int d = 0; d < 3; ++d) {
    const int n = domain_.cells()[d];
    cell[d] = clamped(domain_.periodic(d) ? wrapped(x[d], n) : x[d], n);
  }
  return cell;
}

lbm::CellRun Holders::met_by(int axis, double lower, double upper) const {
  const double from = lower - rim_, to = upper + rim_;
  const int n = domain_.cells()[axis];
  if (!domain_.periodic(axis)) {
    const int first = clamped(from, n);
    return {first, clamped(to, n) - first + 1};
  }
  if (!(to - from < n)) return {0, n};
  const double start = wrapped(from, n), end = start + (to - from);
  const int first = clamped(start, n);
  const int last = end < n ? clamped(end, n) : clamped(end - n, n) + n;
  return {first, std::min(last - first + 1, n)};
}

void Holders::ranks_of(const rigid::BoundingBox& box, std::vector<int>& ranks) const {
  ranks.clear();
  const rigid::Vec3 rim = rigid::Vec3::Constant(rim_);
  if (is_here(box.lower - rim, box.upper + rim)) return ranks.push_back(here_);
  std::array<lbm::CellRun, 3> runs;
  for (int d = 0; d < 3; ++d) runs[d] = met_by(d, box.lower[d], box.upper[d]);
  domain_.for_blocks_meeting(runs, [&](const lbm::BlockPlace& block) {
    if (ranks.empty() || ranks.back() != block.rank) ranks.push_back(block.rank);
  });
  std::sort(ranks.begin(), ranks.end());
  ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
}

}  // namespace silt::coupler
