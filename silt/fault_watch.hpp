#pragma once
// Makes faults that one rank finds in a step known to all ranks, by sums that start at the end of a step and
// are used at the end of the next. No rank waits, and all ranks stop in the same step.
//
// The sums contain the kinetic and potential energy (gravity) of free bodies, which cannot grow without a
// drive, as contacts dissipate it. It is compared with that at the start, corrected for bodies that arrived
// or left. The allowed growth covers collisions of several bodies in one step and the correction of overlaps;
// a diverging run exceeds it some tens of steps after the onset. Lattice units.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "coupler/flow.hpp"
#include "parallel/pending_sums.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/contact.hpp"
#include "rigid/math/exact_sum.hpp"
#include "silt/case/case_check.hpp"

namespace silt {

struct Case;
class Scene;

/// Steps between two sums in scenes without a fluid, where a step may be as short as a sum.
inline constexpr std::int64_t dry_watch_interval = 8;
/// Steps between two checks of the energy, which cost a few per cent of a step without contacts. Faster
/// divergence is found by the motion of bodies.
inline constexpr std::int64_t energy_interval = 50;

/// Returns the position of a body in the unwrapped domain.
rigid::Vec3 unwrapped(const rigid::BodySet&, std::size_t row, const rigid::Vec3& period);

/// Returns the kinetic energy of a free body and its potential energy in gravity, zero at the corner of the
/// domain, clamped to keep sums in range.
rigid::FixedSum mechanical_energy(const Case&, const rigid::BodySet&, std::size_t row);

class FaultWatch {
 public:
  explicit FaultWatch(const Case&);
  /// Stops bodies that would move further than their limit, or whose velocity is not a number, so that the
  /// step can be completed, and notes the fault. Returns the largest speed of the others. Call when the
  /// velocities of a (sub-)step are final, before positions follow; `step` is the current step.
  double hold_runaways(const Case&, rigid::BodySet&, std::int64_t step);
  /// Notes bodies that are wholly beyond a side of the domain that does not remove them: an open side where
  /// the run is to stop, or a wall. Checks every 64th step, or `now`; `step` is the number of steps done.
  void see_outside(const Scene&, std::int64_t step, bool now = false);
  /// Notes a cell that was too fast at the start of a step's pass (FluidFields::too_fast).
  void see_fluid(const Scene&, const coupler::FluidFields::Fast&, std::int64_t step);

  /// Notes the contact of a (sub-)step with the deepest overlap, relative to the half-width of the thinner
  /// body, among those deeper than it whose bodies still approach. Call with hold_runaways.
  void see_overlaps(const Case&, const rigid::BodySet&, std::span<const rigid::Contact>, std::int64_t step);

  /// Computes the energy after a step; `brought` is that of bodies that arrived less that of those that left
  /// on this rank. The first call sets the reference. Returns false, and does nothing, for scenes that energy
  /// enters: with a fluid, prescribed motions, springs, moving walls or varying gravity.
  bool see_energy(const Scene&, rigid::FixedSum brought, std::int64_t step);
  /// Takes a new reference of the energy at the next check, after a program has changed bodies.
  void start_again() { energy_.fresh = true; }

  /// Starts the sums of the faults so far. Collective, but waits for no other rank.
  void start(MPI_Comm);
  /// Returns the error that ranks had found when the sums were started, the same on all, or "". Collective.
  std::string finish(const Case&, MPI_Comm);

 private:
  enum Kind { body, fluid, overlap, kinds };  // in order of priority
  /// A fault on this rank. Of each kind the first fault is reported, among these the most severe, then the
  /// one with the lowest key.
  struct Fault {
    std::uint64_t moment;  // number of earlier calls of hold_runaways, equal on all ranks
    double severity;
    std::uint64_t key;  // id of a body, global index of a cell
    std::string text;
  };
  struct Energies {  // of free bodies; lift: to raise each by its radius
    parallel::WideSum mechanical, kinetic, lift;
  };
  struct Sums {
    std::array<std::int64_t, kinds> ranks_with;
    Energies energies;
  };
  struct Energy {
    bool watched;
    bool fresh = true, first = true, looked_at = false;  // first: the present sums set the reference
    Energies here;                                       // at the last check
    std::int64_t step = 0, start_step = 0;
    double start = 0, largest_kinetic = 0;
  };
  std::string gain(const Case&, const Energies& of_all);
  static std::string told(MPI_Comm, const std::optional<Fault>& mine);
  /// Calls text() only if this fault is the one to report so far.
  template <class Text>
  void note(Kind, double severity, std::uint64_t key, Text&& text);
  void hold_rows(const Case&, rigid::BodySet&, std::size_t begin, std::size_t end, std::int64_t step);

  MotionLimits limits_;
  std::array<std::optional<Fault>, kinds> seen_;
  std::uint64_t moment_ = 0;
  Energy energy_;
  parallel::PendingSums<Sums> sums_;
};

}  // namespace silt
