#pragma once
// A scene that advances in time: what `silt run` runs, usable without it.
//
//   Simulation simulation(read_case("cases/segregation"), MPI_COMM_WORLD);
//   while (simulation.steps_done() < 1000) {
//     simulation.add_force(7, {0, 0, 1e-3});
//     simulation.step();
//   }
//
// Every call is collective unless it says otherwise; every rank makes the same calls with the same arguments,
// and the result does not depend on how many there are. Lattice units.
#include <functional>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/flow_control.hpp"
#include "coupler/forces/contact_loads.hpp"
#include "parallel/traffic.hpp"
#include "silt/body_turnover.hpp"
#include "silt/fault_watch.hpp"
#include "silt/guard.hpp"
#include "silt/run_counters.hpp"
#include "silt/scene.hpp"

namespace silt {

/// The mass and momentum of a whole scene at one time.
struct Balance {
  double mass_deviation = 0, fluid_cells = 0;  // with the mass that bodies owe the fluid
  // of fluid and free bodies, corrected for bodies that arrived or left
  rigid::Vec3 momentum = rigid::Vec3::Zero();
  double momentum_scale = 0;  // |momentum of the fluid| + sum over bodies of |m v|
};

/// The contents of a checkpoint, without populations.
struct SavedState {
  bool is_start = false;  // of another run: only bodies and next_id are used
  coupler::SavedBodies bodies;
  std::int64_t step = 0;
  RunCounters counters;
  Balance initial;
  rigid::BodyId next_id = 1;
  rigid::FixedVec3 momentum_brought;  // by bodies that arrived or left
  double fluid_speed = 0, density_deviation = 0;
  rigid::FixedSum mass_taken = 0;  // by cells that turned solid or fluid, lbm::mass_quantum
  coupler::FlowControl::State flow_control;
  SavedLevels levels;
};

class Simulation : private rigid::StepObserver {
 public:
  /// Starts at step 0. Throws like Scene.
  Simulation(Case, MPI_Comm);
  /// Resumes from a state; set_populations sets the fluid's populations. If the state is a start, begins at
  /// step 0 from it, and set_populations may be empty for the initial flow of the case.
  Simulation(Case, MPI_Comm, const SavedState&,
             const std::function<void(const Case&, coupler::Flow&)>& set_populations);
  Simulation(const Simulation&) = delete;

  /// Starts from rest with the pressure that balances the loads, without sound waves (scene.hpp). Call
  /// before the first step; does nothing if quiet_start_steps() is 0. Throws CommonGuardStop.
  void start_quietly();
  /// Does one step. Before it, balances the work if that is due (a move replaces scene().flow and all it
  /// holds), and removes and adds bodies. Throws CommonGuardStop on every rank, one step after the cause:
  /// bodies that gain energy, move too far in a step, are outside the domain (within 64 steps) or have a
  /// fluid force out of range, and fluid that is too fast. GuardStop and std::overflow_error may occur on
  /// some ranks only, and others would wait for ever: on several ranks report the error and call MPI_Abort.
  void step();
  /// Does `steps` steps, and checks the fluid every guard_interval steps (GuardStop on every rank).
  void run(std::int64_t steps);
  /// Waits for the guards of all ranks (CommonGuardStop), so that the present state is known to be sound.
  void settle();
  std::int64_t steps_done() const { return step_; }

  Scene& scene() { return scene_; }
  const Scene& scene() const { return scene_; }
  const Case& setup() const { return scene_.setup; }
  rigid::BodySet& bodies() { return scene_.bodies; }
  const rigid::BodySet& bodies() const { return scene_.bodies; }

  // ---- changes between steps, by body id (steering.cpp). Throw std::invalid_argument on every rank and
  // change nothing if the body does not exist or is fixed, or if a case could not have the value ----
  /// Adds a force to the next step, once, however many ranks hold the body. All added forces together must
  /// not move the body further than its limit per step.
  void add_force(rigid::BodyId, const rigid::Vec3& force_W,
                 const rigid::Vec3& torque_W = rigid::Vec3::Zero());
  void set_velocity(rigid::BodyId, const rigid::Vec3& velocity_W, const rigid::Vec3& angular_velocity_W);
  /// Moves a body to a place in finest cells, free of walls and bodies; keeps its velocity.
  void set_pose(rigid::BodyId, const rigid::Pose&);

