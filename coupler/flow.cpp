#include "coupler/flow.hpp"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coupler/exchange/body_exchange.hpp"
#include "coupler/forces/entrained_fluid.hpp"
#include "coupler/forces/fluid_forces.hpp"
#include "coupler/mapping/build_links.hpp"
#include "coupler/mapping/map_bodies.hpp"
#include "coupler/mapping/refill.hpp"

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

namespace {

/// Steps between two recounts of the fluid for the mass correction; each costs as much as some steps.
constexpr std::int64_t recount_interval = 2000;

/// Of mass and momentum of cells.
std::int64_t to_quanta(double x) {
  return std::llrint(x / lbm::mass_quantum);
}

template <class T>
class FlowOf final : public Flow {
 public:
  FlowOf(const Case& scene, const lbm::Domain& domain, MPI_Comm comm, const BodyExchange& exchange)
      : coupling_(scene.coupling),
        world_(exchange.world()),
        fluid_(domain, collision(*scene.fluid), comm),
        map_(fluid_.domain(), world_, boxes(fluid_)),
        links_(fluid_.blocks().size()),
        pushes_bodies_(scene.fluid->body_force_on_bodies && !scene.fluid->body_force.isZero(0)),
        forces_(coupling_, exchange, scene.contacts.substeps),
        gravity_(scene.gravity),
        corrects_mass_(scene.coupling.mass_correction && scene.has_surfaces() && !has_outlet(scene)) {}

  void map_bodies(rigid::BodySet& bodies) override {
    renew_mapping_poses(bodies, world_, coupling_.remap_tolerance);
    map_(bodies);
    counts_.covered = counts_.uncovered = 0;
    const bool changed =
        std::any_of(map_.blocks().begin(), map_.blocks().end(), [](auto& b) { return b.changed; });
    if (changed) remap(bodies);
    if (pushes_bodies_) push_bodies(bodies);  // before any body is solved for
    give_pending_blows(bodies);
    forces_.begin(fluid_, map_.blocks(), links_, bodies);
  }
  void stream_collide(StepClock& clock) override {
    if (corrects_mass_) set_mass_source();
    if (world_.shapes.empty()) return fluid_.stream_collide();
    fluid_.stream_collide([&](int b, int part) {
      if (!forces_.waiting(links_[b], part)) return;
      clock.timed(Stage::force_evaluation,
                  [&] { forces_.after_part(fluid_.blocks()[b], links_[b], part, gravity_); });
    });
  }
  void communicate() override { fluid_.exchange(); }

  void evaluate_forces(rigid::BodySet& bodies) override {
    stepped_ = true;
    const std::int64_t from_links = forces_(fluid_, links_, bodies, gravity_);
    if (!corrects_mass_) return;
    std::int64_t mine[3] = {from_links, mass_gained_, cells_gained_}, all[3];
    MPI_Allreduce(mine, all, 3, MPI_INT64_T, MPI_SUM, fluid_.comm());
    correction_.link_gain = all[0];
    correction_.surplus += all[0] + all[1] + to_quanta(mass_source_ * double(all[2]));
    correction_.fluid_cells += all[2];
    mass_gained_ = cells_gained_ = 0;
    if (++correction_.steps % recount_interval == 0) recount();
  }

  const lbm::Domain& domain() const override { return fluid_.domain(); }
  int blocks() const override { return int(fluid_.blocks().size()); }
  const lbm::CellBox& block(int b) const override { return fluid_.blocks()[b].box(); }
  bool is_fluid(int b, Int3 x) const override { return !map_.blocks()[b].solid.test(x); }
  lbm::Moments moments(int b, Int3 x) const override { return fluid_.moments(b, x); }
  std::array<double, 3> velocity(const lbm::Moments& m) const override { return fluid_.velocity(m); }
  void set_equilibrium(int b, Int3 x, double rho, const std::array<double, 3>& u) override {
    fluid_.set_equilibrium(b, x, rho, u);
  }
  double arriving(int b, Int3 x, int i) const override { return fluid_.arriving(b, x, i); }
  void set_arriving(int b, Int3 x, int i, double g) override { fluid_.arriving(b, x, i) = T(g); }
  std::size_t bytes() const override { return fluid_.bytes(); }
  MappingCounts mapping() const override { return counts_; }
  const MassCorrectionState& mass_correction() const override { return correction_; }
  void set_mass_correction(const MassCorrectionState& state) override {
    correction_ = state, restarted_ = true;
  }

