#include "coupler/flow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "coupler/balance/body_work.hpp"
#include "coupler/case/case.hpp"
#include "coupler/exchange/parallel_body_exchange.hpp"
#include "coupler/forces/entrained_fluid.hpp"
#include "coupler/forces/fluid_forces.hpp"
#include "coupler/mapping/body_changes.hpp"
#include "coupler/mapping/build_links.hpp"
#include "coupler/mapping/map_bodies.hpp"
#include "coupler/mapping/mapping_poses.hpp"
#include "coupler/mapping/refill.hpp"
#include "coupler/mapping/side_columns.hpp"
#include "coupler/side_force.hpp"
#include "coupler/state_hash.hpp"
#include "lbm/cut_links.hpp"
#include "lbm/move_populations.hpp"
#include "lbm/pairs_across.hpp"
#include "parallel/collectives.hpp"
#include "parallel/sums_under_way.hpp"

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

namespace {

lbm::CollisionSpec collision_of(const FluidSpec& f) {
  return {f.relaxation_time,
          f.magic,
          f.collision,
          {f.body_force[0], f.body_force[1], f.body_force[2]},
          f.smagorinsky};
}

/// Where fluid may come and go, its mass is not to be kept.
bool is_open(const Case& scene) {
  return std::any_of(scene.boundary.begin(), scene.boundary.end(), [](const BoundarySpec& b) {
    return b.kind == BoundaryKind::pressure_outlet || b.kind == BoundaryKind::velocity_inlet;
  });
}

template <class T>
std::vector<lbm::CellBox> boxes(const lbm::Fluid<T>& fluid) {
  std::vector<lbm::CellBox> all;
  for (const auto& b : fluid.blocks()) all.push_back(b.box());
  return all;
}

/// What the step leaves for the next one to begin with, summed over the ranks.
struct StepSums {
  std::int64_t ranks_out_of_range;  // that have a body whose sums are
  std::int64_t cells_gained;
  parallel::WideSum link_mass, cell_mass;  // gained
  struct Recount {                         // of all fluid, in some steps
    std::int64_t ranks = 0, cells = 0;
    parallel::WideSum quanta;
    Recount() = default;
    Recount(const FluidMass& m) : ranks(1), cells(std::int64_t(m.cells)), quanta(m.mass) {}
    FluidMass mass() const { return {std::uint64_t(cells), quanta.value()}; }
  } recount;
};

template <class T>
class FlowOf final : public Flow {
 public:
  FlowOf(const Case& scene, const lbm::Domain& domain, MPI_Comm comm, const ParallelBodyExchange& exchange)
      : Flow(collision_of(*scene.fluid).force),
        coupling_(scene.coupling),
        world_(exchange.world()),
        fluid_(domain, collision_of(*scene.fluid), comm),
        map_(fluid_.domain(), world_, boxes(fluid_), lbm::link_reach(coupling_.wall_scheme)),
        links_(fluid_.blocks().size()),
        pushes_bodies_(scene.fluid->body_force_on_bodies && !scene.fluid->body_force.isZero(0)),
        forces_(coupling_, exchange, scene.contacts.substeps, scene.fluid->relaxation_time),
        corrects_mass_(coupling_.mass_correction && scene.has_surfaces() && !is_open(scene)) {
    if (!lbm::reads_beyond(coupling_.wall_scheme) || world_.shapes.empty()) return;
    pairs_.emplace(fluid_.domain(), comm, fluid_.blocks());
    for (const BlockMap& map : map_.blocks()) columns_.emplace_back(map.solid);
    for (std::size_t b = 0; b < links_.size(); ++b) links_[b].pairs_across = pairs_->of(int(b));
  }

  void map_bodies(rigid::BodySet& bodies, const BodyChanges& changes) override {
    counted_.reset();
    renew_mapping_poses(bodies, world_, coupling_, fluid_.passes());
    map_(bodies);
    counts_.covered = counts_.uncovered = 0;
    if (map_.changed()) remap(bodies, changes);
    if (pushes_bodies_) push_bodies(bodies);  // before any body is solved for
    give_pending_impacts(bodies);
    forces_.begin(fluid_, map_.blocks(), links_, bodies, changes);
  }
  void stream_collide(StepClock& clock) override {
    settle();
    counted_.reset();
    if (corrects_mass_) fluid_.set_mass_correction(correction_.take_surplus());
    if (world_.shapes.empty()) return fluid_.stream_collide();
    fluid_.stream_collide([&](int b, int part) {
      if (forces_.waiting(links_[b], part))
        clock.timed(Stage::force_evaluation,
                    [&] { forces_.after_part(fluid_.blocks()[b], links_[b], part); });
    });
  }
  void communicate() override {
    fluid_.exchange();
    if (pairs_) pairs_->exchange(fluid_.blocks(), fluid_.parity());
  }

