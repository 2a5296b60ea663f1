#include "silt/run/run_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "parallel/collectives.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"

namespace silt {

namespace {

/// Returns the drag of a sphere in a packing, without the mean pressure gradient, divided by Stokes' drag at
/// the superficial velocity; the Reynolds number is that of this velocity and the diameter.
double drag_of_many(double solid, double reynolds) {
  const double fluid = 1 - solid, cube = fluid * fluid * fluid;
  const double slow = 10 * solid / cube + fluid * (1 + 1.5 * std::sqrt(solid));
  const double rise = (1 / fluid + 3 * solid * fluid + 8.4 * std::pow(reynolds, -0.343)) /
                      (1 + std::pow(10, 3 * solid) * std::pow(reynolds, -(1 + 4 * solid) / 2));
  return slow + 0.413 * reynolds / (24 * cube) * rise;
}

/// The bodies in a stream along an axis, as spheres of the same volume; lattice units.
struct Standing {
  double volume = 0, of_fixed = 0, of_free = 0;  // volumes; sums of diameters of fixed and free bodies
  double weight = 0;                             // of free bodies in the fluid, along the axis
  double largest = 0;                            // largest diameter
  double low = std::numeric_limits<double>::infinity(), high = -low;

  Standing(const Case& setup, const rigid::BodySet& bodies, const rigid::World& world, int axis) {
    for (std::size_t row = 0; row < bodies.owned; ++row) {
      const double of_body = rigid::mass_properties(world.shapes[bodies.shape[row]]).volume;
      const double diameter = std::cbrt(6 / std::numbers::pi * of_body), x = bodies.position[row][axis];
      volume += of_body, largest = std::max(largest, diameter);
      low = std::min(low, x - diameter / 2), high = std::max(high, x + diameter / 2);
      (bodies.is_dynamic(row) ? of_free : of_fixed) += diameter;
      if (bodies.is_dynamic(row))
        weight += std::fabs(bodies.mass[row] * bodies.weight_in_fluid[row] * setup.gravity[axis]);
    }
  }
  double pressure_drop(double speed, double viscosity, double area) const {
    constexpr double densest = 0.64;
    if (volume == 0) return 0;
    const auto drag = [&](double solid) {
      return 3 * std::numbers::pi * viscosity * speed * drag_of_many(solid, speed * largest / viscosity);
    };
    const double solid = std::min(volume / (area * (high - low)), densest);
    return (drag(solid) * of_fixed + std::min(drag(densest) * of_free, weight)) / area;
  }
};

}  // namespace

std::optional<Diagnostic> pressure_warning(const Case& setup, const rigid::BodySet& bodies,
                                           const rigid::World& world) {
  if (!setup.fluid) return {};
  for (int side = 0; side < 6; ++side) {
    const coupler::BoundarySpec& inlet = setup.boundary[side];
    const int axis = side / 2;
    const double speed = inlet.over_time.most() * std::fabs(inlet.velocity[axis]);
    if (!inlet.is_inlet() || speed == 0) continue;
    const double area = setup.volume() / setup.cells[axis];
    const double drop =
        Standing(setup, bodies, world, axis).pressure_drop(speed, setup.fluid->kinematic_viscosity, area);
    const double found = 3 * drop;  // the square of the speed of sound is 1/3
    if (found <= doubtful_deviation) continue;
    const double factor = std::sqrt(doubtful_deviation / found);
    return Diagnostic{
        Diagnostic::Severity::warning, setup.place(side_key(side)),
        fmt::format("the bodies that stand in the stream from {} let the pressure fall by as much as makes "
                    "the density {:.2g} % higher before them{}; above {} % the fluid is noticeably "
                    "compressible: {}",
                    side_key(side), 100 * found, in_si(setup, drop, dimension::pressure),
                    shown(100 * doubtful_deviation),
                    setup.units.si
                        ? time_step_cure(setup, factor)
                        : fmt::format("give all velocities times {}", shown(rounded_down(factor))))};
  }
  return {};
}

std::optional<Diagnostic> inlet_warning(const Case& setup, const rigid::BodySet& bodies,
                                        const rigid::World& world, MPI_Comm comm) {
  constexpr double noticeable = 0.01;
  for (int side = 0; setup.fluid && side < 6; ++side) {
    if (!setup.boundary[side].is_inlet()) continue;
    const int axis = side / 2;
    double covered = 0;
    for (std::size_t row = 0; row < bodies.owned; ++row) {
      const double radius = sphere_of_volume(world.shapes[bodies.shape[row]]) / 2;
      const double x = bodies.position[row][axis], centre = 0.5;  // of the first layer of cells
      const double way = (side % 2 == 0 ? x : setup.cells[axis] - x) - centre;
      covered += std::numbers::pi * std::max(0., radius * radius - way * way);
    }
    const double share = parallel::sum_over_ranks(comm, covered) * setup.cells[axis] / setup.volume();
    if (share <= noticeable) continue;
    return Diagnostic{
        Diagnostic::Severity::warning, setup.place(side_key(side)),
        fmt::format(
            "bodies cover {:.0f} % of the inlet {}, where nothing flows in: the flow is less than its "
            "velocity times the area of the side; leave half a diameter or more between them and the "
            "side (bodies of a dry run: initial.position)",
            100 * std::min(share, 1.), side_key(side))};
  }
  return {};
}

}  // namespace silt
