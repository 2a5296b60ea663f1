#pragma once
// Force evaluation (Algorithm 2, lines 9-11): passes over the cut links, in which surfaces return populations
// to the fluid, and the fluid acts on bodies by momentum exchange (method.md, equations 22 and 33), summed in
// fixed point. coupling_in_time.hpp moves bodies by the sums, covered_momentum.hpp has the form `exact`.
//
// The state consists of bodies (with stored impulses and debts) and populations only.
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
#include "coupler/spec/flow_spec.hpp"
#include "lbm/fluid.hpp"

namespace silt::coupler {

/// Thrown if the sum over the links of a body or wall is NaN or beyond the range of the fixed point.
struct ForceOutOfRange : std::overflow_error {
  explicit ForceOutOfRange(rigid::BodyId);
  rigid::BodyId on;
};

/// The result of one step for this rank's links.
struct LinkOutcome {
  static constexpr rigid::BodyId nobody = std::numeric_limits<rigid::BodyId>::max();
  rigid::BodyId out_of_range = nobody;  // the least id of bodies with sums out of range
  // force and torque on the walls, by row, torque about their positions, in lbm::link_quantum
  std::vector<std::array<std::int64_t, 6>> wall_loads;
  rigid::FixedVec3 debts_begun;  // of new bodies owned here, form `exact` only
};

template <class T>
class FluidForces {
 public:
  /// substeps: number of sub-steps of the bodies.
  FluidForces(const CouplingSpec&, ParallelBodyExchange&, int substeps, double relaxation_time);

  /// Collective, before the first step: sets the impulse debts to the initial momentum of the bodies' cells.
  void start(std::span<const BlockMap>, rigid::BodySet&);
  /// Adds momentum that a body gained through a cell that it covered or uncovered (form `exact` only).
  void add_covered(rigid::BodyId id, const rigid::Vec3& momentum, const rigid::Vec3& arm) {
    covered_.add(id, momentum, arm);
  }

  // ---- a step ----
  /// Sets the velocities of surfaces before the fluid's pass. Bodies and changes stay until finish().
  void begin(const lbm::Fluid<T>&, std::span<const BlockMap>, std::span<BlockLinks<T>>, rigid::BodySet&,
             const BodyChanges&);
  /// Applies inner groups of a block, whose cells have collided, and solves for bodies with all links applied
  /// (on a device finish() does). `at_hand`: the populations are in cache.
  void apply_inner(lbm::Block<T>&, BlockLinks<T>&, GroupRange, bool at_hand);
  /// Applies the other links and solves for the other bodies, after the halo exchange, with messages between
  /// ranks that hold a body. Sums out of range are left out; the step is then invalid.
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
  ParallelBodyExchange& exchange_;
  CouplingInTime time_;
  CoveredMomentum covered_;
  const lbm::Domain* domain_ = nullptr;  // this and the following members: of the current step
  rigid::BodySet* bodies_ = nullptr;
  const BodyChanges* changes_ = nullptr;
  LinkOutcome outcome_;
  RowSums sums_;
  lbm::ListedLinks listed_;  // scratch
};

}  // namespace silt::coupler