  void start(rigid::BodySet& bodies) override {
    map_(bodies);
    rebuild_links(bodies);
    if (restarted_) return;
    forces_.start(map_.blocks(), bodies);
    if (corrects_mass_) recount();
  }

  FlowTotals totals() const override;
  std::uint64_t hash() const override;
  Vec3 side_force(int axis, bool upper) const override;
  Load wall_load(std::size_t wall) const override {
    if (!stepped_) return {};
    auto sums = forces_.wall_load(wall);
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), 6, MPI_INT64_T, MPI_SUM, fluid_.comm());
    Load load;
    for (int d = 0; d < 3; ++d)
      load.force[d] = double(sums[d]) * lbm::link_quantum,
      load.torque[d] = double(sums[3 + d]) * lbm::link_quantum;
    return load;
  }

 private:
  static lbm::CollisionSpec collision(const FluidSpec& f) {
    return {f.relaxation_time, f.magic, f.collision, {f.body_force[0], f.body_force[1], f.body_force[2]}};
  }
  static bool has_outlet(const Case& scene) {
    return std::any_of(scene.boundary.begin(), scene.boundary.end(), [](const BoundarySpec& b) {
      return b.kind == BoundaryKind::pressure_outlet || b.kind == BoundaryKind::velocity_inlet;
    });
  }
  static std::vector<lbm::CellBox> boxes(const lbm::Fluid<T>& fluid) {
    std::vector<lbm::CellBox> all;
    for (const auto& b : fluid.blocks()) all.push_back(b.box());
    return all;
  }

  /// The mass correction: interpolated walls, and cells that change sides, do not conserve mass. What is
  /// known to have been gained, and as much as the links gained in the last step for the one to come, is
  /// taken out of all cells alike. (Cells that have changed sides in this step are known when it ends.)
  void set_mass_source() {
    const std::int64_t surplus = correction_.surplus + correction_.link_gain;
    mass_source_ = correction_.fluid_cells > 0
                       ? -double(surplus) * lbm::mass_quantum / double(correction_.fluid_cells)
                       : 0;
    fluid_.set_mass_correction(mass_source_);
    correction_.surplus -= surplus;  // to the quantum; the rounding of single cells is not seen
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

  /// Cells that changed sides, and links.
  void remap(const rigid::BodySet& bodies) {
    const ChangedCells cells = changed_cells(map_.blocks());
    for_fetched(cells.covered, [&](const CoveredCell& c) { hand_over(c, bodies, +1); });
    refill(fluid_, map_.blocks(), cells, bodies, coupling_.refill);
    for (const auto& c : cells.uncovered) hand_over(c, bodies, -1);
    counts_.covered = cells.covered.size(), counts_.uncovered = cells.uncovered.size();
    rebuild_links(bodies);
  }

  /// Populations in single precision round: what the correction knows differs from what there is by some
  /// 1e-13 a cell and step.
  void recount() {
    const FlowTotals now = totals();
    correction_.surplus = to_quanta(now.mass_deviation),
    correction_.fluid_cells = std::int64_t(now.fluid_cells);
  }

  /// What drives the fluid stands for a pressure gradient, which pushes a body with the force on the fluid it
  /// displaces. (A fixed body is held against it.)
  void push_bodies(rigid::BodySet& bodies) const {
    const auto& f = fluid_.spec().force;
    const Vec3 force(f[0], f[1], f[2]);
    for (std::size_t row = 0; row < bodies.owned; ++row)
      if (bodies.is_free(row))
        bodies.add_force(row, bodies.mass[row] * (1 - bodies.weight_factor[row]) * force);
  }

  void rebuild_links(const rigid::BodySet& bodies) {
    const lbm::WallFluid<T> fluid(fluid_.spec());
    counts_.links = 0;
    for (std::size_t b = 0; b < links_.size(); ++b) {
      const BlockMap& map = map_.blocks()[b];
      BlockLinks<T>& block = links_[b];
      if (map.changed) {
        fluid_.set_idle(int(b), !map.has_fluid());
        build_links(map, world_, bodies, coupling_, fluid, fluid_.pass_order(int(b)), block.surfaces);
        block.order_groups(fluid_.pass_order(int(b)));
        if (coupling_.wall_scheme == WallScheme::parabolic)
          block.gaps.pair(block.surfaces, fluid_.domain(), map.box);
      }
      counts_.links += block.count;
    }
  }

  /// Mass, and in the exact form momentum, of a cell that a body covered (+1: the body gains it) or left
  /// (-1).
  void hand_over(const CoveredCell& c, const rigid::BodySet& bodies, int sign) {
    if (!corrects_mass_ && coupling_.force != ForceForm::exact) return;
    const lbm::Moments m = fluid_.moments(c.block, c.cell);
    mass_gained_ -= sign * to_quanta(m.density_deviation);
    cells_gained_ -= sign;
    if (coupling_.force != ForceForm::exact || !c.body) return;
    const std::size_t row = bodies.row_of(c.body->id);
    if (row >= bodies.size()) return;
    const Vec3 arm =
        nearest_arm(fluid_.domain(), bodies.position[row], map_.blocks()[c.block].box.lower + c.cell);
    const auto& force = fluid_.spec().force;
    const Vec3 momentum(m.momentum[0] + 0.5 * force[0], m.momentum[1] + 0.5 * force[1],
                        m.momentum[2] + 0.5 * force[2]);
    forces_.hand_over(c.body->id, sign * momentum, arm);
  }

  template <class F>
  void for_fluid_cells(F&& f) const {
    for (int b = 0; b < blocks(); ++b) {
      const Int3 size = block(b).size;
      for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
          for (int x = 0; x < size.x; ++x)
            if (is_fluid(b, {x, y, z})) f(b, Int3{x, y, z});
    }
  }

  CouplingSpec coupling_;
  const rigid::World& world_;
  lbm::Fluid<T> fluid_;
  MapBodies map_;
  std::vector<BlockLinks<T>> links_;
  bool pushes_bodies_;
  FluidForces<T> forces_;
  MappingCounts counts_;
  Vec3 gravity_;
  bool corrects_mass_, restarted_ = false, stepped_ = false;
  MassCorrectionState correction_;
  double mass_source_ = 0;                           // added to every cell in this step
  std::int64_t mass_gained_ = 0, cells_gained_ = 0;  // this rank's, since the correction last heard of it
};

