#include "coupler/energy_guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "coupler/case/case.hpp"
#include "coupler/guard.hpp"
#include "coupler/scene.hpp"

namespace silt::coupler {

using rigid::BodySet;
using rigid::FixedSum;
using rigid::Vec3;

namespace {

/// 2^62, the range of a sum, for 2^20 bodies.
constexpr double out_of_proportion = 0x1p42;

FixedSum cut_off(double energy) {
  return rigid::to_fixed(std::clamp(energy, -out_of_proportion, out_of_proportion));
}

bool is_driven(const Case& setup) {
  const auto moves = [](const BoundarySpec& side) {
    return side.kind == BoundaryKind::moving && side.velocity != Vec3::Zero();
  };
  return std::any_of(setup.boundary.begin(), setup.boundary.end(), moves) ||
         std::any_of(setup.walls.begin(), setup.walls.end(), std::mem_fn(&CurvedWall::moves)) ||
         setup.any_given([](const BodySpec& b) { return b.motion == rigid::Motion::prescribed; });
}

/// Of all free bodies of this rank.
struct Energies {
  FixedSum mechanical = 0, kinetic = 0, lift = 0;  // lift: of each by its bounding radius
};

Energies energies_of(const Scene& scene) {
  const BodySet& bodies = scene.bodies;
  const double g = scene.setup.gravity.norm();
  Energies sums;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (!bodies.is_dynamic(row)) continue;
    sums.mechanical += mechanical_energy(scene.setup, bodies, row);
    sums.kinetic += cut_off(bodies.kinetic_energy(row));
    sums.lift += cut_off(bodies.mass[row] * std::abs(bodies.weight_in_fluid[row]) * g *
                         scene.world.bounding_radii[bodies.shape[row]]);
  }
  return sums;
}

std::string energy_text(const Case& setup, double x) {
  return setup.units.si ? fmt::format("{} J", shown(setup.units.physical(x, dimension::energy)))
                        : fmt::format("{} (lattice units)", shown(x));
}

}  // namespace

Vec3 unwrapped(const BodySet& bodies, std::size_t row, const Vec3& period) {
  Vec3 x = bodies.position[row];
  for (int d = 0; d < 3; ++d) x[d] += bodies.image[row][d] * period[d];
  return x;
}

FixedSum mechanical_energy(const Case& setup, const BodySet& bodies, std::size_t row) {
  const Vec3 x = unwrapped(bodies, row, extent_of(setup).size);
  return cut_off(bodies.kinetic_energy(row) -
                 bodies.mass[row] * bodies.weight_in_fluid[row] * setup.gravity.dot(x));
}

EnergyGuard::EnergyGuard(const Case& setup) : watched_(!setup.fluid && !is_driven(setup)) {}

void EnergyGuard::look(const Scene& scene, FixedSum brought, std::int64_t step) {
  if (!watched_) return;
  const Energies here = energies_of(scene);
  sums_.start(scene.comm, {here.mechanical - brought, here.kinetic, here.lift});
  step_ = step;
  first_ = fresh_;
  fresh_ = false;
}

void EnergyGuard::finish(const Case& setup) {
  if (!sums_.under_way()) return;
  const Sums& all = sums_.finish();
  const double energy = rigid::from_fixed(all.energy.value()),
               kinetic = rigid::from_fixed(all.kinetic.value()), lift = rigid::from_fixed(all.lift.value());
  if (first_) start_ = energy, start_step_ = step_, largest_kinetic_ = kinetic;
  largest_kinetic_ = std::max(largest_kinetic_, kinetic);
  const double gain = energy - start_, allowed = share_of_motion * largest_kinetic_ + lift;
  if (gain > allowed)
    throw CommonGuardStop(
        fmt::format("step {}: the energy of the bodies has grown by {} since step {}, though nothing drives "
                    "them (kinetic "
                    "energy now: {}; allowed: {}); {}",
                    step_, energy_text(setup, gain), start_step_, energy_text(setup, kinetic),
                    energy_text(setup, allowed), contact_remedy(setup)));
}

}  // namespace silt::coupler
