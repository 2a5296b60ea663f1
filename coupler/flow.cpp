#include "coupler/flow.hpp"

#include <optional>
#include <tuple>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/exchange/parallel_body_exchange.hpp"
#include "coupler/flow_control.hpp"
#include "coupler/flow_links.hpp"
#include "coupler/forces/covered_momentum.hpp"
#include "coupler/forces/entrained_fluid.hpp"
#include "coupler/forces/fluid_forces.hpp"
#include "coupler/heat/heat_flow.hpp"
#include "coupler/mapping/mapping_poses.hpp"
#include "coupler/mapping/refill.hpp"
#include "coupler/regions/level_views.hpp"
#include "lbm/levels/levels.hpp"
#include "parallel/communicator.hpp"

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

namespace {

lbm::CollisionSpec collision_of(const FluidSpec& f) {
  constexpr double smagorinsky = 0.1;  // of `regularised`: least viscosity is that of an eddy
  return {f.relaxation_time,
          f.magic,
          f.collision,
          {f.body_force[0], f.body_force[1], f.body_force[2]},
          smagorinsky};
}

template <class T>
std::vector<lbm::CellBox> boxes(const lbm::Fluid<T>& fluid) {
  std::vector<lbm::CellBox> all;
  for (const auto& b : fluid.blocks()) all.push_back(b.box());
  return all;
}

template <class T>
class FlowOf final : public Flow {
 public:
  FlowOf(const FlowSpec& spec, const lbm::Domain& domain, MPI_Comm comm, ParallelBodyExchange& exchange,
         int substeps, const Flow* before)
      : fluid_(domain, collision_of(*spec.fluid), comm, spec.device,
               before ? &static_cast<const FlowOf&>(*before).fluid_ : nullptr),
        heat_(spec.heat ? std::make_unique<HeatFlow<T>>(*spec.heat, spec.boundary, fluid_, exchange)
                        : nullptr),
        levels_(fluid_, spec.coarsening ? spec.coarsening->levels : 0,
                heat_ ? &heat_->temperature() : nullptr,
                before ? &static_cast<const FlowOf&>(*before).levels_ : nullptr),
        map_(fluid_.domain(), exchange.world(), boxes(fluid_), lbm::link_reach(spec.coupling.wall_scheme)),
        fields_(make_fields<T>(fluid_, map_.blocks(), levels_.heat(0))),
        account_(*fields_, comm),
        extent_(exchange.extent()),
        links_(spec.coupling, exchange.world(), fluid_, map_),
        drive_(spec, comm),
        forces_(spec.coupling, exchange, substeps, spec.fluid->relaxation_time),
        turning_walls_(exchange.world()) {
    for (int level = 1; level < levels_.count(); ++level) {
      coarser_.push_back(
          std::make_unique<CoarserFields>(levels_.fluid(level), levels_.heat(level), exchange.world()));
      account_.add_level(*coarser_.back()->fields);
    }
  }

  int levels() const override { return levels_.count(); }
  FluidFields& fields(int level) override {
    complete_cells();
    return own_fields(level);
  }
  std::optional<FluidFields::Fast> too_fast(int level) override { return own_fields(level).too_fast(); }
  double seconds(int level) const override { return levels_.seconds()[level]; }
  FlowAccount& account() override { return account_; }
  std::int64_t heat_of_wall(std::size_t wall) const override { return heat_ ? heat_->heat_of_wall(wall) : 0; }

  void drive(std::int64_t step) override {
    if (FlowControl* const of = control(); of && of->is_due(step)) of->look(step, fields_->sums());
    take_drive(static_cast<double>(step));
  }
  FlowControl* control() override { return drive_.control ? &*drive_.control : nullptr; }

