#pragma once
// Bodies come and go while a run goes on, always before a step: so everything between steps, files and cuts
// of the domain too, is of one set of bodies.
//
// Free bodies leave when their centre of mass is in the box of an [[outflow]]; bodies that move, when their
// bounding sphere is wholly beyond a side of the domain that takes them out. That follows from the pose
// alone, which all holders of a body know: they drop it without a word. Bodies come where a [[fill]] is
// applied again; a step in which none is has nothing to do with it. The first id that nobody has had is known
// to all ranks, and grows by what all have placed. Lattice units.
#include <mpi.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "coupler/exchange/check_exchange.hpp"
#include "coupler/exchange/coupling_state.hpp"
#include "silt/run_counters.hpp"

namespace silt {

struct Case;
class Scene;

/// The ways out: 0 to 5 the sides of the domain, 6 + i the [[outflow]] i.
inline constexpr int first_outflow = 6;
/// Returns "z-high", "outflow[0]".
std::string way_text(int way);

/// A body that was taken out before the step that follows so many.
struct Departure {
  std::int64_t step;
  rigid::BodyId id;
  std::int64_t way;
  double position[3];  // of its centre of mass then
};

/// Returns the first side across a bounded axis that a ball is wholly beyond.
std::optional<int> side_behind(const Case&, const rigid::Vec3& centre, double radius);

/// Returns what to say of a body beyond a side that does not take it out, after so many steps.
std::string outside_text(const Case&, rigid::BodyId, bool free, int side, std::int64_t step);

/// Collective. Returns on rank 0 those of all ranks by step and id, nothing on the others.
std::vector<Departure> gathered(MPI_Comm, const std::vector<Departure>&);

class BodyTurnover {
 public:
  /// next_id: the first that no body has had. brought: of a run that goes on, on one rank.
  BodyTurnover(const Scene&, rigid::BodyId next_id, const rigid::FixedVec3& brought = {});

  /// Lets bodies leave, then others come, before the step that follows so many. Collective where a fill is
  /// applied, else local; every rank does so alike.
  coupler::BodyChanges before_step(Scene&, std::int64_t steps_done, RunCounters&);

  rigid::BodyId next_id() const { return next_id_; }
  const coupler::ExpectedBodies& expected() const { return expected_; }
  /// Momentum of the free bodies that came less that of those that left; of this rank.
  const rigid::FixedVec3& momentum_brought() const { return brought_; }
  /// Their energy (fault_watch.hpp), of a run that goes on since then; of this rank.
  rigid::FixedSum energy_brought() const { return energy_brought_; }
  /// Returns the bodies of this rank that have left since the last call.
  std::vector<Departure> take_departures() { return std::exchange(departures_, {}); }

 private:
  void let_leave(Scene&, std::int64_t steps_done, coupler::BodyChanges&, RunCounters&);
  void let_come(Scene&, std::int64_t steps_done, coupler::BodyChanges&, RunCounters&);

  rigid::BodyId next_id_;
  coupler::ExpectedBodies expected_;
  rigid::FixedVec3 brought_;
  rigid::FixedSum energy_brought_ = 0;
  std::vector<Departure> departures_;
};

}  // namespace silt
