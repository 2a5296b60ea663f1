#include "silt/results/velocity_gradient.hpp"

#include <algorithm>
#include <stdexcept>

#include "lbm/fluid.hpp"
#include "parallel/messages.hpp"
#include "silt/case/case.hpp"

namespace silt {

using lbm::CellBox;
using lbm::Int3;
using rigid::Vec3;

CellVelocities::CellVelocities(const coupler::FluidFields& fields, MPI_Comm comm, Int3 lower, Int3 upper)
    : fields_(fields), box_{lower, upper - lower} {
  rank_ = parallel::rank_of(comm);
  parallel::Messages messages(comm);
  for (int b = 0; b < fields.blocks(); ++b)
    for (const int near : fields.domain().blocks_meeting(grown(fields.block(b), reach)))
      tell(b, fields.domain().block(near), messages);
  messages.exchange_sparse();
  for (const parallel::Messages::Message& message : messages.received())
    for (parallel::ByteReader reader(message.bytes); !reader.done();) known_.push_back(reader.read<Known>());
  std::sort(known_.begin(), known_.end(), [](const Known& a, const Known& b) { return a.cell < b.cell; });
}

/// Sends the rank of a block, maybe this one, the cells here within reach of its faces, cut by the box.
void CellVelocities::tell(int block, const lbm::BlockPlace& to, parallel::Messages& messages) {
  const lbm::Domain& domain = fields_.domain();
  const CellBox there = overlap(to.box, box_);
  if (there.cells() == 0) return;
  lbm::MomentArrays moments;
  for (int d = 0; d < 3; ++d)
    for (int away = 1; away <= reach; ++away)
      for (const int at : {there.lower[d] - away, there.lower[d] + there.size[d] - 1 + away}) {
        CellBox layer = there;
        layer.lower[d] = at, layer.size[d] = 1;
        layer.lower = domain.wrapped(layer.lower);
        const CellBox here = overlap(layer, fields_.block(block));
        if (here.cells() == 0) continue;
        const Int3 first = here.lower - fields_.block(block).lower;
        fields_.moments(block, {first, here.size}, moments);
        std::int64_t n = 0;
        coupler::for_cells(first, first + here.size, [&](Int3 cell) {
          const auto u = fields_.velocity(moments[n++]);
          const Known known{
              index(fields_.block(block).lower + cell), fields_.is_fluid(block, cell), {u[0], u[1], u[2]}};
          if (to.rank == rank_)
            known_.push_back(known);
          else
            parallel::put(messages.to(to.rank), known);
        });
      }
}

std::int64_t CellVelocities::index(Int3 cell) const {
  const Int3 n = fields_.domain().cells();
  return (std::int64_t(cell.z) * n.y + cell.y) * n.x + cell.x;
}

std::optional<Vec3> CellVelocities::at(int block, Int3 local_cell) const {
  const lbm::Domain& domain = fields_.domain();
  const Int3 cell = domain.wrapped(fields_.block(block).lower + local_cell);
  if (!domain.inside(cell)) return std::nullopt;
  const auto known = std::lower_bound(known_.begin(), known_.end(), index(cell),
                                      [](const Known& k, std::int64_t i) { return k.cell < i; });
  if (known == known_.end() || known->cell != index(cell)) {
    if (!domain.has(cell)) return std::nullopt;
    throw std::logic_error("the velocity of a cell was not asked for");
  }
  if (!known->is_fluid) return std::nullopt;
  return Vec3(known->velocity[0], known->velocity[1], known->velocity[2]);
}

VelocitiesAround::VelocitiesAround(const coupler::FluidFields& fields, const CellVelocities& others,
                                   int block, Int3 first, Int3 last)
    : fields_(fields), others_(others), block_(block) {
  const Int3 size = fields.block(block).size;
  for (int d = 0; d < 3; ++d) {
    low_[d] = std::max(first[d] - CellVelocities::reach, 0);
    high_[d] = std::min(last[d] + CellVelocities::reach, size[d]);
  }
  height_.fill(-1);
}

void VelocitiesAround::make(int z) {
  Plane& plane = plane_[z % kept];
  height_[z % kept] = z;
  plane.clear();
  lbm::MomentsByRow moments(fields_, block_, low_.x, high_.x);
  coupler::for_cells({low_.x, low_.y, z}, {high_.x, high_.y, z + 1}, [&](Int3 cell) {
    if (!fields_.is_fluid(block_, cell)) return plane.push_back(std::nullopt);
    const auto u = fields_.velocity(moments(cell));
    plane.emplace_back(Vec3(u[0], u[1], u[2]));
  });
}

std::optional<Vec3> VelocitiesAround::at(Int3 cell) {
  for (int d = 0; d < 3; ++d)
    if (cell[d] < low_[d] || cell[d] >= high_[d]) return others_.at(block_, cell);
  if (height_[cell.z % kept] != cell.z) make(cell.z);
  return plane_[cell.z % kept][std::size_t(cell.y - low_.y) * (high_.x - low_.x) + (cell.x - low_.x)];
}

namespace {

/// Returns the derivative of the velocity along an axis.
Vec3 derivative(VelocitiesAround& velocities, Int3 cell, int axis) {
  const auto beside = [&](int steps) {
    Int3 other = cell;
    other[axis] += steps;
    return velocities.at(other);
  };
  const auto before = beside(-1), after = beside(1);
  if (before && after) return 0.5 * (*after - *before);
  if (!before && !after) return Vec3::Zero();
  const int side = after ? 1 : -1;
  const Vec3 u = *beside(0), next = side * ((after ? *after : *before) - u);
  if (const auto second = beside(2 * side)) return 2 * next - 0.5 * side * (*second - u);
  return next;
}

}  // namespace

Vec3 vorticity(VelocitiesAround& velocities, Int3 cell) {
  const Vec3 x = derivative(velocities, cell, 0), y = derivative(velocities, cell, 1),
             z = derivative(velocities, cell, 2);
  return {y[2] - z[1], z[0] - x[2], x[1] - y[0]};
}

std::array<double, 6> strain_rate(const coupler::FluidFields& fields, const lbm::Moments& m) {
  constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  const auto& [tau, magic, model, force, smagorinsky] = fields.spec();
  const auto u = fields.velocity(m);
  std::array<double, 6> rate;
  for (int k = 0; k < 6; ++k) {
    const auto [a, b] = pairs[k];
    double flux = m.flux[k];  // later the part off equilibrium
    flux += 0.5 * (u[a] * force[b] + force[a] * u[b]) - u[a] * u[b];
    if (a == b) flux -= m.density_deviation / 3;
    rate[k] = -1.5 / (tau * fields.width()) * flux;
  }
  return rate;
}

double strain_rate_squared(const coupler::FluidFields& fields, const lbm::Moments& m) {
  const auto s = strain_rate(fields, m);
  return s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + 2 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
}

}  // namespace silt
