// The parts of the stress of a suspension, averaged over a box: of the fluid, and by bodies through their
// presence and through contacts (G. K. Batchelor, J. Fluid Mech. 41 (1970) 545). Tension is positive.
#include "coupler/forces/contact_loads.hpp"
#include "silt/case/case.hpp"
#include "silt/results/quantity_computation.hpp"
#include "silt/results/solid_cells.hpp"
#include "silt/results/velocity_gradient.hpp"

namespace silt {

namespace {

using lbm::Int3;
using rigid::ExactSum;
using rigid::Vec3;

bool is_in(const QuantitySpec& q, const Vec3& x) {
  return (x.array() >= q.box.lower.array()).all() && (x.array() < q.box.upper.array()).all();
}

/// Cells are weighted by their part in the box.
void add_viscous_stress(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> stress) {
  const double twice_viscosity = 2 * simulation.setup().fluid->kinematic_viscosity;
  simulation.scene().flow->for_levels([&](const coupler::FluidFields& fields) {
    for_each_fluid_cell(fields, fields.cells_meeting(q.box), [&](Int3 cell, const lbm::Moments& m) {
      const double share = twice_viscosity * fields.volume_in(q.box, cell);
      stress[0].add(share * strain_rate(fields, m)[q.component]);
    });
  });
}

/// Adds the force of the links of each body (method.md, equations 22 and 33) times the vector from its centre
/// to the cut, taken half-way between cells.
void add_particle_stress(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> stress) {
  const coupler::FluidFields& fields = simulation.scene().flow->fields();
  const rigid::BodySet& bodies = simulation.bodies();
  const SolidCells solid(simulation, fields);
  const bool galilean = simulation.setup().coupling.force == coupler::ForceForm::galilean;
  for (int b = 0; b < fields.blocks(); ++b) {
    const Int3 size = fields.block(b).size, one{1, 1, 1};
    solid.for_each({b, Int3{} - one, size + one}, [&](std::size_t row, Int3 cell, const Vec3& r) {
      if (!q.is_about(bodies.kind[row]) || !is_in(q, bodies.position[row])) return;
      for (int i = 1; i < lbm::D3Q19::directions; ++i) {
        const Int3 c = lbm::D3Q19::c[i], x = cell - c;
        if (!lbm::CellBox{{}, size}.contains(x) || !fields.is_fluid(b, x)) continue;
        const Vec3 along(c.x, c.y, c.z), arm = r - 0.5 * along;
        const auto [out, back] = fields.link(b, x, i);
        Vec3 force = (out + back) * along;
        if (galilean) force -= (out - back) * bodies.velocity_at(row, arm);
        stress[0].add(coupler::symmetric_product(arm, force)[q.component]);
      }
    });
  }
}

void add_contact_stress(const Simulation& simulation, const QuantitySpec& q, std::span<ExactSum> stress) {
  for (const coupler::ContactMoment& of : simulation.contact_moments())
    if (q.is_about(of.kind) && is_in(q, of.position)) stress[0].add(of.moment[q.component]);
}

double over_volume(const Case&, const QuantitySpec& q, std::int64_t, std::span<const double> sum) {
  return sum[0] / (q.box.upper - q.box.lower).prod();
}

constexpr Quantity of_stress[] = {
    {"viscous-stress", dimension::pressure, Q::box | Q::component, Q::fluid,
     in_step({1, add_viscous_stress}, {over_volume}),
     "2 ρ ν S of the fluid in the box, over the volume of the box, at the end; a cell counts by its part in "
     "the box"},
    {"particle-stress", dimension::pressure, Q::body | Q::box | Q::component, Q::fluid | Q::bodies,
     in_step({1, add_particle_stress, has_acted}, {over_volume}),
     "what bodies with their centres in the box add to it: force of the fluid on their surfaces times the "
     "way to it from their centres, the symmetric part, at the end"},
    {"contact-stress", dimension::pressure, Q::body | Q::box | Q::component, Q::bodies,
     in_step({1, add_contact_stress, has_acted}, {over_volume}),
     "the same of contacts and films; pull is positive"},
};

}  // namespace

constinit const std::span<const Quantity> stress_quantities = of_stress;

}  // namespace silt
