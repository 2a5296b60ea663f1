#include <cmath>
#include <numbers>

#include "coupler/fluid_fields.hpp"
#include "parallel/collectives.hpp"
#include "rigid/math/elementary.hpp"
#include "silt/case/case.hpp"
#include "silt/placement/place_bodies.hpp"
#include "silt/results/quantity_computation.hpp"
#include "silt/results/velocity_gradient.hpp"

namespace silt {

// Interpolates cell values to a plane across an axis: finds the layers of cells beside it and their weights.

/// Values are linear between cell centres along the axis, also between cells of different widths, and
/// extrapolated to sides that are not periodic. Lengths are in finest cells.
class LayersBeside {
 public:
  LayersBeside(const coupler::FluidFields& fields, int axis, double at)
      : fields_(fields), axis_(axis), at_(at), cells_(fields.domain().cells()[axis]) {}

  /// Calls visit(block, its local cells, weight) for this rank's cells with a weight on the plane.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (int b = 0; b < fields_.blocks(); ++b)
      for (int k = 0; k < fields_.block(b).size[axis_]; ++k) {
        lbm::CellBox layer{{}, fields_.block(b).size};
        layer.lower[axis_] = k, layer.size[axis_] = 1;
        const double away = from_layer(fields_.block(b).lower[axis_] + k);
        if (std::abs(away) < 3 * fields_.width()) for_layer(b, layer, away, visit);
      }
  }

 private:
  bool periodic() const { return fields_.domain().periodic(axis_); }
  /// Returns the distance of the plane above the middle of a layer, through the nearest image.
  double from_layer(int layer) const {
    const double away = at_ - fields_.width() * (layer + 0.5), period = double(cells_) * fields_.width();
    return periodic() ? away - period * std::round(away / period) : away;
  }
  /// Returns the width of the neighbour on a side of a cell; 0 if there is none.
  int width_beside(lbm::Int3 cell, int side) const {
    const lbm::Domain& domain = fields_.domain();
    cell[axis_] += side;
    cell = domain.wrapped(cell);
    if (!domain.inside(cell)) return 0;
    const auto kinds = domain.tree().kinds();
    return kinds.empty() ? 1 : 1 << kinds[domain.block_at(cell).index].level;
  }
  template <class Visit>
  void for_layer(int b, const lbm::CellBox& layer, double away, Visit& visit) const {
    const auto visit_part = [&](const lbm::CellBox& part) {
      const double share = share_of(fields_.block(b).lower + part.lower, away);
      if (share != 0) visit(b, part, share);
    };
    const int k = layer.lower[axis_], last = fields_.block(b).size[axis_] - 1;
    if (k > 0 && k < last) return visit_part(layer);  // all cells have neighbours of their width
    coupler::for_cells(layer.lower, layer.lower + layer.size, [&](lbm::Int3 cell) {
      visit_part({cell, {1, 1, 1}});
    });
  }
  double share_of(lbm::Int3 cell, double away) const {
    const int side = away < 0 ? -1 : 1, width = fields_.width();
    const int next = width_beside(cell, side), back = width_beside(cell, -side);
    const double beyond = std::abs(away);
    if (beyond == 0 || (periodic() && cells_ == 1)) return 1;
    if (next == 0) return back == 0 ? 1 : 1 + beyond / (0.5 * (width + back));
    const double way = 0.5 * (width + next);
    if (beyond <= way) return 1 - beyond / way;
    const double far_side = width * (cell[axis_] + 0.5) + side * (0.5 * width + next);
    const bool next_is_last = !periodic() && (far_side <= 0 || far_side >= double(cells_) * width);
    return next_is_last ? 1 - beyond / way : 0;
  }

  const coupler::FluidFields& fields_;
  int axis_;
  double at_;
  int cells_;
};

