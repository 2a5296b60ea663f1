#include "silt/fault_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "parallel/collectives.hpp"
#include "parallel/together.hpp"
#include "silt/body_turnover.hpp"
#include "silt/case/case.hpp"
#include "silt/guard.hpp"
#include "silt/scene.hpp"

namespace silt {

using rigid::BodySet;
using rigid::FixedSum;
using rigid::Vec3;

namespace {

/// The largest energy of a body in a sum: 2^62, the range of a sum, divided by 2^20 bodies.
constexpr double out_of_proportion = 0x1p42;

FixedSum cut_off(double energy) {
  return rigid::to_fixed(std::clamp(energy, -out_of_proportion, out_of_proportion));
}

bool is_driven(const Case& setup) {
  const auto moves = [](const coupler::BoundarySpec& side) {
    return side.is_wall() && side.velocity != Vec3::Zero();
  };
  return std::ranges::any_of(setup.boundary, moves) || std::ranges::any_of(setup.walls, &CurvedWall::moves) ||
         setup.gravity_over_time.varies() || !setup.springs.empty() ||
         setup.any_given([](const BodySpec& b) { return b.motion == rigid::Motion::prescribed; });
}

/// Returns the sum of the components of rows [begin, end), which is not finite if one is not.
double sum_over(const std::vector<rigid::Vec3>& x, std::size_t begin, std::size_t end) {
  return Eigen::Map<const Eigen::VectorXd>(x[begin].data(), 3 * Eigen::Index(end - begin)).sum();
}

struct Speeds {  // squares; the sum is NaN if one is
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

/// Returns whether no row of [begin, end) needs a closer check; costs a few instructions per body and step.
bool clearly_sound(const rigid::BodySet& bodies, std::size_t begin, std::size_t end, const Speeds& speeds,
                   double furthest) {
  return std::isfinite(speeds.sum) && speeds.highest <= furthest * furthest &&
         std::isfinite(sum_over(bodies.angular_velocity, begin, end)) &&
         std::isfinite(sum_over(bodies.position, begin, end));
}

/// Returns the speed if velocity and position of a body are finite, else NaN.
double speed_or_nan(const BodySet& bodies, std::size_t row) {
  const double rest = bodies.angular_velocity[row].squaredNorm() + bodies.position[row].squaredNorm();
  return std::isfinite(rest) ? bodies.velocity[row].norm() : std::numeric_limits<double>::quiet_NaN();
}

void put_to_rest(BodySet& bodies, std::size_t row) {
  bodies.set_velocity(row, Vec3::Zero(), Vec3::Zero());
}

}  // namespace

FaultWatch::FaultWatch(const Case& setup)
    : limits_(setup), energy_{.watched = !setup.fluid && !is_driven(setup), .here = {}} {}

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
  if (!scene.anything_moves || !(now || step % walls_interval == 0)) return;
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

void FaultWatch::see_fluid(const Scene& scene, const coupler::FluidFields::Fast& fast, std::int64_t step) {
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
  const auto gives_way = [&](rigid::BodyId id, const Vec3& r, const Vec3& normal) {
    constexpr double rounding = 1e-9;  // relative to a body without locked axes
    const std::size_t row = bodies.row_of(id);
    if (!bodies.is_dynamic(row) || bodies.locked(row) == 0) return bodies.is_dynamic(row);
    const Vec3 arm = r.cross(normal);
    return normal.dot(bodies.unlocked(row, normal)) +
               bodies.mass[row] * arm.dot(bodies.inverse_inertia_W(row) * arm) >
           rounding;
  };
  constexpr double at_rest = 1e-4;  // half-widths per step
  for (const rigid::Contact& c : contacts) {
    if (-c.gap <= limits_.least_half_width()) continue;
    const double allowed = std::min(half_width(c.a), half_width(c.b)), share = -c.gap / allowed;
    if (share > 1 && approach(c) > at_rest * allowed)
      note(overlap, share, c.a, [&] {
        const bool can_part = gives_way(c.a, c.r_a, c.normal) || gives_way(c.b, c.r_b, c.normal);
        return overlap_text(setup, c, allowed, can_part, step);
      });
  }
}

Vec3 unwrapped(const BodySet& bodies, std::size_t row, const Vec3& period) {
  Vec3 x = bodies.position[row];
  for (int d = 0; d < 3; ++d) x[d] += bodies.image[row][d] * period[d];
  return x;
}

FixedSum mechanical_energy(const Case& setup, const BodySet& bodies, std::size_t row) {
  const Vec3 x = unwrapped(bodies, row, extent_of(setup).size);
  return cut_off(bodies.kinetic_energy(row) -
                 bodies.mass[row] * bodies.weight_in_fluid[row] * setup.gravity.dot(x));
}

bool FaultWatch::see_energy(const Scene& scene, FixedSum brought, std::int64_t step) {
  if (!energy_.watched) return false;
  const BodySet& bodies = scene.bodies;
  const double g = scene.setup.gravity.norm();
  FixedSum mechanical = -brought, kinetic = 0, lift = 0;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (!bodies.is_dynamic(row)) continue;
    mechanical += mechanical_energy(scene.setup, bodies, row);
    kinetic += cut_off(bodies.kinetic_energy(row));
    lift += cut_off(bodies.mass[row] * std::abs(bodies.weight_in_fluid[row]) * g *
                    scene.world.bounding_radii[bodies.shape[row]]);
  }
  energy_.here = {mechanical, kinetic, lift};
  energy_.step = step;
  energy_.looked_at = true;
  energy_.first = std::exchange(energy_.fresh, false);
  return true;
}

/// Returns the error if the bodies have gained too much energy, or "".
std::string FaultWatch::gain(const Case& setup, const Energies& of_all) {
  constexpr double share_of_motion = 0.1;  // of the largest kinetic energy, allowed besides the lift
  const double energy = rigid::from_fixed(of_all.mechanical.value()),
               kinetic = rigid::from_fixed(of_all.kinetic.value());
  Energy& e = energy_;
  if (e.first) e.start = energy, e.start_step = e.step, e.largest_kinetic = kinetic;
  e.largest_kinetic = std::max(e.largest_kinetic, kinetic);
  const double allowed = share_of_motion * e.largest_kinetic + rigid::from_fixed(of_all.lift.value());
  return energy - e.start > allowed
             ? energy_text(setup, {energy - e.start, kinetic, allowed}, e.start_step, e.step)
             : "";
}

void FaultWatch::start(MPI_Comm comm) {
  Sums mine{.ranks_with = {}, .energies = energy_.here};
  for (int k = 0; k < kinds; ++k) mine.ranks_with[k] = seen_[k].has_value();
  sums_.start(comm, mine);
}

std::string FaultWatch::finish(const Case& setup, MPI_Comm comm) {
  if (!sums_.under_way()) return "";
  const auto& [with, energies] = sums_.finish();
  const auto found = std::ranges::find_if(with, [](std::int64_t n) { return n > 0; });
  if (found != with.end()) return told(comm, seen_[found - with.begin()]);
  return std::exchange(energy_.looked_at, false) ? gain(setup, energies) : "";
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

}  // namespace silt
