#pragma once
// Removes and adds bodies during a run, always before a step, so that the state between steps, in files too,
// has one set of bodies.
//
// A free body leaves when its centre of mass is in the box of an [[outflow]]; a body that moves leaves when
// its bounding sphere is wholly beyond a side of the domain that removes bodies. Both follow from the pose,
// so all holders of a body remove it without messages. Bodies arrive where a [[fill]] is applied again. All
// ranks know the first unused id, which grows by the number of bodies placed on all ranks. Lattice units.
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

/// How a body may leave: 0 to 5 through a side of the domain, 6 + i into [[outflow]] i.
inline constexpr int first_outflow = 6;
/// Returns "z-high", "outflow[0]".
std::string way_text(int way);

/// A body that was removed before step `step + 1`.
struct Departure {
  std::int64_t step;
  rigid::BodyId id;
  std::int64_t way;
  double position[3];  // of its centre of mass
};

/// Returns the first side, across an axis that is not periodic, that a ball is wholly beyond.
std::optional<int> side_behind(const Case&, const rigid::Vec3& centre, double radius);

/// Returns the error for a body beyond a side that does not remove bodies, after `step` steps.
std::string outside_text(const Case&, rigid::BodyId, bool free, int side, std::int64_t step);

/// Returns the departures of all ranks on rank 0, by step and id; nothing on other ranks. Collective.
std::vector<Departure> gathered(MPI_Comm, const std::vector<Departure>&);

class BodyTurnover {
 public:
  /// next_id is the first unused id; `brought` is the momentum of a resumed run, on one rank only.
  BodyTurnover(const Scene&, rigid::BodyId next_id, const rigid::FixedVec3& brought = {});

  /// Removes and then adds bodies before step `steps_done + 1`. Collective if a fill is applied, else local;
  /// all ranks must call it.
  coupler::BodyChanges before_step(Scene&, std::int64_t steps_done, RunCounters&);

  rigid::BodyId next_id() const { return next_id_; }
  const coupler::ExpectedBodies& expected() const { return expected_; }
  /// Returns the momentum of free bodies that arrived less that of those that left, on this rank.
  const rigid::FixedVec3& momentum_brought() const { return brought_; }
  /// Returns the same of energy (fault_watch.hpp), since the start or the resume.
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