namespace {

using rigid::FixedSum;
using rigid::from_fixed;
using rigid::to_fixed;

/// Returns the mean velocity along an axis less `frame` over all cells of the domain; 0 in solid cells.
double superficial_velocity(const Simulation& simulation, int axis, double frame) {
  const coupler::Flow& flow = *simulation.scene().flow;
  const coupler::FlowTotals totals = flow.totals();
  return (flow.fields().velocity_sum(totals)[axis] - double(totals.fluid_cells) * frame) /
         simulation.setup().volume();
}

/// Calls visit(fields of its level, cell, moments) for every fluid cell of all levels.
template <class Visit>
void for_each_fluid_cell(const coupler::Flow& flow, Visit&& visit) {
  flow.for_levels([&](const coupler::FluidFields& fields) {
    coupler::for_each_fluid_cell(fields,
                                 [&](lbm::Int3 cell, const lbm::Moments& m) { visit(fields, cell, m); });
  });
}

/// Returns the mean of F / (6 pi mu a U) over fixed bodies: F is the force of the fluid and the body force on
/// the displaced fluid (as in Zick and Homsy 1982), U the superficial velocity, a the radius.
double drag_coefficient(const Simulation& simulation, const QuantitySpec& q) {
  const Case& setup = simulation.setup();
  const rigid::BodySet& bodies = simulation.bodies();
  const auto shapes = centred_shapes(setup);
  const auto loads = simulation.last_loads();
  struct {
    FixedSum force = 0, radius = 0, count = 0;
  } mine;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (!q.is_about(bodies.kind[row]) || bodies.motion[row] != rigid::Motion::fixed) continue;
    const double volume = shapes[bodies.shape[row]].volume;
    mine.force +=
        to_fixed(loads[row].force[q.axis] + simulation.scene().flow->fields().spec().force[q.axis] * volume);
    mine.radius += to_fixed(rigid::elementary::cbrt(volume * 0.75 / std::numbers::pi));
    mine.count += to_fixed(1);
  }
  const auto all = parallel::sum_over_ranks(simulation.scene().comm, mine);
  const double speed = superficial_velocity(simulation, q.axis, 0),
               viscosity = setup.fluid->kinematic_viscosity;
  if (all.count == 0 || simulation.steps_done() == 0 || speed == 0) return no_value;
  const double count = from_fixed(all.count), force = from_fixed(all.force) / count,
               radius = from_fixed(all.radius) / count;
  return force / (6 * std::numbers::pi * viscosity * radius * speed);
}

double kinetic_energy(const Simulation& simulation) {
  const coupler::FlowTotals totals = simulation.scene().flow->totals();
  return totals.fluid_cells > 0 ? totals.energy / double(totals.fluid_cells) : no_value;
}

double dissipation(const Simulation& simulation) {
  struct {
    FixedSum squares = 0, cells = 0;
  } mine;
  for_each_fluid_cell(*simulation.scene().flow,
                      [&](const coupler::FluidFields& fields, lbm::Int3, const lbm::Moments& m) {
                        mine.squares += fields.volume() * to_fixed(strain_rate_squared(fields, m));
                        mine.cells += fields.volume() * to_fixed(1);
                      });
  const auto all = parallel::sum_over_ranks(simulation.scene().comm, mine);
  return all.cells > 0 ? 2 * simulation.setup().fluid->kinematic_viscosity * from_fixed(all.squares) /
                             from_fixed(all.cells)
                       : no_value;
}

double velocity_past_bodies(const Simulation& simulation, const QuantitySpec& q) {
  const auto velocity = [&](std::size_t row) { return simulation.bodies().velocity[row][q.axis]; };
  const double bodies = simulation.body_count() > 0 ? mean_over_bodies(simulation, q, velocity) : 0;
  return superficial_velocity(simulation, q.axis, bodies);
}

