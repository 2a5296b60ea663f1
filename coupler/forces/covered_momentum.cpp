#include "coupler/forces/covered_momentum.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "coupler/exchange/coupling_state.hpp"
#include "lbm/walls/cut_links.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
using rigid::Vec3;

namespace {

using Impulse = std::array<std::int64_t, 6>;  // momentum and angular momentum, in lbm::link_quantum

Impulse to_quanta(const Vec3& momentum, const Vec3& angular) {
  Impulse quanta;
  for (int d = 0; d < 3; ++d) {
    quanta[d] = std::llrint(momentum[d] / lbm::link_quantum);
    quanta[3 + d] = std::llrint(angular[d] / lbm::link_quantum);
  }
  return quanta;
}

/// Returns momentum, and angular momentum about the centre of mass, of the body's cells in excess of its
/// volume, if they move with it. `cells`: as in add_cells.
Impulse momentum_of_excess(const rigid::BodySet& bodies, std::size_t row, const std::int64_t* cells) {
  const double count = double(cells[0]), displaced = bodies.displaced_mass(row);
  const Vec3 moment = Vec3(double(cells[1]), double(cells[2]), double(cells[3])) +
                      count * (Vec3::Constant(0.5) - mapping_pose(bodies, row).position);
  const Vec3 &v = bodies.velocity[row], &w = bodies.angular_velocity[row];
  return to_quanta((count - displaced) * v + w.cross(moment), moment.cross(v));
}

/// Returns the sum of the positions of the set bits.
int sum_of_positions(std::uint64_t word) {
  constexpr std::uint64_t with_bit[] = {0xAAAAAAAAAAAAAAAA, 0xCCCCCCCCCCCCCCCC, 0xF0F0F0F0F0F0F0F0,
                                        0xFF00FF00FF00FF00, 0xFFFF0000FFFF0000, 0xFFFFFFFF00000000};
  int sum = 0;
  for (int b = 0; b < 6; ++b) sum += std::popcount(word & with_bit[b]) << b;
  return sum;
}

}  // namespace

Vec3 impulse_debt(const rigid::BodySet& bodies, std::size_t row) {
  Vec3 impulse;
  const Impulse& debt = coupling_of(bodies, row).impulse_debt;
  for (int d = 0; d < 3; ++d) impulse[d] = double(debt[d]) * lbm::link_quantum;
  return impulse;
}

/// Each cell is counted by its own block only. Coordinates are canonical, like the body's position.
void add_cells(std::span<const BlockMap> maps, RowSums& sums) {
  for (const BlockMap& map : maps)
    for (const BodyMask& mask : map.masks) {
      const BitFrame& f = mask.frame();
      const lbm::Int3 corner = map.box.lower - mask.shift, size = map.box.size;
      std::int64_t* const to = sums.cells(mask.row);
      for (int z = std::max(f.low.z, 0); z < std::min(f.low.z + f.size.z, size.z); ++z)
        for (int y = std::max(f.low.y, 0); y < std::min(f.low.y + f.size.y, size.y); ++y)
          for (int x = 0; x < f.size.x; x += 64) {
            const std::uint64_t word = mask.bits.row(x, y, z) & cells_between(f.low.x + x, 0, size.x);
            const std::int64_t n = std::popcount(word);
            to[0] += n;
            to[1] += sum_of_positions(word) + n * (corner.x + f.low.x + x);
            to[2] += n * (corner.y + y);
            to[3] += n * (corner.z + z);
          }
    }
}

void settle_debt(rigid::BodySet& bodies, std::size_t row, RowSums& sums) {
  std::int64_t* const force = sums.force(row);
  const Impulse now = momentum_of_excess(bodies, row, sums.cells(row));
  Impulse& debt = coupling_of(bodies, row).impulse_debt;
  for (int d = 0; d < 6; ++d) force[d] += debt[d] - now[d];
  debt = now;
}

void begin_debt(rigid::BodySet& bodies, std::size_t row, const RowSums& sums) {
  coupling_of(bodies, row).impulse_debt = momentum_of_excess(bodies, row, sums.cells(row));
}

void CoveredMomentum::add(rigid::BodyId id, const Vec3& momentum, const Vec3& arm) {
  gains_.push_back({id, to_quanta(momentum, arm.cross(momentum))});
}

void CoveredMomentum::add_to(RowSums& sums, const rigid::BodySet& bodies) {
  for (const Gain& gain : gains_)
    if (const std::size_t row = bodies.row_of(gain.id); row < bodies.size())
      for (int d = 0; d < 6; ++d) sums.force(row)[d] += gain.impulse[d];
  gains_.clear();
}

std::vector<TurningWalls::Impulse> TurningWalls::impulses(const rigid::BodySet& bodies) {
  std::vector<Impulse> all;
  for (std::size_t row = bodies.first_wall(); row < bodies.size(); ++row) {
    const Vec3 &v = bodies.velocity[row], &w = bodies.angular_velocity[row];
    const auto* const mesh = std::get_if<rigid::Mesh>(&world_.shapes[bodies.shape[row]]);
    if (!mesh || w.isZero(0)) continue;
    const rigid::MassProperties& solid = solid_of(bodies.shape[row]);
    const double sign = mesh->hollow ? -1 : 1;  // the solid of a hollow mesh is outside its volume
    const rigid::Mat3 turn = bodies.orientation[row].toRotationMatrix();
    const Vec3 centre = turn * solid.centre, axis = w.normalized();
    const Vec3 momentum = sign * solid.volume * w.cross(v + w.cross(centre));
    const Vec3 couple = sign * w.cross(turn * (solid.inertia * (turn.transpose() * w)));
    const Vec3 pair =
        couple.cross(axis);  // acting half a cell to either side along the axis it is the couple
    all.push_back({bodies.id[row], 0.5 * momentum + pair, centre + 0.5 * axis});
    all.push_back({bodies.id[row], 0.5 * momentum - pair, centre - 0.5 * axis});
  }
  return all;
}

const rigid::MassProperties& TurningWalls::solid_of(std::int32_t shape) {
  const auto known = solids_.find(shape);
  if (known != solids_.end()) return known->second;
  const rigid::Mesh& mesh = std::get<rigid::Mesh>(world_.shapes[shape]);
  return solids_.emplace(shape, mesh.surface->mass_properties()).first->second;
}

}  // namespace silt::coupler
