#include "coupler/body_turnover.hpp"

#include <algorithm>

#include "coupler/case/case.hpp"
#include "coupler/energy_guard.hpp"
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/forces/covered_momentum.hpp"
#include "coupler/placement/body_records.hpp"
#include "coupler/placement/place_bodies.hpp"
#include "coupler/scene.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

bool is_in(const OutflowSpec& outflow, const Vec3& x) {
  return (x.array() >= outflow.box.lower.array()).all() && (x.array() <= outflow.box.upper.array()).all();
}

/// The way by which a body leaves now, if by any.
std::optional<int> way_out(const Scene& scene, std::size_t row) {
  const rigid::BodySet& bodies = scene.bodies;
  const Vec3& x = bodies.position[row];
  if (bodies.motion[row] == rigid::Motion::fixed) return {};
  const auto side = side_behind(scene.setup, x, scene.world.bounding_radii[bodies.shape[row]]);
  if (side && scene.setup.boundary[*side].removes_bodies()) return side;
  if (!bodies.is_dynamic(row)) return {};
  const auto& outflows = scene.setup.outflows;
  const auto at =
      std::find_if(outflows.begin(), outflows.end(), [&](const OutflowSpec& o) { return is_in(o, x); });
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

/// With what the fluid still has to give it or to get from it.
Vec3 momentum_of(const rigid::BodySet& bodies, std::size_t row) {
  return bodies.mass[row] * bodies.velocity[row] + impulse_debt(bodies, row) + pending_impact(bodies, row);
}

}  // namespace

BodyTurnover::BodyTurnover(const Scene& scene, rigid::BodyId next_id, const rigid::FixedVec3& brought)
    : next_id_(next_id), expected_(scene.bodies), brought_(brought) {}

BodyChanges BodyTurnover::before_step(Scene& scene, std::int64_t steps_done, RunCounters& counters) {
  BodyChanges changes;
  if (scene.setup.bodies_leave()) let_leave(scene, steps_done, changes, counters);
  if (scene.setup.bodies_come()) let_come(scene, steps_done, changes, counters);
  return changes;
}

void BodyTurnover::let_leave(Scene& scene, std::int64_t steps_done, BodyChanges& changes,
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
    expected_.leave(bodies.id[row]);
    if (!bodies.is_dynamic(row)) continue;
    brought_.add(-momentum_of(bodies, row));
    energy_brought_ -= mechanical_energy(scene.setup, bodies, row);
  }
  changes.gone.reindex();
  scene.exchange->take_out(scene.bodies, rows);
}

void BodyTurnover::let_come(Scene& scene, std::int64_t steps_done, BodyChanges& changes,
                            RunCounters& counters) {
  const auto due = fills_due(scene.setup, steps_done);
  if (due.empty()) return;
  changes.first_new = next_id_;
  const auto arrivals = place_arrivals(scene.setup, due, scene.domain, scene.comm, scene.bodies, next_id_);
  changes.end_new = next_id_;
  const auto shapes = centred_shapes(scene.setup);
  rigid::BodySet& bodies = scene.bodies;
  for (const AppliedFill& fill : arrivals) {
    expected_.come(fill.first_id, fill.total, scene.rank, scene.ranks);
    if (scene.rank == 0) counters.arrived += fill.total, counters.refused += fill.refused;
    fill.for_each([&](rigid::BodyId id, const BodySpec& body) {
      const std::size_t row = bodies.owned++;
      bodies.insert(row, {});
      scene.set_placed(row, id, body, shapes[body.shape]);
      brought_.add(momentum_of(bodies, row));
      energy_brought_ += mechanical_energy(scene.setup, bodies, row);
    });
  }
  bodies.reindex();
  scene.exchange->update_copies(bodies);
}

}  // namespace silt::coupler