/// Adds the flow rate through a plane across the axis.
void add_flow_rate(const Simulation& simulation, const QuantitySpec& q, std::span<rigid::ExactSum> rate) {
  simulation.scene().flow->for_levels([&](const coupler::FluidFields& fields) {
    LayersBeside(fields, q.axis, q.height).for_each([&](int b, const lbm::CellBox& cells, double share) {
      rate[0].add(fields.flow_through(q.axis, b, cells, share), coupler::FluidFields::flow_quantum);
    });
  });
}

/// Returns the sum over cells.
double flow_rate(const Case&, const QuantitySpec&, std::int64_t, std::span<const double> rate) {
  return rate[0];
}

/// Adds the deviation of the density from the reference over the cells of fluid beside two planes, and their
/// area.
void add_densities(const Simulation& simulation, const QuantitySpec& q, std::span<rigid::ExactSum> sums) {
  for (const int plane : {0, 1})
    simulation.scene().flow->for_levels([&](const coupler::FluidFields& fields) {
      FixedSum deviation = 0, area = 0;
      LayersBeside(fields, q.axis, plane == 0 ? q.height : q.second_height)
          .for_each([&](int b, const lbm::CellBox& cells, double share) {
            const lbm::Int3 first = cells.lower, last = first + cells.size;
            lbm::MomentsByRow moments(fields, b, first.x, last.x);
            coupler::for_cells(first, last, [&](lbm::Int3 x) {
              if (!fields.is_fluid(b, x)) return;
              deviation += to_fixed(share * moments(x).density_deviation);
              area += to_fixed(share);
            });
          });
      sums[2 * plane].add(fields.width() * fields.width() * deviation, 0x1p-64);
      sums[2 * plane + 1].add(fields.width() * fields.width() * area, 0x1p-64);
    });
}

double pressure_drop(const Case&, const QuantitySpec&, std::int64_t, std::span<const double> s) {
  constexpr double sound_squared = 1. / 3;
  return s[1] > 0 && s[3] > 0 ? sound_squared * (s[0] / s[1] - s[2] / s[3]) : no_value;
}

void see_body_force(const Simulation& simulation, const QuantitySpec& q, std::span<double> force) {
  force[0] = simulation.scene().flow->fields().spec().force[q.axis];
}

constexpr Quantity of_flow[] = {
    {"drag-coefficient", dimension::none, Q::body | Q::axis, Q::fluid | Q::bodies, at_end<drag_coefficient>(),
     "force on the fixed bodies over Stokes' drag at the superficial velocity"},
    {"superficial-velocity", dimension::velocity, Q::body | Q::axis, Q::fluid, at_end<velocity_past_bodies>(),
     "mean over all cells of the fluid's velocity relative to the bodies', at the end; cells inside bodies "
     "count as zero"},
    {"kinetic-energy", Dimension{2, -2, 0}, Q::instant, Q::fluid, at_instant<kinetic_energy>(),
     "mean of u²/2 over the fluid"},
    {"dissipation", Dimension{2, -3, 0}, Q::instant, Q::fluid, at_instant<dissipation>(),
     "mean of 2 ν S : S over the fluid, the strain rate S from each cell's populations"},
    {"flow-rate", Dimension{3, -1, 0}, Q::axis | Q::at, Q::fluid, in_step({1, add_flow_rate}, {flow_rate}),
     "volume of fluid that goes through a plane across the axis, per time, at the end; linear between the "
     "layers of cells beside the plane"},
    {"pressure-drop", dimension::pressure, Q::axis | Q::planes, Q::fluid,
     in_step({4, add_densities}, {pressure_drop}),
     "mean pressure of the fluid in the first of two planes across the axis less that in the second, at the "
     "end; "
     "without hydrostatic pressure"},
    {"body-force", dimension::acceleration, Q::axis, Q::fluid,
     in_step({}, {flow_rate, false, 1, see_body_force}),
     "acceleration of the fluid along the axis, as given or as the superficial velocity asks for, at the "
     "end"},
};

}  // namespace

constinit const std::span<const Quantity> flow_quantities = of_flow;

}  // namespace silt
