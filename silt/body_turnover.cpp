#include "silt/body_turnover.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/forces/covered_momentum.hpp"
#include "parallel/collectives.hpp"
#include "silt/case/case.hpp"
#include "silt/fault_watch.hpp"
#include "silt/placement/place_bodies.hpp"
#include "silt/scene.hpp"

namespace silt {
namespace {

using rigid::Vec3;

/// Returns how a body leaves now, if it does.
std::optional<int> way_out(const Scene& scene, std::size_t row) {
  const rigid::BodySet& bodies = scene.bodies;
  const Vec3& x = bodies.position[row];
  if (bodies.motion[row] == rigid::Motion::fixed) return {};
  const auto side = side_behind(scene.setup, x, scene.world.bounding_radii[bodies.shape[row]]);
  if (side && scene.setup.boundary[*side].removes_bodies()) return side;
  if (!bodies.is_dynamic(row)) return {};
  const auto& outflows = scene.setup.outflows;
  const auto at = std::ranges::find_if(outflows, [&](const OutflowSpec& o) { return o.box.contains(x); });
  if (at == outflows.end()) return {};
  return first_outflow + static_cast<int>(at - outflows.begin());
}

struct Leaver {
  std::size_t row;
  int way;
};

std::vector<Leaver> leavers(const Scene& scene) {
  std::vector<Leaver> found;
  for (std::size_t row = 0; row < scene.bodies.owned + scene.bodies.copies; ++row)
    if (const auto way = way_out(scene, row)) found.push_back({row, *way});
  return found;
}

/// Returns the momentum of a body with its impulse debt to the fluid.
Vec3 momentum_of(const rigid::BodySet& bodies, std::size_t row) {
  return bodies.mass[row] * bodies.velocity[row] + coupler::impulse_debt(bodies, row) +
         coupler::coupling_of(bodies, row).pending_impact();
}

}  // namespace

std::string way_text(int way) {
  if (way >= first_outflow) return fmt::format("outflow[{}]", way - first_outflow);
  return std::string(coupler::side_names[coupler::Side(way)]);
}

std::optional<int> side_behind(const Case& setup, const rigid::Vec3& x, double radius) {
  for (int d = 0; d < 3; ++d) {
    if (setup.periodic(d)) continue;
    if (x[d] + radius < 0) return 2 * d;
    if (x[d] - radius > setup.cells[d]) return 2 * d + 1;
  }
  return {};
}

std::string outside_text(const Case& setup, rigid::BodyId id, bool free, int side, std::int64_t step) {
  const std::string found =
      fmt::format("step {}: body {} has left the domain past {}", step, id, way_text(side));
  if (!free)
    return found +
           ", a wall, as its motion is prescribed: end the run before, or set solid_for_bodies = false "
           "on that side, and it is taken out";
  return found + fmt::format(", through the wall: raise contacts.substeps (now {})", setup.contacts.substeps);
}

std::vector<Departure> gathered(MPI_Comm comm, const std::vector<Departure>& mine) {
  auto departures = parallel::gathered(comm, std::span(mine), parallel::GatherTo::root);
  std::sort(departures.begin(), departures.end(), [](const Departure& a, const Departure& b) {
    return std::tie(a.step, a.id) < std::tie(b.step, b.id);
  });
  return departures;
}

BodyTurnover::BodyTurnover(const Scene& scene, rigid::BodyId next_id, const rigid::FixedVec3& brought)
    : next_id_(next_id), expected_(scene.bodies), brought_(brought) {}

coupler::BodyChanges BodyTurnover::before_step(Scene& scene, std::int64_t steps_done, RunCounters& counters) {
  coupler::BodyChanges changes;
  if (scene.setup.bodies_leave()) let_leave(scene, steps_done, changes, counters);
  if (scene.setup.bodies_come()) let_come(scene, steps_done, changes, counters);
  return changes;
}

void BodyTurnover::let_leave(Scene& scene, std::int64_t steps_done, coupler::BodyChanges& changes,
                             RunCounters& counters) {
  const rigid::BodySet& bodies = scene.bodies;
  const std::vector<Leaver> leaving = leavers(scene);
  if (leaving.empty()) return;
  std::vector<std::size_t> rows;
  for (const auto& [row, way] : leaving) {
    rows.push_back(row);
    changes.gone.add(bodies.record(row));
    if (row >= bodies.owned) continue;
    ++counters.left, ++counters.left_by[std::min(way, first_outflow)];
    const Vec3& x = bodies.position[row];
    departures_.push_back({steps_done, bodies.id[row], way, {x[0], x[1], x[2]}});
    expected_.remove(bodies.id[row]);
    if (!bodies.is_dynamic(row)) continue;
    brought_.add(-momentum_of(bodies, row));
    energy_brought_ -= mechanical_energy(scene.setup, bodies, row);
  }
  changes.gone.reindex();
  scene.exchange->remove_bodies(scene.bodies, rows);
}

void BodyTurnover::let_come(Scene& scene, std::int64_t steps_done, coupler::BodyChanges& changes,
                            RunCounters& counters) {
  const auto due = fills_due(scene.setup, steps_done);
  if (due.empty()) return;
  changes.first_new = next_id_;
  const auto arrivals = place_arrivals(scene.setup, due, scene.domain, scene.comm, scene.bodies, next_id_);
  changes.end_new = next_id_;
  const auto shapes = centred_shapes(scene.setup);
  rigid::BodySet& bodies = scene.bodies;
  for (const AppliedFill& fill : arrivals) {
    expected_.add(fill.first_id, fill.total, scene.rank(), scene.ranks());
    if (scene.rank() == 0) counters.arrived += fill.total, counters.refused += fill.refused;
    fill.for_each([&](rigid::BodyId id, const BodySpec& body) {
      const std::size_t row = bodies.owned++;
      bodies.insert(row, {});
      scene.set_placed(row, id, body, shapes[body.shape]);
      brought_.add(momentum_of(bodies, row));
      energy_brought_ += mechanical_energy(scene.setup, bodies, row);
    });
  }
  bodies.reindex();
  scene.exchange->synchronise(bodies);
}

}  // namespace silt
