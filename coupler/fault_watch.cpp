#include "coupler/fault_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coupler/body_turnover.hpp"
#include "coupler/case/case.hpp"
#include "coupler/guard.hpp"
#include "coupler/scene.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::coupler {

using rigid::BodySet;
using rigid::Vec3;

namespace {

/// Of the components of rows [begin, end): infinite or not a number as soon as one is.
double sum_over(const std::vector<rigid::Vec3>& x, std::size_t begin, std::size_t end) {
  return Eigen::Map<const Eigen::VectorXd>(x[begin].data(), 3 * Eigen::Index(end - begin)).sum();
}

struct Speeds {  // squares; the sum is not a number as soon as one is
  double sum = 0, highest = 0;
};
Speeds speeds_of(const rigid::BodySet& bodies, std::size_t begin, std::size_t end) {
  Speeds speeds;
  for (std::size_t row = begin; row < end; ++row) {
    const double square = bodies.velocity[row].squaredNorm();
    speeds.sum += square, speeds.highest = std::max(speeds.highest, square);
  }
  return speeds;
}

/// No row of [begin, end) can have a reason to stop: a few instructions a body, in every step.
bool clearly_sound(const rigid::BodySet& bodies, std::size_t begin, std::size_t end, const Speeds& speeds,
                   double furthest) {
  return std::isfinite(speeds.sum) && speeds.highest <= furthest * furthest &&
         std::isfinite(sum_over(bodies.angular_velocity, begin, end)) &&
         std::isfinite(sum_over(bodies.position, begin, end));
}

/// A number as soon as velocity and position are, and no more than the speed; else not finite.
double speed_or_nan(const BodySet& bodies, std::size_t row) {
  const double rest = bodies.angular_velocity[row].squaredNorm() + bodies.position[row].squaredNorm();
  return std::isfinite(rest) ? bodies.velocity[row].norm() : std::numeric_limits<double>::quiet_NaN();
}

void put_to_rest(BodySet& bodies, std::size_t row) {
  bodies.set_velocity(row, Vec3::Zero(), Vec3::Zero());
}

}  // namespace

FaultWatch::FaultWatch(const Case& setup)
    : limits_(setup),
      sides_stop_(std::any_of(setup.boundary.begin(), setup.boundary.end(), [](const BoundarySpec& side) {
        return side.lets_bodies_pass() && !side.removes_bodies();
      })) {}

double FaultWatch::hold_runaways(const Case& setup, BodySet& bodies, std::int64_t step) {
  constexpr std::size_t at_once = 256;
  double highest = 0;
  for (std::size_t begin = 0; begin < bodies.owned; begin += at_once) {
    const std::size_t end = std::min(begin + at_once, bodies.owned);
    Speeds speeds = speeds_of(bodies, begin, end);
    if (!clearly_sound(bodies, begin, end, speeds, limits_.least())) {
      hold_rows(setup, bodies, begin, end, step);
      speeds = speeds_of(bodies, begin, end);
    }
    highest = std::max(highest, speeds.highest);
  }
  ++moment_;
  return std::sqrt(highest);
}

void FaultWatch::hold_rows(const Case& setup, BodySet& bodies, std::size_t begin, std::size_t end,
                           std::int64_t step) {
  for (std::size_t row = begin; row < end; ++row) {
    const double speed = speed_or_nan(bodies, row), limit = limits_.of(bodies.shape[row]);
    if (speed <= limit) continue;
    note(body, 0, bodies.id[row], [&] { return motion_text(setup, bodies.id[row], speed, limit, step); });
    put_to_rest(bodies, row);
  }
}

template <class Text>
void FaultWatch::note(Kind kind, double severity, std::uint64_t key, Text&& text) {
  std::optional<Fault>& seen = seen_[kind];
  if (seen && seen->moment < moment_) return;
  if (seen && (severity < seen->severity || (severity == seen->severity && key >= seen->key))) return;
  seen = Fault{moment_, severity, key, text()};
}

void FaultWatch::see_outside(const Scene& scene, std::int64_t step, bool now) {
  constexpr std::int64_t walls_interval = 64;
  if (!scene.anything_moves || !(now || sides_stop_ || step % walls_interval == 0)) return;
  const BodySet& bodies = scene.bodies;
  if (scene.setup.periodic(0) && scene.setup.periodic(1) && scene.setup.periodic(2)) return;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (bodies.motion[row] == rigid::Motion::fixed) continue;
    const double radius = scene.world.bounding_radii[bodies.shape[row]];
    const auto side = side_behind(scene.setup, bodies.position[row], radius);
    if (side && !scene.setup.boundary[*side].removes_bodies())
      note(body, 0, bodies.id[row],
           [&] { return outside_text(scene.setup, bodies.id[row], bodies.is_dynamic(row), *side, step); });
  }
}

void FaultWatch::see_fluid(const Scene& scene, const FluidFields::Fast& fast, std::int64_t step) {
  const auto& [x, y, z] = fast.cell;
  const auto& n = scene.setup.cells;
  note(fluid, fast.speed, (std::uint64_t(z) * n[1] + y) * n[0] + x,
       [&] { return too_fast_text(scene, fast, step); });
}

void FaultWatch::see_overlaps(const Case& setup, const BodySet& bodies,
                              std::span<const rigid::Contact> contacts, std::int64_t step) {
  const auto half_width = [&](rigid::BodyId id) {
    const std::size_t row = bodies.row_of(id);
    return row < bodies.first_wall() ? limits_.half_width(bodies.shape[row])
                                     : std::numeric_limits<double>::infinity();
  };
  const auto approach = [&](const rigid::Contact& c) {
    const auto at = [&](rigid::BodyId id, const Vec3& r) { return bodies.velocity_at(bodies.row_of(id), r); };
    return (at(c.a, c.r_a) - at(c.b, c.r_b)).dot(c.normal);
  };
  constexpr double at_rest = 1e-4;  // of the half-width in a step
  for (const rigid::Contact& c : contacts) {
    if (-c.gap <= limits_.least_half_width()) continue;
    const double allowed = std::min(half_width(c.a), half_width(c.b)), share = -c.gap / allowed;
    if (share > 1 && approach(c) > at_rest * allowed)
      note(overlap, share, c.a, [&] { return overlap_text(setup, c, allowed, step); });
  }
}

void FaultWatch::start(MPI_Comm comm) {
  Ranks mine;
  for (int k = 0; k < kinds; ++k) mine.with[k] = seen_[k].has_value();
  sums_.start(comm, mine);
}

std::string FaultWatch::finish(MPI_Comm comm) {
  if (!sums_.under_way()) return "";
  const Ranks& all = sums_.finish();
  const auto found = std::find_if(all.with.begin(), all.with.end(), [](std::int64_t n) { return n > 0; });
  return found == all.with.end() ? "" : told(comm, seen_[found - all.with.begin()]);
}

std::string FaultWatch::told(MPI_Comm comm, const std::optional<Fault>& mine) {
  constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();
  const std::uint64_t moment = parallel::least_over_ranks(comm, mine ? mine->moment : none);
  const bool first = mine && mine->moment == moment;
  const double severity = parallel::max_over_ranks(comm, first ? mine->severity : -1);
  const bool worst = first && mine->severity == severity;
  const std::uint64_t key = parallel::least_over_ranks(comm, worst ? mine->key : none);
  return parallel::text_of_first(comm, worst && mine->key == key ? mine->text : "");
}

}  // namespace silt::coupler
