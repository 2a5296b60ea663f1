#include "coupler/flow.hpp"

#include <algorithm>
#include <optional>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/exchange/parallel_body_exchange.hpp"
#include "coupler/flow_control.hpp"
#include "coupler/forces/covered_momentum.hpp"
#include "coupler/forces/entrained_fluid.hpp"
#include "coupler/forces/fluid_forces.hpp"
#include "coupler/heat/heat_flow.hpp"
#include "coupler/mapping/build_links.hpp"
#include "coupler/mapping/cell_bits.hpp"
#include "coupler/mapping/map_bodies.hpp"
#include "coupler/mapping/mapping_poses.hpp"
#include "coupler/mapping/refill.hpp"
#include "coupler/regions/level_views.hpp"
#include "coupler/spec/flow_spec.hpp"
#include "lbm/levels/levels.hpp"
#include "lbm/walls/cut_links.hpp"
#include "lbm/walls/pairs_across.hpp"
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
      : coupling_(spec.coupling),
        world_(exchange.world()),
        fluid_(domain, collision_of(*spec.fluid), comm, spec.device,
               before ? &static_cast<const FlowOf&>(*before).fluid_ : nullptr),
        heat_(spec.heat ? std::make_unique<HeatFlow<T>>(*spec.heat, spec.boundary, fluid_, exchange)
                        : nullptr),
        levels_(fluid_, spec.coarsening ? spec.coarsening->levels : 0,
                heat_ ? &heat_->temperature() : nullptr,
                before ? &static_cast<const FlowOf&>(*before).levels_ : nullptr),
        map_(fluid_.domain(), world_, boxes(fluid_), lbm::link_reach(coupling_.wall_scheme)),
        fields_(make_fields<T>(fluid_, map_.blocks(), levels_.heat(0))),
        account_(*fields_, comm),
        pushes_bodies_(spec.fluid->body_force_on_bodies && spec.fluid->has_body_force()),
        drive_{spec.fluid->body_force, spec.fluid->body_force_over_time, spec.boundary},
        forces_(coupling_, exchange, substeps, spec.fluid->relaxation_time) {
    for (std::size_t b = 0; b < fluid_.blocks().size(); ++b)
      links_.emplace_back(spec.device), mappings_.emplace_back(spec.device);
    if (!fluid_.is_in_parts()) schedule_ = LinkSchedule::sequential;
    if (!spec.fluid->superficial_velocity.isZero(0)) control_.emplace(*spec.fluid, spec.volume(), comm);
    for (int level = 1; level < levels_.count(); ++level) {
      coarser_.push_back(std::make_unique<CoarserFields>(levels_.fluid(level), levels_.heat(level), world_));
      account_.add_level(*coarser_.back()->fields);
    }
    if (!lbm::reads_beyond(coupling_.wall_scheme) || world_.shapes.empty()) return;
    pairs_.emplace(fluid_.domain(), comm, fluid_.blocks(), spec.device);
    for (const BlockMap& map : map_.blocks()) columns_.emplace_back(map.solid);
    for (std::size_t b = 0; b < links_.size(); ++b) links_[b].pairs_across = pairs_->of(int(b));
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
    if (control_ && control_->is_due(step)) control_->look(step, fields_->sums());
    take_drive(static_cast<double>(step));
  }
  FlowControl* control() override { return control_ ? &*control_ : nullptr; }

  void map_bodies(rigid::BodySet& bodies, const BodyChanges& changes) override {
    cells_changed();
    if (!holds_bodies_) renew_mapping_poses(bodies, world_, coupling_, fluid_.passes());
    map_(bodies);
    if (heat_) heat_->begin_step(bodies);
    counts_.covered = counts_.uncovered = 0;
    if (map_.changed()) remap(bodies, changes);
    if (is_exact() && parallel::rank_of(fluid_.comm()) == 0)
      for (const TurningWalls::Impulse& mean : turning_walls_.impulses(bodies))
        forces_.add_covered(mean.wall, mean.momentum, mean.arm);
    account_.set_mapping(counts_);
    if (pushes_bodies_) push_bodies(bodies);  // before any body is solved for
    apply_pending_impacts(bodies);
    forces_.begin(fluid_, map_.blocks(), links_, bodies, changes);
  }
  void stream_collide(StepClock& clock) override {
    account_.begin_pass();
    cells_changed();
    levels_.begin_step();
    if (world_.shapes.empty() || schedule_ == LinkSchedule::sequential) return levels_.stream_collide();
    fluid_.begin_pass();
    for (int b = 0; b < int(links_.size()); ++b)
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
    if (pairs_) pairs_->exchange(fluid_.blocks(), fluid_.parity());
  }
  void evaluate_forces(rigid::BodySet& bodies) override {
    cells_changed();
    if (schedule_ == LinkSchedule::sequential)
      for (int b = 0; b < int(links_.size()); ++b) apply_inner(b, links_[b].all_inner());
    if (heat_) heat_->exchange_heat(links_, bodies);  // before corrections change the motions of surfaces
    account_.end_step(forces_.finish(fluid_, links_, bodies));
  }

  void hold_bodies(bool hold) override {
    holds_bodies_ = hold;
    if (hold) return;
    account_.begin_pass();  // completes the sums of the last step
    account_.set_mass_taken(0);
    levels_.set_passes(0);
    levels_.set_seconds(std::vector<double>(levels()));
  }
  void set_schedule(LinkSchedule schedule) override { schedule_ = schedule; }

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
    if (control_) control_->set_state(from.control_->state(), from.control_->looked_at());
    resumed_ = true;
  }
  void start(rigid::BodySet& bodies) override {
    map_(bodies);
    for (const auto& coarser : coarser_) coarser->map.map_walls(bodies);
    rebuild_links(bodies);
    account_.set_mapping(counts_);
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
    if (!control_ && !drive_.over_time.varies()) return;
    const Vec3 given = drive_.over_time.at(time) * drive_.body_force;
    const Vec3 f = control_ ? control_->force(given) : given;
    cells_changed();
    fluid_.set_force({f[0], f[1], f[2]});
    const lbm::WallFluid<T> fluid(fluid_.spec());
    for (BlockLinks<T>& block : links_)
      for (auto& surface : block.surfaces) surface.links.fluid = fluid;
  }

  FluidFields& own_fields(int level) { return level == 0 ? *fields_ : *coarser_[level - 1]->fields; }
  void cells_changed() {
    for (int level = 0; level < levels(); ++level) own_fields(level).changed();
    fluid_.forget_given_up();
    complete_ = false;
  }
  /// Makes all cells give up their excess before their values are read; in a step collisions do that.
  void complete_cells() const {
    if (!complete_) fluid_.take_and_keep_excess();
    complete_ = true;
  }
  void apply_inner(int b, GroupRange groups) {
    forces_.apply_inner(fluid_.blocks()[b], links_[b], groups, schedule_ == LinkSchedule::interleaved);
  }

  /// Handles cells that turned solid or fluid, and rebuilds links.
  void remap(const rigid::BodySet& bodies, const BodyChanges& changes) {
    const ChangedCells cells = changed_cells(map_.blocks());
    take_cells(+1, cells.covered, bodies, changes);
    turned_.refill(fluid_, map_.blocks(), cells, bodies, changes.gone);
    if (heat_) heat_->change_cells(map_.blocks(), cells, bodies);
    take_cells(-1, cells.uncovered, bodies, changes);
    account_.take_mass(turned_.weigh(fluid_, map_.blocks()));
    counts_.covered = cells.covered.size(), counts_.uncovered = cells.uncovered.size();
    rebuild_links(bodies);
  }

  bool is_exact() const { return coupling_.force == ForceForm::exact; }

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
    const lbm::WallFluid<T> fluid(fluid_.spec());
    counts_.links = 0;
    for (std::size_t b = 0; b < links_.size(); ++b) {
      const BlockMap& map = map_.blocks()[b];
      BlockLinks<T>& block = links_[b];
      if (map.changed) {
        fluid_.set_idle(int(b), !map.has_fluid());
        build_links<T>(map, world_, bodies,
                       {coupling_, fluid, fluid_.pass_order(int(b)), &meshes_, &mappings_[b]},
                       block.surfaces);
        block.order_groups(fluid_.pass_order(int(b)));
        block.leave_to_device();
        hold_excess(b);
        if (heat_) heat_->list_links(int(b), map, block);
      }
      counts_.links += block.count;
    }
    if (heat_) heat_->find_pockets(map_.blocks(), bodies);
    if (pairs_ && pairs_->chooses()) choose_pairs();
  }

  void hold_excess(std::size_t b) {
    std::vector<lbm::RowRange> rows;
    for (std::size_t k = 0; k < links_[b].surfaces.size(); ++k) {
      if (links_[b].surfaces[k].links.groups.empty()) continue;
      const BitFrame& frame = map_.blocks()[b].masks[k].frame();
      const Int3 end = frame.low + frame.size;
      rows.push_back({frame.low.y, end.y, frame.low.z, end.z});
    }
    fluid_.hold_excess(int(b), rows);
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
  mutable lbm::Fluid<T> fluid_;        // finest level
  std::unique_ptr<HeatFlow<T>> heat_;  // null: the case has no [heat]
  lbm::Levels<T> levels_;              // all levels
  MapBodies map_;
  std::unique_ptr<FluidFields> fields_;
  std::vector<std::unique_ptr<CoarserFields>> coarser_;
  FlowAccount account_;
  std::vector<BlockLinks<T>> links_;
  std::vector<DeviceMapping<T>> mappings_;  // per block
  MeshDistances meshes_{map_.meshes()};
  TurnedCells<T> turned_{fluid_.device()};    // of the last mapping
  std::optional<lbm::PairsAcross<T>> pairs_;  // for schemes that read beyond
  std::vector<SideColumns> columns_;          // per block, for pairs_
  bool pushes_bodies_;
  struct {
    Vec3 body_force;
    rigid::OverTime over_time;
    std::array<BoundarySpec, 6> sides;
  } drive_;
  mutable std::optional<FlowControl> control_;
  FluidForces<T> forces_;
  TurningWalls turning_walls_{world_};
  LinkSchedule schedule_ = LinkSchedule::interleaved;
  MappingCounts counts_;
  bool resumed_ = false;
  mutable bool complete_ = true;  // no cell has an excess
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
