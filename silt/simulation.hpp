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

/// A Balance is the mass and the momentum of everything there is at one time.
struct Balance {
  double mass_deviation = 0, fluid_cells = 0;
  // of fluid and free bodies, less what bodies that came brought, with what those that left took
  rigid::Vec3 momentum = rigid::Vec3::Zero();
  double momentum_scale = 0;  // |fluid's| + sum over bodies of |m v|
};

/// This is what a checkpoint brings back, but for the populations of the fluid.
struct SavedState {
  bool is_start = false;  // of a run of its own: all but bodies and next_id begins again
  coupler::SavedBodies bodies;
  std::int64_t step = 0;
  RunCounters counters;
  Balance initial;
  rigid::BodyId next_id = 1;
  rigid::FixedVec3 momentum_brought;  // by bodies that came and went
  double fluid_speed = 0, density_deviation = 0;
  rigid::FixedSum mass_taken = 0;  // by cells that changed sides, in lbm::mass_quantum
  coupler::FlowControl::State flow_control;
  SavedLevels levels;
};

class Simulation : private rigid::StepObserver {
 public:
  /// Starts at step 0. Errors are those of Scene.
  Simulation(Case, MPI_Comm);
  /// Goes on from a state, with populations that set_populations gives the fluid, if there is one; or starts
  /// with it, at step 0, where its fluid may be that of the case too.
  Simulation(Case, MPI_Comm, const SavedState&,
             const std::function<void(const Case&, coupler::Flow&)>& set_populations);
  Simulation(const Simulation&) = delete;

  /// Before the first step: a start from rest begins with the pressure that its loads ask for, and sets off
  /// no sound (quiet_start.hpp). Does nothing where quiet_start_steps() of the case is 0. CommonGuardStop.
  void start_quietly();
  /// Does one step; before it, where the case asks for it and it is time to, looks at how the work is shared,
  /// and moves to a better cut (scene().flow and what it holds are then new ones), and bodies leave and come.
  /// CommonGuardStop comes on every rank, a step after its cause: bodies that gain energy, that move too far
  /// in a step or are outside the domain (within 64 steps), or on which the fluid's force is out of range,
  /// and fluid that is too fast. GuardStop and std::overflow_error may come on some ranks only: the others
  /// then wait for ever, so a program on several ranks ends with MPI_Abort after saying what happened.
  void step();
  /// Does so many steps, looking at the fluid every guard_interval steps (GuardStop on every rank).
  void run(std::int64_t steps);
  /// Waits for what the guards of all ranks have seen so far (CommonGuardStop), so that the state can be
  /// relied on.
  void settle();
  std::int64_t steps_done() const { return step_; }

  Scene& scene() { return scene_; }
  const Scene& scene() const { return scene_; }
  const Case& setup() const { return scene_.setup; }
  rigid::BodySet& bodies() { return scene_.bodies; }
  const rigid::BodySet& bodies() const { return scene_.bodies; }

  // ---- what a program may do between steps, by id (steering.cpp). std::invalid_argument on every rank, and
  // nothing is changed, for a body that is not there or is fixed, and for what a case may not have ----
  /// Gives a force that acts in the next step, once, however many ranks hold the body. All forces that it has
  /// for that step must not move it further than a step may.
  void add_force(rigid::BodyId, const rigid::Vec3& force_W,
                 const rigid::Vec3& torque_W = rigid::Vec3::Zero());
  void set_velocity(rigid::BodyId, const rigid::Vec3& velocity_W, const rigid::Vec3& angular_velocity_W);
  /// Moves a body to where it meets neither a wall nor another body and cells are finest; its velocity stays.
  void set_pose(rigid::BodyId, const rigid::Pose&);

  /// Moves everything to the ranks that another cut of the domain gives: no result depends on it.
  void repartition(const lbm::CutTree&);

  // ---- what may be asked ----
  std::uint64_t hash() const;
  RunCounters counters() const;  // of all ranks
  /// Returns the momentum that bodies that came and went have brought to all there is; collective.
  rigid::FixedVec3 momentum_brought() const;
  /// Collective. Returns the mass that FlowAccount::mass_taken says, of all ranks.
  rigid::FixedSum mass_taken() const;
  rigid::BodyId next_id() const { return turnover_.next_id(); }  // the first that no body has had
  /// Returns this rank's bodies that have left since the last call. Local.
  std::vector<Departure> take_departures() { return turnover_.take_departures(); }
  const Balance& initial_balance() const { return initial_; }
  Balance balance() const;
  coupler::FlowTotals checked_totals();                // needs a flow; also checks it (GuardStop)
  double fluid_speed() const { return fluid_speed_; }  // largest at any look; local
  /// The largest root mean square of density - 1 at any look; local.
  double density_deviation() const { return density_deviation_; }
  std::uint64_t links() const;  // of all ranks
  BalanceRecord balance_record() const;
  coupler::StageSeconds stage_seconds() const { return coupled_step_.seconds(); }  // local, waits included
  coupler::StageTraffic stage_traffic() const { return coupled_step_.traffic(); }  // local: with other ranks
  const parallel::Traffic& traffic_in_steps() const { return effort_.traffic; }    // local: of all steps
  const BusBytes& bus_bytes_in_steps() const { return effort_.bus; }               // local: of all steps
  double step_seconds() const { return effort_.seconds; }  // local: time spent in step()
  /// Returns the force and torque that the fluid had on each owned body in the last step, by row. Local.
  std::vector<coupler::BodyLoad> last_loads() const;
  /// Returns the force and torque that contacts, films included, had on each owned body in the last step, by
  /// row; zero of bodies that are not free, and where neither output.bodies.contacts nor a quantity of the
  /// case asks for them. Local.
  std::vector<coupler::BodyLoad> last_contact_loads() const;
  /// Of their springs.
  std::vector<coupler::BodyLoad> last_spring_loads() const;
  /// Returns what owned bodies' contacts did to walls, and to bodies that they do not move, in the last step;
  /// empty where no quantity of the case asks for it. Local.
  std::span<const coupler::ContactLoad> contact_loads() const { return contact_loads_; }
  /// Returns the moments of their contacts, which quantities of stress ask for. Local.
  std::span<const coupler::ContactMoment> contact_moments() const { return contact_moments_; }
  std::uint64_t body_count() const;    // that have an owner on any rank, counted
  std::uint64_t contacts_now() const;  // of all ranks, in the last step

 private:
  Simulation(Case&&, MPI_Comm, const SavedState*);
  void start_fresh(const std::function<void(const Case&, coupler::Flow&)>& set_populations = {});
  void resume(const SavedState&, const std::function<void(const Case&, coupler::Flow&)>& set_populations);
  // of the bodies' step
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
  RunCounters counters_;  // this rank's; those of a checkpoint on rank 0
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
