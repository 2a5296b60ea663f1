#include "silt/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "coupler/forces/covered_momentum.hpp"
#include "coupler/forces/fluid_forces.hpp"
#include "coupler/state_hash.hpp"
#include "cpu/isa.hpp"
#include "lbm/blocks/excess.hpp"
#include "parallel/collectives.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/scene.hpp"

namespace silt {

using rigid::BodyId;
using rigid::Vec3;

namespace {

/// Returns whether a quantity has one of the types.
bool asks_for(const Case& setup, std::initializer_list<std::string_view> types) {
  return std::ranges::any_of(setup.quantities, [&](const QuantitySpec& q) {
    return std::ranges::find(types, q.type) != types.end();
  });
}
bool asks_for_body_loads(const Case& setup) {
  return asks_for(setup, {"contact-force", "contact-torque"});
}
bool asks_for_contact_loads(const Case& setup) {
  return asks_for_body_loads(setup) ||
         asks_for(setup, {"wall-stress", "relative-viscosity", "wall-force", "wall-torque", "wall-power"});
}
bool asks_for_stress(const Case& setup) {
  return asks_for(setup, {"contact-stress"});
}

}  // namespace

Simulation::Simulation(Case setup, MPI_Comm comm) : Simulation(std::move(setup), comm, nullptr) {
  if (scene_.setup.start)
    throw std::invalid_argument("the case begins with another run's end: simulation_from");
  start_fresh();
}
Simulation::Simulation(Case setup, MPI_Comm comm, const SavedState& saved,
                       const std::function<void(const Case&, coupler::Flow&)>& set_populations)
    : Simulation(std::move(setup), comm, &saved) {
  saved.is_start ? start_fresh(set_populations) : resume(saved, set_populations);
}

/// Makes everything but the state, which start_fresh() or resume() sets.
Simulation::Simulation(Case&& setup, MPI_Comm comm, const SavedState* saved)
    : scene_(std::move(setup), comm, saved ? &saved->bodies : nullptr, saved ? saved->levels : SavedLevels{},
             saved && saved->is_start ? saved->next_id : 0),
      coupled_step_(scene_.parts()),
      turnover_(scene_, saved && !saved->is_start ? saved->next_id : scene_.at_start.first_free_id,
                saved && scene_.rank() == 0 ? saved->momentum_brought : rigid::FixedVec3{}),
      faults_(scene_.setup) {
  flush_denormals_to_zero();
  if (scene_.rigid_step) scene_.rigid_step->set_observer(*this);
}

void Simulation::start_fresh(const std::function<void(const Case&, coupler::Flow&)>& set_populations) {
  if (scene_.flow) {
    if (set_populations) set_populations(setup(), *scene_.flow);
    for (int level = 0; level < scene_.flow->levels() && !set_populations; ++level)
      set_initial_flow(setup(), scene_.flow->fields(level));
    scene_.flow->start(scene_.bodies);
  }
  scene_.drive(0);
  initial_ = balance();
  faults_.hold_runaways(setup(), scene_.bodies, step_);
  settle();
  if (faults_.see_energy(scene_, turnover_.energy_brought(), step_)) faults_.start(scene_.comm);
}

void Simulation::resume(const SavedState& saved,
                        const std::function<void(const Case&, coupler::Flow&)>& set_populations) {
  if (saved.step > 0) scene_.move_walls(saved.step - 1);  // as for the mapping of the last step
  if (scene_.flow) {
    set_populations(setup(), *scene_.flow);
    scene_.flow->resume(saved.step, scene_.rank() == 0 ? saved.mass_taken : rigid::FixedSum{0});
    scene_.flow->start(scene_.bodies);
  }
  step_ = saved.step;
  if (coupler::FlowControl* const control = scene_.flow ? scene_.flow->control() : nullptr)
    control->set_state(saved.flow_control, step_);
  scene_.drive(step_);
  if (scene_.rank() == 0) counters_ = saved.counters;
  counters_.sweeps = saved.counters.sweeps;
  initial_ = saved.initial;
  fluid_speed_ = saved.fluid_speed, density_deviation_ = saved.density_deviation;
  if (scene_.rigid_step && saved.step > 0) scene_.rigid_step->resume();
  if (faults_.see_energy(scene_, turnover_.energy_brought(), step_)) faults_.start(scene_.comm);
}

void Simulation::before_drift(rigid::BodySet& bodies) {
  const rigid::RigidStep& step = *scene_.rigid_step;
  const coupler::ContactsInStep contacts{bodies, step.contacts(), step.other_impulses()};
  if (asks_for_contact_loads(setup())) add_contact_loads(contacts, scene_.exchange->extent(), contact_loads_);
  if (asks_for_stress(setup())) add_contact_moments(contacts, scene_.exchange->extent(), contact_moments_);
  const double speed = faults_.hold_runaways(setup(), bodies, step_ + 1);
  counters_.body_speed = std::max(counters_.body_speed, speed);
  faults_.see_overlaps(setup(), bodies, step.contacts(), step_ + 1);
}

/// Returns whether contact loads are recorded in the columns of the bodies.
bool Simulation::notes_contacts() const {
  return setup().output.body_contacts || asks_for_body_loads(setup());
}

bool Simulation::wants_all_impulses() const {
  return asks_for_stress(setup());
}

bool Simulation::wants_contact_impulses() const {
  return notes_contacts() || scene_.flow;
}

void Simulation::contact_impulse(rigid::BodySet& bodies, std::size_t row, const Vec3& impulse,
                                 const Vec3& angular_impulse) {
  coupler::add_contact_load(bodies, row, impulse, angular_impulse);
}

/// Runs work, which may find forces of the last step out of range, and reports these.
template <class Work>
auto Simulation::guarded(Work&& work) {
  try {
    return work();
  } catch (const coupler::ForceOutOfRange& found) {
    tell_faults();  // a fault that caused it
    const std::string what = fmt::format("the force on {} {}", body_name(setup(), found.on), found.what());
    throw CommonGuardStop(overflow_text(setup(), what, step_));
  }
}

void Simulation::start_quietly() {
  if (step_ > 0 || quiet_start_steps(setup()) == 0) return;
  guarded([&] { silt::start_quietly(scene_); });
  initial_ = balance();
}

/// Reports faults of the last step, and starts the sums over this one.
void Simulation::watch() {
  const bool fluid = scene_.flow != nullptr;
  if (!fluid && !scene_.anything_moves) return;
  tell_faults();
  for (int level = 0; fluid && level < scene_.flow->levels(); ++level)
    if (const auto fast = scene_.flow->too_fast(level)) faults_.see_fluid(scene_, *fast, step_ - 1);
  faults_.see_outside(scene_, step_);
  const bool looks_at_energy = scene_.anything_moves && step_ % energy_interval == 0 &&
                               faults_.see_energy(scene_, turnover_.energy_brought(), step_);
  if (fluid || looks_at_energy || step_ % dry_watch_interval == 0) faults_.start(scene_.comm);
}

void Simulation::tell_faults() {
  if (const std::string found = faults_.finish(setup(), scene_.comm); !found.empty())
    throw CommonGuardStop(found);
}

void Simulation::settle() {
  tell_faults();
  faults_.see_outside(scene_, step_, true);
  faults_.start(scene_.comm);
  tell_faults();
}

void Simulation::repartition(const lbm::CutTree& tree) {
  if (setup().coarsening && step_ % coupler::regrid_interval != 0)
    throw std::invalid_argument(fmt::format(
        "a domain with [coarsening] can be cut again only after a multiple of {} steps, not after {}",
        coupler::regrid_interval, step_));
  if (setup().coarsening) regrid();
  guarded([&] { scene_.repartition(tree); });
  coupled_step_.renew(scene_.parts());
}

/// Balances before a step, so that all results of a step belong to one cut.
void Simulation::balance_work() {
  const std::int64_t every = setup().balance_every;
  if (every == 0 || step_ == 0 || step_ % every != 0 || !scene_.may_be_cut_again()) return;
  const auto begin = std::chrono::steady_clock::now();
  const CutComparison cuts = compare_cuts(scene_);
  ++effort_.balance.looks;
  effort_.balance.last.before = effort_.balance.last.after = cuts.present.largest_over_mean();
  if (cuts.worth_moving(every)) {
    repartition(cuts.better.tree);
    ++effort_.balance.moves;
    effort_.balance.last.after = cuts.better.largest_over_mean();
  }
  effort_.balance.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void Simulation::regrid() {
  if (!setup().coarsening || step_ % coupler::regrid_interval != 0) return;
  if (const auto id = scene_.body_at_border()) throw GuardStop(border_text(setup(), *id, step_));
  if (scene_.regrid()) coupled_step_.renew(scene_.parts());
}

BalanceRecord Simulation::balance_record() const {
  BalanceRecord record = effort_.balance;
  record.at_start = scene_.at_start.evenness;
  return record;
}

void Simulation::step() {
  const auto begin = std::chrono::steady_clock::now();
  regrid();
  balance_work();
  const coupler::BodyChanges changes = turnover_.before_step(scene_, step_, counters_);
  const parallel::Traffic before = parallel::traffic();
  const BusBytes on_bus_before = bus_bytes(scene_.setup.device);
  parallel::begin_step_of_traffic();
  scene_.move_walls(step_);
  contact_loads_.clear(), contact_moments_.clear();
  if (!scene_.flow && notes_contacts()) coupler::clear_contact_loads(scene_.bodies);
  const rigid::RigidStepReport report = guarded([&] { return coupled_step_(scene_.bodies, changes); });
  if (!scene_.rigid_step) {  // no step has cleared them
    std::fill(scene_.bodies.force.begin(), scene_.bodies.force.end(), rigid::FixedVec3{});
    std::fill(scene_.bodies.torque.begin(), scene_.bodies.torque.end(), rigid::FixedVec3{});
  }
  ++step_;
  scene_.drive(step_);
  count(report);
  watch();
  check_.finish(*scene_.exchange, scene_.bodies, turnover_.expected());  // of the last step
  if (scene_.anything_moves && step_ % guard_interval == 0)
    check_.start(*scene_.exchange, scene_.bodies, turnover_.expected(), step_);
  effort_.traffic += parallel::traffic() - before,
      effort_.bus += bus_bytes(scene_.setup.device) - on_bus_before;
  effort_.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void Simulation::run(std::int64_t steps) {
  for (std::int64_t i = 0; i < steps; ++i) {
    step();
    if (scene_.flow && step_ % guard_interval == 0) checked_totals();
  }
  settle();
}

void Simulation::count(const rigid::RigidStepReport& report) {
  if (scene_.flow && setup().has_surfaces()) {
    const coupler::MappingCounts mapping = scene_.flow->account().mapping();
    counters_.covered += mapping.covered;
    counters_.uncovered += mapping.uncovered;
  }
  last_contacts_ = report.resolver.contacts;
  counters_.contacts += report.resolver.contacts;
  counters_.lubricated_contacts += report.lubrication.with;
  counters_.unlubricated_contacts += report.lubrication.without;
  counters_.mixed_owner_contacts += report.mixed_owner_contacts;
  counters_.sweeps += report.resolver.sweeps;
  counters_.infeasible += report.resolver.infeasible;
  counters_.penetration = std::max(counters_.penetration, report.resolver.penetration);
  counters_.residual = std::max(counters_.residual, report.resolver.residual);
}

RunCounters Simulation::counters() const {
  RunCounters c = counters_;
  c.migrations += scene_.exchange->counters().migrations;
  if (scene_.contacts.backend) {
    const rigid::BackendCounters& asked = scene_.contacts.backend->counters();
    c.queries += asked.queries, c.answered += asked.answered;
    c.refined += asked.refined, c.fallbacks += asked.fallbacks;
  }
  return {parallel::sum_over_ranks<Counts>(scene_.comm, c),
          parallel::max_over_ranks<Extremes>(scene_.comm, c)};
}

// ---- queries ----

std::uint64_t Simulation::hash() const {
  return coupler::state_hash(scene_.comm, scene_.flow.get(), scene_.bodies);
}

coupler::FlowTotals Simulation::checked_totals() {
  const coupler::FlowTotals totals = guarded([&] { return scene_.flow->totals(); });
  fluid_speed_ = std::max(fluid_speed_, totals.max_speed);
  density_deviation_ = std::max(density_deviation_, totals.density_deviation);
  check_flow(scene_, totals, step_);
  return totals;
}

Balance Simulation::balance() const {
  Balance b;
  struct {
    rigid::FixedVec3 momentum;
    rigid::FixedSum scale = 0;      // sum of |m v|
    rigid::FixedSum mass_owed = 0;  // to the fluid, in quanta of an excess
  } mine;
  const rigid::BodySet& bodies = scene_.bodies;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    mine.mass_owed += coupler::coupling_of(bodies, row).mass_owed.all;
    if (!bodies.is_dynamic(row)) continue;
    Vec3 p = bodies.mass[row] * bodies.velocity[row];
    mine.scale += rigid::to_fixed(p.norm());
    p += coupler::impulse_debt(bodies, row) + coupler::coupling_of(bodies, row).pending_impact();
    mine.momentum.add(p);
  }
  const auto all = parallel::sum_over_ranks(scene_.comm, mine);
  const rigid::FixedVec3 brought = momentum_brought();
  for (int d = 0; d < 3; ++d) b.momentum[d] = rigid::from_fixed(all.momentum.q[d] - brought.q[d]);
  b.momentum_scale = rigid::from_fixed(all.scale);
  if (scene_.flow) {
    const coupler::FlowTotals totals = scene_.flow->totals();
    const Vec3 fluid(totals.momentum[0], totals.momentum[1], totals.momentum[2]);
    b.momentum += fluid;
    b.momentum_scale += fluid.norm();
    const bool single = setup().fluid->precision == coupler::Precision::single_;
    const double quantum = single ? lbm::excess_quantum<float> : lbm::excess_quantum<double>;
    b.mass_deviation = totals.mass_deviation + double(all.mass_owed) * quantum;
    b.fluid_cells = static_cast<double>(totals.fluid_cells);
  }
  return b;
}

rigid::FixedSum Simulation::mass_taken() const {
  struct {
    rigid::FixedSum mass;
  } taken{scene_.flow ? scene_.flow->account().mass_taken() : 0};
  return parallel::sum_over_ranks(scene_.comm, taken).mass;
}

rigid::FixedVec3 Simulation::momentum_brought() const {
  rigid::FixedVec3 brought = turnover_.momentum_brought();
  if (scene_.flow) brought.add(scene_.flow->account().momentum_brought());
  return parallel::sum_over_ranks(scene_.comm, brought);
}

std::uint64_t Simulation::links() const {
  std::uint64_t n = scene_.flow && setup().has_surfaces() ? scene_.flow->account().mapping().links : 0;
  return parallel::sum_over_ranks(scene_.comm, n);
}

std::uint64_t Simulation::body_count() const {
  return parallel::sum_over_ranks(scene_.comm, std::uint64_t(scene_.bodies.owned));
}

std::uint64_t Simulation::contacts_now() const {
  return parallel::sum_over_ranks(scene_.comm, std::uint64_t(last_contacts_));
}

std::vector<coupler::BodyLoad> Simulation::last_loads() const {
  return coupler::stored_loads(scene_.bodies, &coupler::CouplingState::seen_load);
}
std::vector<coupler::BodyLoad> Simulation::last_contact_loads() const {
  return coupler::stored_loads(scene_.bodies, &coupler::CouplingState::contact_load);
}
std::vector<coupler::BodyLoad> Simulation::last_spring_loads() const {
  return coupler::stored_loads(scene_.bodies, &coupler::CouplingState::spring_load);
}

}  // namespace silt
