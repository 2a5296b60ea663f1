#include "coupler/exchange/holders.hpp"

#include <algorithm>
#include <cmath>

namespace silt::coupler {

namespace {

/// Into [0, length); rounding may not leave it.
double wrapped(double x, double length) {
  if (x >= 0 && x < length) return x;
  const double y = x - std::floor(x / length) * length;
  return y >= 0 && y < length ? y : 0.0;
}

}  // namespace

Holders::Holders(const lbm::Domain& domain, double rim) : domain_(domain), rim_(rim) {
  for (int d = 0; d < 3; ++d) {
    axes_[d].periodic = domain.periodic(d);
    for (const lbm::BlockPlace& block : domain.blocks()) {  // those along this edge of the domain, in order
      const lbm::Int3& lower = block.box.lower;
      if (lower[(d + 1) % 3] == 0 && lower[(d + 2) % 3] == 0) axes_[d].cuts.push_back(lower[d]);
    }
    axes_[d].cuts.push_back(domain.cells()[d]);
  }
}

/// The first and the last block reach to infinity; so does the first for what is not a number.
int Holders::Axis::block_at(double x) const {
  if (!(x >= 0)) return 0;
  if (x >= cuts.back()) return blocks() - 1;
  return static_cast<int>(std::upper_bound(cuts.begin(), cuts.end(), static_cast<int>(x)) - cuts.begin()) - 1;
}

int Holders::block_at(const rigid::Vec3& x) const {
  int index = 0;
  for (int d = 2; d >= 0; --d) {
    const Axis& axis = axes_[d];
    index = index * axis.blocks() + axis.block_at(axis.periodic ? wrapped(x[d], axis.cuts.back()) : x[d]);
  }
  return index;
}

Holders::Run Holders::met_by(const Axis& axis, double lower, double upper) const {
  const double from = lower - rim_, to = upper + rim_, length = axis.cuts.back();
  if (!axis.periodic) {
    const int first = axis.block_at(from);
    return {first, axis.block_at(to) - first + 1};
  }
  if (!(to - from < length)) return {0, axis.blocks()};
  const double start = wrapped(from, length), end = start + (to - from);
  const int first = axis.block_at(start);
  const int last = end < length ? axis.block_at(end) : axis.block_at(end - length) + axis.blocks();
  return {first, std::min(last - first + 1, axis.blocks())};
}

void Holders::ranks_of(const rigid::BoundingBox& box, std::vector<int>& ranks) const {
  ranks.clear();
  std::array<Run, 3> runs;
  for (int d = 0; d < 3; ++d) runs[d] = met_by(axes_[d], box.lower[d], box.upper[d]);
  const int nx = axes_[0].blocks(), ny = axes_[1].blocks(), nz = axes_[2].blocks();
  for (int k = 0; k < runs[2].count; ++k)
    for (int j = 0; j < runs[1].count; ++j)
      for (int i = 0; i < runs[0].count; ++i) {
        const int z = (runs[2].first + k) % nz, y = (runs[1].first + j) % ny, x = (runs[0].first + i) % nx;
        const int rank = domain_.blocks()[(z * ny + y) * nx + x].rank;
        if (ranks.empty() || ranks.back() != rank) ranks.push_back(rank);
      }
  std::sort(ranks.begin(), ranks.end());
  ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
}

}  // namespace silt::coupler
