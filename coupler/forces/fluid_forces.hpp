#pragma once
// Force evaluation (Algorithm 2, lines 9-11): the passes over the cut links, in which surfaces return
// populations to the fluid and the fluid acts on the bodies by momentum exchange (method.md, equations 22
// and 33), summed in fixed point. How the sums move a body is in coupling_in_time.hpp; covered_momentum.hpp
// has what the form `exact` adds.
//
// There is no history besides the state of bodies (with their stored impulses and debts) and populations.
#include <array>
#include <limits>
#include <span>
#include <stdexcept>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/exchange/parallel_body_exchange.hpp"
#include "coupler/forces/coupling_in_time.hpp"
#include "coupler/forces/covered_momentum.hpp"
#include "coupler/forces/row_sums.hpp"
#include "coupler/mapping/block_links.hpp"
#include "coupler/spec/coupling_spec.hpp"
#include "lbm/fluid.hpp"

namespace silt::coupler {

/// ForceOutOfRange says that the sums of the links of a body or wall are no numbers, or beyond the range of
/// the fixed point.
struct ForceOutOfRange : std::overflow_error {
  explicit ForceOutOfRange(rigid::BodyId);
  rigid::BodyId on;
};

/// The outcome of one step of this rank's links.
struct LinkOutcome {
  static constexpr rigid::BodyId nobody = std::numeric_limits<rigid::BodyId>::max();
  rigid::BodyId out_of_range = nobody;  // the least id of bodies whose sums are
  // force and torque on the walls, by their rows, torque about their positions, in lbm::link_quantum
  std::vector<std::array<std::int64_t, 6>> wall_loads;
  rigid::FixedVec3 debts_begun;  // of bodies owned here that came, form `exact` only
};

template <class T>
class FluidForces {
 public:
  /// `substeps` are those of the bodies' step.
  FluidForces(const CouplingSpec&, const ParallelBodyExchange&, int substeps, double relaxation_time);

  /// Collective, before the first step of all: the impulse debts become what the bodies' cells hold at the
  /// start.
  void start(std::span<const BlockMap>, rigid::BodySet&);
  /// A body gains momentum through a cell that it covered or left (form `exact` only).
  void add_covered(rigid::BodyId id, const rigid::Vec3& momentum, const rigid::Vec3& arm) {
    covered_.add(id, momentum, arm);
  }

  // ---- a step ----
  /// Sets the velocities with which surfaces return; before the fluid's pass. The bodies and their changes
  /// stay where they are in memory until the step's last call.
  void begin(const lbm::Fluid<T>&, std::span<const BlockMap>, std::span<BlockLinks<T>>, rigid::BodySet&,
             const BodyChanges&);
  /// Applies inner groups of a block, all of whose cells have collided, and solves for bodies all of whose
  /// links have been applied; on a device finish() does. `at_hand`: the dense pass has just come by, so the
  /// populations are in a cache.
  void apply_inner(lbm::Block<T>&, BlockLinks<T>&, GroupRange, bool at_hand);
  /// Applies all other links and solves for all other bodies, after the halo exchange, with messages between
  /// ranks that hold a body. What is out of range is left out of the sums: its step means nothing.
  const LinkOutcome& finish(lbm::Fluid<T>&, std::span<BlockLinks<T>>, rigid::BodySet&);

 private:
  void apply(lbm::Block<T>&, const BlockLinks<T>&, SurfaceLinks<T>&, const lbm::LinkGroup&,
             const lbm::NextGroup<T>&, bool at_hand);
  void prefetch_row(const SurfaceLinks<T>&);
  void finish_body(lbm::Block<T>&, const BlockLinks<T>&, SurfaceLinks<T>&);
  void apply_rims(lbm::Fluid<T>&, std::span<BlockLinks<T>>);
  void gather(std::span<const BlockLinks<T>>, const rigid::BodySet&);
  void move(lbm::Fluid<T>&, std::span<BlockLinks<T>>, rigid::BodySet&);
  void correct(lbm::Block<T>&, BlockLinks<T>&, const rigid::BodySet&, std::span<const double> corrections);
  void share(rigid::BodySet&, std::span<double> corrections) const;

  bool is_exact() const { return spec_.force == ForceForm::exact; }
  void settle(rigid::BodySet&, std::size_t row);
  Vec6 motion_of_links(rigid::BodySet&, std::size_t row) const;
  void owe(rigid::BodySet&, std::size_t row, const Vec6& motion) const;

  CouplingSpec spec_;
  const ParallelBodyExchange& exchange_;
  CouplingInTime time_;
  CoveredMomentum covered_;
  const lbm::Domain* domain_ = nullptr;  // of the step under way, as what follows
  rigid::BodySet* bodies_ = nullptr;
  const BodyChanges* changes_ = nullptr;
  LinkOutcome outcome_;
  RowSums sums_;
  lbm::ListedLinks listed_;  // from one call of apply to the next
};

}  // namespace silt::coupler