  void map_bodies(rigid::BodySet& bodies, const BodyChanges& changes) override {
    cells_changed();
    if (!holds_bodies_) renew_mapping_poses(bodies, links_.world(), extent_, links_.spec(), fluid_.passes());
    map_(bodies);
    if (heat_) heat_->begin_step(bodies);
    std::uint64_t covered = 0, uncovered = 0;
    if (map_.changed()) std::tie(covered, uncovered) = remap(bodies, changes);
    if (is_exact() && parallel::rank_of(fluid_.comm()) == 0)
      for (const TurningWalls::Impulse& mean : turning_walls_.impulses(bodies))
        forces_.add_covered(mean.wall, mean.momentum, mean.arm);
    account_.set_mapping({covered, uncovered, links_.count()});
    if (drive_.pushes_bodies) push_bodies(bodies);  // before any body is solved for
    apply_pending_impacts(bodies);
    forces_.begin(fluid_, map_.blocks(), links_.blocks(), bodies, changes);
  }
  void stream_collide(StepClock& clock) override {
    account_.begin_pass();
    cells_changed();
    levels_.begin_step();
    if (links_.world().shapes.empty() || !fluid_.is_in_parts()) return levels_.stream_collide();
    fluid_.begin_pass();
    for (int b = 0; b < links_.count_blocks(); ++b)
      for (int part = 0; part < fluid_.parts(b); ++part) {
        fluid_.collide(b, part);
        levels_.after_part(b, part);
        const GroupRange ready = links_[b].inner_after(part);
        if (!ready.empty()) clock.timed(Stage::force_evaluation, [&] { apply_inner(b, ready); });
      }
    fluid_.end_pass();
  }
  void communicate() override {
    turned_.give(fluid_);
    fluid_.exchange();
    levels_.end_step();
    links_.exchange_pairs();
  }
  void evaluate_forces(rigid::BodySet& bodies) override {
    cells_changed();
    if (!fluid_.is_in_parts())
      for (int b = 0; b < links_.count_blocks(); ++b) apply_inner(b, links_[b].all_inner());
    if (heat_) heat_->exchange_heat(links_.blocks(), bodies);  // before corrections change surfaces' motions
    account_.end_step(forces_.finish(fluid_, links_.blocks(), bodies));
  }

  void hold_bodies(bool hold) override {
    holds_bodies_ = hold;
    if (hold) return;
    account_.begin_pass();  // completes the sums of the last step
    account_.set_mass_taken(0);
    levels_.set_passes(0);
    levels_.set_seconds(std::vector<double>(levels()));
  }

  void resume(std::int64_t step, rigid::FixedSum mass_taken) override {
    account_.set_mass_taken(mass_taken);
    levels_.set_passes(step);
    resumed_ = true;
  }
  void take_over(const Flow& other) override {
    const auto& from = static_cast<const FlowOf&>(other);
    from.complete_cells();
    lbm::move_populations(from.levels_, levels_);
    account_.take_over(from.account_);
    levels_.set_passes(from.fluid_.passes());
    levels_.set_seconds(from.levels_.seconds());
    if (auto& control = drive_.control)
      control->set_state(from.drive_.control->state(), from.drive_.control->looked_at());
    resumed_ = true;
  }
  void start(rigid::BodySet& bodies) override {
    map_(bodies);
    for (const auto& coarser : coarser_) coarser->map.map_walls(bodies);
    rebuild_links(bodies);
    account_.set_mapping({0, 0, links_.count()});
    cells_changed();
    if (resumed_) return;
    forces_.start(map_.blocks(), bodies);
  }

 private:
  /// The map and fields of a coarser lattice, which has no bodies.
  struct CoarserFields {
    MapBodies map;
    std::unique_ptr<FluidFields> fields;
    CoarserFields(lbm::Fluid<T>& fluid, lbm::Temperature<T>* heat, const rigid::World& world)
        : map(fluid.domain(), world, boxes(fluid), 0), fields(make_fields<T>(fluid, map.blocks(), heat)) {}
  };

  /// Sets the body force of a time, and side velocities half a step later, when fluid meets the sides.
  void take_drive(double time) {
    for (int side = 0; side < 6; ++side) {
      const BoundarySpec& of = drive_.sides[side];
      if (!of.over_time.varies()) continue;
      const Vec3 u = of.velocity_at(time + 0.5);
      fluid_.set_side_velocity(side, {u[0], u[1], u[2]});
    }
    const std::optional<Vec3> f = drive_.force_at(time);
    if (!f) return;
    cells_changed();
    fluid_.set_force({(*f)[0], (*f)[1], (*f)[2]});
    links_.take_force();
  }

  FluidFields& own_fields(int level) { return level == 0 ? *fields_ : *coarser_[level - 1]->fields; }
  void cells_changed() {
    for (int level = 0; level < levels(); ++level) own_fields(level).changed();
    fluid_.forget_given_up();
  }
  /// Makes all cells give up their excess before their values are read; in a step collisions do that.
  void complete_cells() const { fluid_.take_and_keep_excess(); }
  void apply_inner(int b, GroupRange groups) {
    forces_.apply_inner(fluid_.blocks()[b], links_[b], groups, fluid_.is_in_parts());
  }