  void evaluate_forces(rigid::BodySet& bodies) override {
    stepped_ = true;
    counted_.reset();
    leave_under_way(forces_.finish(fluid_, links_, bodies));
  }

  const lbm::Domain& domain() const override { return fluid_.domain(); }
  int blocks() const override { return int(fluid_.blocks().size()); }
  const lbm::CellBox& block(int b) const override { return fluid_.blocks()[b].box(); }
  const CellBits& solid(int b) const override { return map_.blocks()[b].solid; }
  lbm::Moments moments(int b, Int3 x) const override { return fluid_.moments(b, x); }
  void moments(int b, Int3 first, int cells, lbm::MomentsRow& row) const override {
    fluid_.moments(b, first, cells, row);
  }
  std::optional<Fast> too_fast() const override {
    const auto order = [](const Fast& f) { return std::tuple(-f.speed, f.cell.z, f.cell.y, f.cell.x); };
    std::optional<Fast> first;
    for (const auto& found : fluid_.fast_cells()) {
      if (!is_fluid(found.block, found.cell)) continue;
      const double speed = std::isnan(found.speed) ? std::numeric_limits<double>::infinity() : found.speed;
      const Fast here{block(found.block).lower + found.cell, speed};
      if (!first || order(here) < order(*first)) first = here;
    }
    return first;
  }
  void set_equilibrium(int b, Int3 x, double rho, const std::array<double, 3>& u) override {
    counted_.reset();
    fluid_.set_equilibrium(b, x, rho, u);
  }
  double arriving(int b, Int3 x, int i) const override { return fluid_.arriving(b, x, i); }
  void set_arriving(int b, Int3 x, int i, double g) override {
    counted_.reset();
    fluid_.arriving(b, x, i) = T(g);
  }
  std::size_t bytes() const override { return fluid_.bytes(); }
  MappingCounts mapping() const override { return counts_; }
  const MassCorrectionState& mass_correction() const override {
    settle();
    return correction_.state();
  }
  void set_mass_correction(const MassCorrectionState& state) override {
    correction_.set_state(state);
    fluid_.set_passes(state.steps);
    restarted_ = true;
  }

  void start(rigid::BodySet& bodies) override {
    counted_.reset();
    map_(bodies);
    rebuild_links(bodies);
    if (restarted_) return;
    forces_.start(map_.blocks(), bodies);
    if (!corrects_mass_) return;
    const auto all =
        parallel::sum_over_ranks(fluid_.comm(), StepSums::Recount(fluid_mass<T>(fluid_, map_.blocks())));
    correction_.recount(all.mass());
  }

  void take_over(const Flow& other) override {
    counted_.reset();
    lbm::move_populations(static_cast<const FlowOf&>(other).fluid_, fluid_);
    brought_ = other.momentum_brought();
    set_mass_correction(other.mass_correction());
    fluid_.set_passes(static_cast<const FlowOf&>(other).fluid_.passes());
  }
  void add_work(const rigid::BodySet& bodies, const WorkCosts& costs, WorkMap& work) const override {
    for (const BlockMap& map : map_.blocks()) add_mapped(map, bodies, world_, costs, work);
  }

  FlowTotals totals() const override {
    settle();
    return counted().over_ranks(fluid_.comm());
  }
  std::uint64_t hash() const override { return hash_fluid<T>(fluid_, map_.blocks()); }
  std::array<rigid::FixedSum, 3> side_force(int axis, bool upper) const override {
    return coupler::side_force<T>(fluid_, map_.blocks(), axis, upper);
  }
  rigid::FixedVec3 momentum_brought() const override {
    rigid::FixedVec3 all = brought_;
    all.add(forces_.debts_begun());
    return all;
  }
  std::array<std::int64_t, 6> wall_load(std::size_t wall) const override {
    return stepped_ ? forces_.wall_load(wall) : std::array<std::int64_t, 6>{};
  }

