#pragma once
// What one rank finds wrong in a step becomes known to all: sums over the ranks that nobody waits for,
// started at the end of a step and used at the end of the next one. So every rank stops in the same step.
#include <mpi.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "coupler/flow.hpp"
#include "parallel/sums_under_way.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/contact.hpp"

namespace silt::coupler {

struct Case;
class MotionLimits;
class Scene;

/// Steps between two sums in scenes without a fluid, whose steps may be as short as a sum takes.
inline constexpr std::int64_t dry_watch_interval = 8;

class FaultWatch {
 public:
  /// Holds bodies that are about to move further than their limit, or whose velocity is not a number: they
  /// stay where they are, at rest, so that the step that follows can be done. Returns the largest speed of
  /// the others. Called when the velocities of a (sub-)step are final, before positions follow; `step` is the
  /// one under way. Lattice units.
  double hold_runaways(const Case&, const MotionLimits&, rigid::BodySet&, std::int64_t step);
  /// Notes bodies that are wholly beyond a side of the domain that does not take them out: an open one whose
  /// rule is to stop, or a wall that they have gone through. `step`: so many are done.
  void see_outside(const Scene&, std::int64_t step);
  /// Notes a cell that was too fast when the pass of a step began (Flow::too_fast).
  void see_fluid(const Scene&, const Flow::Fast&, std::int64_t step);

  /// Notes of the contacts of a (sub-)step the pair that overlaps deepest, by the width of the thinner body,
  /// of those that overlap by more than half and, their response done, go on deeper. Called with
  /// hold_runaways.
  void see_overlaps(const Case&, const MotionLimits&, const rigid::BodySet&, std::span<const rigid::Contact>,
                    std::int64_t step);

  struct Found {
    bool fluid = false, body = false, overlap = false;  // on any rank
  };
  /// Starts the sums of what was seen so far. Collective, but waits for nobody.
  void start(MPI_Comm);
  bool under_way() const { return sums_.under_way(); }
  /// Returns what all ranks had seen when the sums were started; nothing if none are under way. Collective.
  Found finish();
  /// Return what is to be said, the same on every rank. Collective, once finish has told of one: of the body
  /// held first (of several at a time the lowest id), of the fastest cell, of the deepest overlap.
  std::string body_fault(MPI_Comm) const;
  std::string overlap_fault(MPI_Comm) const;
  std::string fluid_fault(MPI_Comm) const;

 private:
  void note_body(rigid::BodyId, std::string text);
  void hold_rows(const Case&, const MotionLimits&, rigid::BodySet&, std::size_t begin, std::size_t end,
                 std::int64_t step);
  struct BodyFault {
    std::uint64_t moment;  // calls of hold_runaways before; the same on every rank
    rigid::BodyId id;
    std::string text;
  };
  std::optional<BodyFault> body_;
  struct FluidFault {
    double speed;
    std::uint64_t cell;  // by its global index
    std::string text;
  };
  std::optional<FluidFault> fluid_;
  struct OverlapFault {
    std::uint64_t moment;
    double share;  // of the half-width
    rigid::BodyId a;
    std::string text;
  };
  std::optional<OverlapFault> overlap_;
  std::uint64_t moment_ = 0;
  struct Ranks {  // that have seen one
    std::int64_t fluid, body, overlap;
  };
  parallel::SumsUnderWay<Ranks> sums_;
};

}  // namespace silt::coupler