  /// Handles cells that turned solid or fluid, whose numbers it returns, and rebuilds links.
  std::pair<std::uint64_t, std::uint64_t> remap(const rigid::BodySet& bodies, const BodyChanges& changes) {
    const ChangedCells cells = changed_cells(map_.blocks());
    take_cells(+1, cells.covered, bodies, changes);
    turned_.refill(fluid_, map_.blocks(), cells, bodies, changes.gone);
    if (heat_) heat_->change_cells(map_.blocks(), cells, bodies);
    take_cells(-1, cells.uncovered, bodies, changes);
    account_.take_mass(turned_.weigh(fluid_, map_.blocks()));
    rebuild_links(bodies);
    return {cells.covered.size(), cells.uncovered.size()};
  }

  bool is_exact() const { return links_.spec().force == ForceForm::exact; }

  /// Accounts for the momentum of cells that bodies have covered (sign 1) or uncovered (-1).
  void take_cells(int sign, const std::vector<CoveredCell>& cells, const rigid::BodySet& bodies,
                  const BodyChanges& changes) {
    if (!is_exact() && changes.none()) return;
    const std::span<const lbm::Moments> moments = fluid_.moments(places(cells));
    for (std::size_t n = 0; n < cells.size(); ++n) take_cell(sign, cells[n], moments[n], bodies, changes);
  }
  void take_cell(int sign, const CoveredCell& c, const lbm::Moments& m, const rigid::BodySet& bodies,
                 const BodyChanges& changes) {
    const bool comes_or_goes = sign > 0 ? changes.is_new(c.body->id) : changes.has_gone(c.body->id);
    if (!is_exact() && !comes_or_goes) return;
    const auto u = fluid_.velocity(m);
    const Vec3 momentum = sign * Vec3(u[0], u[1], u[2]);
    if (comes_or_goes) return account_.bring(-momentum);
    const std::size_t row = bodies.row_of(c.body->id);
    if (!is_exact() || row >= bodies.size()) return;
    const Int3 cell = map_.blocks()[c.block].box.lower + c.cell;
    const Vec3 arm = nearest_arm(fluid_.domain(), bodies.position[row], cell);
    const bool is_wall = row >= bodies.first_wall();  // walls have no impulse debt
    const Vec3 own = is_wall ? Vec3(sign * bodies.velocity_at(row, arm)) : Vec3(Vec3::Zero());
    forces_.add_covered(c.body->id, momentum - own, arm);
  }

  /// Adds the force of the pressure gradient that the body force stands for: that on the displaced fluid.
  /// (Fixed bodies are held against it.)
  void push_bodies(rigid::BodySet& bodies) const {
    const auto& f = fluid_.spec().force;
    const Vec3 force(f[0], f[1], f[2]);
    for (std::size_t row = 0; row < bodies.owned; ++row)
      if (bodies.is_dynamic(row)) bodies.add_force(row, bodies.displaced_mass(row) * force);
  }

  void rebuild_links(const rigid::BodySet& bodies) {
    links_.rebuild(bodies, [&](int b) {
      if (heat_) heat_->list_links(b, map_.blocks()[b], links_[b]);
    });
    if (heat_) heat_->find_pockets(map_.blocks(), bodies);
  }

  mutable lbm::Fluid<T> fluid_;        // finest level
  std::unique_ptr<HeatFlow<T>> heat_;  // null: the case has no [heat]
  lbm::Levels<T> levels_;              // all levels
  MapBodies map_;
  std::unique_ptr<FluidFields> fields_;
  std::vector<std::unique_ptr<CoarserFields>> coarser_;
  FlowAccount account_;
  rigid::Extent extent_;
  FlowLinks<T> links_;
  TurnedCells<T> turned_{fluid_.device()};  // of the last mapping
  mutable FlowDrive drive_;
  FluidForces<T> forces_;
  TurningWalls turning_walls_;
  bool resumed_ = false;
  bool holds_bodies_ = false;
};

}  // namespace

lbm::Domain make_domain(const FlowSpec& spec, int ranks) {
  const auto sides = sides_of(spec);
  std::optional<Int3> blocks;
  if (spec.block_cells) blocks = Int3{(*spec.block_cells)[0], (*spec.block_cells)[1], (*spec.block_cells)[2]};
  if (spec.coarsening) return lbm::Domain(cut_for_levels(spec, ranks), sides, ranks);
  return lbm::Domain({spec.cells[0], spec.cells[1], spec.cells[2]}, sides, blocks, ranks);
}

std::unique_ptr<Flow> make_flow(const FlowSpec& spec, const lbm::Domain& domain, MPI_Comm comm,
                                ParallelBodyExchange& exchange, int substeps, const Flow* before) {
  if (spec.fluid->precision == Precision::single_)
    return std::make_unique<FlowOf<float>>(spec, domain, comm, exchange, substeps, before);
  return std::make_unique<FlowOf<double>>(spec, domain, comm, exchange, substeps, before);
}

}  // namespace silt::coupler