 private:
  /// The cells of this rank, added up once between two changes.
  const FlowSums& counted() const {
    if (!counted_) counted_ = flow_sums<T>(fluid_, map_.blocks());
    return *counted_;
  }

  /// Starts the sums that the next step begins with.
  void leave_under_way(const LinkOutcome& links) {
    out_of_range_ = links.out_of_range;
    const MassCorrection::Gain gain = correction_.take_gain(links.mass_gain);
    StepSums mine{links.out_of_range != LinkOutcome::nobody, gain.cells, gain.link_mass, gain.cell_mass, {}};
    if (corrects_mass_ && correction_.recount_is_due()) mine.recount = fluid_mass<T>(fluid_, map_.blocks());
    sums_.start(fluid_.comm(), mine);
  }

  /// Takes what the last step left under way.
  void settle() const {
    if (!sums_.under_way()) return;
    const StepSums& all = sums_.finish();
    if (all.ranks_out_of_range > 0)
      throw ForceOutOfRange(parallel::least_over_ranks(fluid_.comm(), out_of_range_));
    if (!corrects_mass_) return;
    correction_.end_step({all.link_mass.value(), all.cell_mass.value(), all.cells_gained});
    if (all.recount.ranks > 0) correction_.recount(all.recount.mass());
  }

  /// Cells that changed sides, and links.
  void remap(const rigid::BodySet& bodies, const BodyChanges& changes) {
    const ChangedCells cells = changed_cells(map_.blocks());
    for_fetched(cells.covered, [&](const CoveredCell& c) { take_covered(c, bodies, changes); });
    refill(fluid_, map_.blocks(), cells, bodies, changes.gone, coupling_.refill);
    for (const CoveredCell& c : cells.uncovered) take_uncovered(c, bodies, changes);
    counts_.covered = cells.covered.size(), counts_.uncovered = cells.uncovered.size();
    rebuild_links(bodies);
  }

  /// Visits cells whose populations are asked for a few cells ahead.
  template <class Visit>
  void for_fetched(const std::vector<CoveredCell>& cells, Visit&& visit) const {
    constexpr std::size_t ahead = 8;
    for (std::size_t n = 0; n < cells.size(); ++n) {
      if (n + ahead < cells.size()) fluid_.prefetch(cells[n + ahead].block, cells[n + ahead].cell);
      visit(cells[n]);
    }
  }

  bool is_exact() const { return coupling_.force == ForceForm::exact; }

  void take_covered(const CoveredCell& c, const rigid::BodySet& bodies, const BodyChanges& changes) {
    const bool is_new = changes.is_new(c.body->id);
    if (!corrects_mass_ && !is_exact() && !is_new) return;
    const lbm::Moments m = fluid_.moments(c.block, c.cell);
    if (corrects_mass_) correction_.cell_covered(m.density_deviation);
    if (is_new)
      bring(m, -1);
    else if (is_exact())
      give_momentum(c, bodies, m, +1);
  }
  void take_uncovered(const CoveredCell& c, const rigid::BodySet& bodies, const BodyChanges& changes) {
    const bool has_gone = changes.has_gone(c.body->id);
    if (!corrects_mass_ && !is_exact() && !has_gone) return;
    const lbm::Moments m = fluid_.moments(c.block, c.cell);
    if (corrects_mass_) correction_.cell_uncovered(m.density_deviation);
    if (has_gone)
      bring(m, +1);
    else if (is_exact())
      give_momentum(c, bodies, m, -1);
  }
  void bring(const lbm::Moments& m, int sign) {
    const auto u = fluid_.velocity(m);
    brought_.add(sign * Vec3(u[0], u[1], u[2]));
  }

  /// The body gains (sign 1) or loses (-1) the momentum of a cell.
  void give_momentum(const CoveredCell& c, const rigid::BodySet& bodies, const lbm::Moments& m, int sign) {
    if (!c.body) return;
    const std::size_t row = bodies.row_of(c.body->id);
    if (row >= bodies.size()) return;
    const Int3 cell = map_.blocks()[c.block].box.lower + c.cell;
    const auto u = fluid_.velocity(m);
    forces_.add_covered(c.body->id, sign * Vec3(u[0], u[1], u[2]),
                        nearest_arm(fluid_.domain(), bodies.position[row], cell));
  }

