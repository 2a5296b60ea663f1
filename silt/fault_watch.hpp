#pragma once
// A fault that one rank finds in a step becomes known to all by sums over the ranks that nobody waits for,
// started at the end of a step and used at the end of the next one. So every rank stops in the same step.
//
// The sums include the energy of the bodies, which may not grow where nothing drives them: contacts only take
// it. The kinetic energy of the free bodies and their potential energy in gravity are compared with those at
// the start, less the energy of bodies that came, and with that of those that left. The growth that is
// allowed is that of collisions of several bodies in one step and of the correction of overlaps in a sound
// run, and far below that of an unsound one some tens of steps after its onset. Lattice units.
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

/// Steps between two sums in scenes without a fluid, whose steps may be as short as a sum takes.
inline constexpr std::int64_t dry_watch_interval = 8;
/// Steps between two looks at the energy: they cost a few per cent of a step without contacts. A scene that
/// goes to pieces sooner is stopped by how far its bodies move.
inline constexpr std::int64_t energy_interval = 50;

/// Returns the position of a body, counting the periods it has crossed.
rigid::Vec3 unwrapped(const rigid::BodySet&, std::size_t row, const rigid::Vec3& period);

/// Returns the kinetic energy of a free body and its potential energy in gravity, zero at the domain's
/// corner; a number out of all proportion is cut off, so that sums of them stay in range.
rigid::FixedSum mechanical_energy(const Case&, const rigid::BodySet&, std::size_t row);

class FaultWatch {
 public:
  explicit FaultWatch(const Case&);
  /// Holds bodies that are about to move further than their limit, or whose velocity is not a number: they
  /// stay where they are, at rest, so that the step that follows can be done. Returns the largest speed of
  /// the others. Called when the velocities of a (sub-)step are final, before positions follow; `step` is the
  /// one under way. Lattice units.
  double hold_runaways(const Case&, rigid::BodySet&, std::int64_t step);
  /// Notes bodies that are wholly beyond a side of the domain that does not take them out: an open one whose
  /// rule is to stop, or a wall that they have gone through, which is looked for in every 64th step, or
  /// `now`. `step`: so many are done.
  void see_outside(const Scene&, std::int64_t step, bool now = false);
  /// Notes a cell that was too fast when the pass of a step began (FluidFields::too_fast).
  void see_fluid(const Scene&, const coupler::FluidFields::Fast&, std::int64_t step);

  /// Notes of the contacts of a (sub-)step the pair that overlaps deepest, by the width of the thinner body,
  /// of those that overlap by more than half and, their response done, go on deeper. Called with
  /// hold_runaways.
  void see_overlaps(const Case&, const rigid::BodySet&, std::span<const rigid::Contact>, std::int64_t step);

  /// Looks at the energy after a step; `brought`: that of the bodies that came less that of those that left,
  /// on this rank. The first look tells what there was at the start. Scenes with a fluid, with bodies of
  /// prescribed motion, springs, walls that move or a gravity that changes are not watched: there energy
  /// comes from outside. Returns whether it is.
  bool see_energy(const Scene&, rigid::FixedSum brought, std::int64_t step);
  /// A program has done something to the bodies: the next look at their energy is the first of a new start.
  void start_again() { energy_.fresh = true; }

  /// Starts the sums of what was seen so far. Collective, but waits for nobody.
  void start(MPI_Comm);
  /// Returns what is to be said of what all ranks had seen when the sums were started, the same on every
  /// rank; "" if that is nothing, or no sums are under way. Collective.
  std::string finish(const Case&, MPI_Comm);

 private:
  enum Kind { body, fluid, overlap, kinds };  // what has several faults tells the first of these
  /// A fault that this rank has seen. Of the faults of a kind the first is reported, of these the worst, of
  /// these that of the lowest key.
  struct Fault {
    std::uint64_t moment;  // calls of hold_runaways before; the same on every rank
    double severity;
    std::uint64_t key;  // id of a body, global index of a cell
    std::string text;
  };
  struct Energies {  // of all free bodies; lift: of each by its bounding radius
    parallel::WideSum mechanical, kinetic, lift;
  };
  struct Sums {
    std::array<std::int64_t, kinds> ranks_with;
    Energies energies;
  };
  struct Energy {
    bool watched;
    bool fresh = true, first = true, looked_at = false;  // first: of the look under way
    Energies here;                                       // at the last look
    std::int64_t step = 0, start_step = 0;
    double start = 0, largest_kinetic = 0;
  };
  std::string gain(const Case&, const Energies& of_all);
  static std::string told(MPI_Comm, const std::optional<Fault>& mine);
  /// text() is asked for only if the fault is the one to tell.
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