template <class T>
FlowTotals FlowOf<T>::totals() const {
  FlowTotals t;
  std::int64_t sums[5] = {};
  double high[3] = {0, -std::numeric_limits<double>::max(), -std::numeric_limits<double>::max()};
  std::int64_t bad = std::numeric_limits<std::int64_t>::max();
  const Int3 n = domain().cells();
  for_fluid_cells([&](int b, Int3 x) {
    const lbm::Moments m = moments(b, x);
    const auto u = velocity(m);
    const double speed = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    if (!std::isfinite(m.density_deviation) || !(speed < 1e3)) {
      const Int3 g = block(b).lower + x;
      bad = std::min(bad, (std::int64_t(g.z) * n.y + g.y) * n.x + g.x);
      return;
    }
    ++sums[0], sums[1] += to_quanta(m.density_deviation);
    for (int d = 0; d < 3; ++d) sums[2 + d] += to_quanta(m.momentum[d]);
    high[0] = std::max(high[0], speed);
    high[1] = std::max(high[1], -m.density_deviation), high[2] = std::max(high[2], m.density_deviation);
  });
  MPI_Allreduce(MPI_IN_PLACE, sums, 5, MPI_INT64_T, MPI_SUM, fluid_.comm());
  MPI_Allreduce(MPI_IN_PLACE, high, 3, MPI_DOUBLE, MPI_MAX, fluid_.comm());
  MPI_Allreduce(MPI_IN_PLACE, &bad, 1, MPI_INT64_T, MPI_MIN, fluid_.comm());
  t.fluid_cells = std::uint64_t(sums[0]);
  t.mass_deviation = double(sums[1]) * lbm::mass_quantum;
  for (int d = 0; d < 3; ++d) t.momentum[d] = double(sums[2 + d]) * lbm::mass_quantum;
  t.max_speed = high[0], t.min_density = 1 - high[1], t.max_density = 1 + high[2];
  t.finite = bad == std::numeric_limits<std::int64_t>::max();
  if (!t.finite) t.bad_cell = {int(bad % n.x), int(bad / n.x % n.y), int(bad / n.x / n.y)};
  return t;
}