  /// What drives the fluid stands for a pressure gradient, which pushes a body with the force on the fluid it
  /// displaces. (A fixed body is held against it.)
  void push_bodies(rigid::BodySet& bodies) const {
    const auto& f = fluid_.spec().force;
    const Vec3 force(f[0], f[1], f[2]);
    for (std::size_t row = 0; row < bodies.owned; ++row)
      if (bodies.is_dynamic(row)) bodies.add_force(row, bodies.displaced_mass(row) * force);
  }

  void rebuild_links(const rigid::BodySet& bodies) {
    const lbm::WallFluid<T> fluid(fluid_.spec());
    counts_.links = 0;
    for (std::size_t b = 0; b < links_.size(); ++b) {
      const BlockMap& map = map_.blocks()[b];
      BlockLinks<T>& block = links_[b];
      if (map.changed) {
        fluid_.set_idle(int(b), !map.has_fluid());
        build_links<T>(map, world_, bodies, {coupling_, fluid, fluid_.pass_order(int(b)), &meshes_},
                       block.surfaces);
        block.order_groups(fluid_.pass_order(int(b)));
        if (lbm::knows_opposite_wall(coupling_.wall_scheme))
          block.gaps.pair(block.surfaces, fluid_.domain(), map.box);
      }
      counts_.links += block.count;
    }
    if (pairs_) choose_pairs();
  }

  void choose_pairs() {
    for (std::size_t b = 0; b < columns_.size(); ++b)
      if (map_.blocks()[b].changed) columns_[b].reset(map_.blocks()[b].solid);
    pairs_->choose([&](int b, Int3 x, int axis) {
      const CellBits& solid = map_.blocks()[b].solid;
      return axis == 1 ? columns_[b].from(solid, x.x, x.y, x.z) : solid.from(x.x, x.y, x.z);
    });
  }

  CouplingSpec coupling_;
  const rigid::World& world_;
  lbm::Fluid<T> fluid_;
  MapBodies map_;
  std::vector<BlockLinks<T>> links_;
  MeshDistances meshes_{map_.meshes()};
  std::optional<lbm::PairsAcross<T>> pairs_;  // under schemes that read beyond
  std::vector<SideColumns> columns_;          // of the blocks, for pairs_
  bool pushes_bodies_;
  FluidForces<T> forces_;
  MappingCounts counts_;
  rigid::FixedVec3 brought_;  // by bodies that came and went: momentum of cells
  bool corrects_mass_, restarted_ = false, stepped_ = false;
  // settled whenever one of them is asked for
  mutable MassCorrection correction_;
  mutable parallel::SumsUnderWay<StepSums> sums_;
  mutable std::optional<FlowSums> counted_;
  rigid::BodyId out_of_range_ = LinkOutcome::nobody;  // of this rank, in the last step
};

lbm::SideCondition side_condition(const BoundarySpec& b) {
  lbm::SideCondition s;
  switch (b.kind) {
    case BoundaryKind::periodic:
      s.kind = lbm::SideKind::periodic;
      break;
    case BoundaryKind::free_slip:
      s.kind = lbm::SideKind::free_slip;
      break;
    case BoundaryKind::pressure_outlet:
      s.kind = lbm::SideKind::pressure;
      break;
    case BoundaryKind::no_slip:
    case BoundaryKind::moving:
    case BoundaryKind::velocity_inlet:
      s.kind = lbm::SideKind::bounce;
  }
  s.velocity = {b.velocity[0], b.velocity[1], b.velocity[2]};
  s.density_deviation = b.density - 1;
  return s;
}

}  // namespace

lbm::Domain make_domain(const Case& scene, int ranks) {
  std::array<lbm::SideCondition, 6> sides;
  for (int s = 0; s < 6; ++s) sides[s] = side_condition(scene.boundary[s]);
  std::optional<Int3> blocks;
  if (scene.block_cells)
    blocks = Int3{(*scene.block_cells)[0], (*scene.block_cells)[1], (*scene.block_cells)[2]};
  return lbm::Domain({scene.cells[0], scene.cells[1], scene.cells[2]}, sides, blocks, ranks);
}

std::unique_ptr<Flow> make_flow(const Case& scene, const lbm::Domain& domain, MPI_Comm comm,
                                const ParallelBodyExchange& exchange) {
  if (scene.fluid->precision == Precision::single_)
    return std::make_unique<FlowOf<float>>(scene, domain, comm, exchange);
  return std::make_unique<FlowOf<double>>(scene, domain, comm, exchange);
}

}  // namespace silt::coupler