  /// Moves the state to the ranks of another cut of the domain; results do not change.
  void repartition(const lbm::CutTree&);

  // ---- queries ----
  std::uint64_t hash() const;
  RunCounters counters() const;  // of all ranks
  /// Returns the momentum that bodies brought when they arrived or left, in total. Collective.
  rigid::FixedVec3 momentum_brought() const;
  /// Returns FlowAccount::mass_taken over all ranks. Collective.
  rigid::FixedSum mass_taken() const;
  rigid::BodyId next_id() const { return turnover_.next_id(); }  // the first unused id
  /// Returns this rank's bodies that left since the last call. Local.
  std::vector<Departure> take_departures() { return turnover_.take_departures(); }
  const Balance& initial_balance() const { return initial_; }
  Balance balance() const;
  coupler::FlowTotals checked_totals();                // needs a flow; also checks it (GuardStop)
  double fluid_speed() const { return fluid_speed_; }  // largest at any check; local
  /// Returns the largest root mean square of density - 1 at any check. Local.
  double density_deviation() const { return density_deviation_; }
  std::uint64_t links() const;  // of all ranks
  BalanceRecord balance_record() const;
  coupler::StageSeconds stage_seconds() const { return coupled_step_.seconds(); }  // local, with waiting
  coupler::StageTraffic stage_traffic() const { return coupled_step_.traffic(); }  // local: with other ranks
  const parallel::Traffic& traffic_in_steps() const { return effort_.traffic; }    // local: of all steps
  const BusBytes& bus_bytes_in_steps() const { return effort_.bus; }               // local: of all steps
  double step_seconds() const { return effort_.seconds; }  // local: time spent in step()
  /// Returns the force and torque of the fluid on each owned body in the last step, by row. Local.
  std::vector<coupler::BodyLoad> last_loads() const;
  /// Returns the force and torque of contacts and lubrication films on each owned body in the last step, by
  /// row. Zero for bodies that are not free, and unless output.bodies.contacts or a quantity needs it. Local.
  std::vector<coupler::BodyLoad> last_contact_loads() const;
  /// Returns the force and torque of springs likewise.
  std::vector<coupler::BodyLoad> last_spring_loads() const;
  /// Returns the loads by contacts of owned bodies on walls and on bodies that they do not move in the last
  /// step; empty if no quantity needs them. Local.
  std::span<const coupler::ContactLoad> contact_loads() const { return contact_loads_; }
  /// Returns the moments of these contacts, for quantities of stress. Local.
  std::span<const coupler::ContactMoment> contact_moments() const { return contact_moments_; }
  std::uint64_t body_count() const;    // bodies with an owner, counted on all ranks
  std::uint64_t contacts_now() const;  // of all ranks, in the last step

 private:
  Simulation(Case&&, MPI_Comm, const SavedState*);
  void start_fresh(const std::function<void(const Case&, coupler::Flow&)>& set_populations = {});
  void resume(const SavedState&, const std::function<void(const Case&, coupler::Flow&)>& set_populations);
  // for the step of the bodies
  void before_drift(rigid::BodySet&) override;
  bool wants_contact_impulses() const override;
  bool wants_all_impulses() const override;
  void contact_impulse(rigid::BodySet&, std::size_t row, const rigid::Vec3& impulse,
                       const rigid::Vec3& angular_impulse) override;
  void balance_work();
  void regrid();
  void count(const rigid::RigidStepReport&);
  bool notes_contacts() const;
  void watch();
  void tell_faults();
  template <class Work>
  auto guarded(Work&&);
  struct Steered;
  Steered steered(rigid::BodyId) const;
  void require_room(rigid::BodyId, const BodySpec&) const;

  Scene scene_;
  coupler::CoupledStep coupled_step_;
  std::int64_t step_ = 0;
  RunCounters counters_;  // of this rank; those of a checkpoint on rank 0
  std::uint64_t last_contacts_ = 0;
  Balance initial_;
  BodyTurnover turnover_;
  coupler::PendingCheck check_;
  FaultWatch faults_;
  double fluid_speed_ = 0, density_deviation_ = 0;
  struct {  // on this rank, in all steps
    double seconds = 0;
    parallel::Traffic traffic;
    BusBytes bus;
    BalanceRecord balance;
  } effort_;
  std::vector<coupler::ContactLoad> contact_loads_;
  std::vector<coupler::ContactMoment> contact_moments_;
};

}  // namespace silt