/// The side that turns a population round which leaves the domain into a cell g: the first wall, in the order
/// of the axes, as in the halo; none: -1.
int bouncing_axis(const lbm::Domain& domain, Int3 g) {
  for (int d = 0; d < 3; ++d) {
    if (domain.periodic(d) || (g[d] >= 0 && g[d] < domain.cells()[d])) continue;
    if (domain.side(d, g[d] >= 0).kind == lbm::SideKind::bounce) return d;
  }
  return -1;
}

/// Sum of c (f out + f back) over the links across the side.
template <class T>
Vec3 FlowOf<T>::side_force(int axis, bool upper) const {
  const int last = domain().cells()[axis] - 1, outward = upper ? 1 : -1;
  std::int64_t sums[3] = {};
  for (int b = 0; b < blocks(); ++b) {
    const lbm::CellBox& box = block(b);
    const int at = (upper ? last : 0) - box.lower[axis];
    if (at < 0 || at >= box.size[axis]) continue;
    Int3 low{}, high = box.size;
    low[axis] = at, high[axis] = at + 1;
    for (int z = low.z; z < high.z; ++z)
      for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; ++x) {
          if (!is_fluid(b, {x, y, z})) continue;
          for (int i = 1; i < lbm::directions; ++i) {
            const Int3 c = lbm::c[i];
            if (c[axis] != outward || bouncing_axis(domain(), box.lower + Int3{x, y, z} + c) != axis)
              continue;
            const double out = fluid_.leaving(b, {x, y, z}, i),
                         back = fluid_.arriving(b, {x, y, z}, lbm::opposite(i));
            const std::int64_t exchanged = std::llrint((out + back) / lbm::link_quantum);
            for (int d = 0; d < 3; ++d) sums[d] += c[d] * exchanged;
          }
        }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_INT64_T, MPI_SUM, fluid_.comm());
  return Vec3(double(sums[0]), double(sums[1]), double(sums[2])) * lbm::link_quantum;
}

template <class T>
std::uint64_t FlowOf<T>::hash() const {
  std::uint64_t sum = 0;
  const Int3 n = domain().cells();
  for_fluid_cells([&](int b, Int3 x) {
    const Int3 g = block(b).lower + x;
    struct {
      std::int64_t cell;
      T g[20];  // one spare: no padding bytes in either precision
    } record{(std::int64_t(g.z) * n.y + g.y) * n.x + g.x, {}};
    for (int i = 0; i < lbm::directions; ++i) record.g[i] = fluid_.arriving(b, x, i);
    sum += XXH3_64bits(&record, sizeof record);
  });
  return sum;
}

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
    default:
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
                                const BodyExchange& exchange) {
  if (scene.fluid->precision == Precision::single_)
    return std::make_unique<FlowOf<float>>(scene, domain, comm, exchange);
  return std::make_unique<FlowOf<double>>(scene, domain, comm, exchange);
}

}  // namespace silt::coupler
