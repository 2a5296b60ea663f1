// Changes to bodies between steps by a program. All ranks reject what a case could not have.
#include <fmt/format.h>

#include <stdexcept>

#include "parallel/collectives.hpp"
#include "parallel/together.hpp"
#include "rigid/response/warm_start.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/placement/given_bodies.hpp"
#include "silt/placement/obstacles.hpp"
#include "silt/simulation.hpp"

namespace silt {

using rigid::BodyId;
using rigid::Motion;
using rigid::Vec3;

/// What all ranks know of the body to change, and its row, which is valid on its owner only.
struct Simulation::Steered {
  std::size_t row;
  bool own;
  int shape, kind;
  Motion motion;
};

namespace {

/// Throws, on every rank, the text of the first rank that has one.
void refuse(MPI_Comm comm, const std::string& mine) {
  if (const std::string fault = parallel::text_of_first(comm, mine); !fault.empty())
    throw std::invalid_argument(fault);
}

/// Returns the fault of a body's forces in the next step, or "". Displaced fluid counts as added mass.
std::string fault_of_forces(const Scene& scene, std::size_t row, const Vec3& force, const Vec3& torque) {
  const rigid::BodySet& bodies = scene.bodies;
  const int shape = bodies.shape[row];
  const double most = MotionLimits(scene.setup).of(shape),
               share = bodies.mass[row] / (bodies.mass[row] + bodies.displaced_mass(row));
  const double speed = share * bodies.unlocked(row, force).norm() / bodies.mass[row],
               rim = share * (bodies.inverse_inertia_W(row) * torque).norm() *
                     scene.world.bounding_radii[std::size_t(shape)];
  for (const auto& [what, gained] : {std::pair("force", speed), std::pair("torque", rim)})
    if (!(gained <= most))
      return fmt::format(
          "{} gives body {} a velocity of {} cells a step{} in one step; at most {} is possible: lower it, "
          "or "
          "give it in several steps",
          what, bodies.id[row], shown(gained), in_si(scene.setup, gained), shown(most));
  return "";
}

/// Returns a spec of the body at its new place.
BodySpec spec_of(const rigid::Pose& pose, int shape, int kind, Motion motion) {
  BodySpec spec;
  spec.shape = shape, spec.kind = kind, spec.motion = motion;
  spec.pose = {pose.position, pose.orientation.normalized()};
  return spec;
}

BodySpec spec_of(const rigid::BodySet& bodies, std::size_t row) {
  return spec_of(bodies.pose(row), bodies.shape[row], bodies.kind[row], bodies.motion[row]);
}

/// Returns a copy of the case whose messages give lengths in cells.
Case in_cells(const Case& setup) {
  Case copy = setup;
  copy.units = Units{};
  return copy;
}

}  // namespace

Simulation::Steered Simulation::steered(BodyId id) const {
  const rigid::BodySet& bodies = scene_.bodies;
  const std::size_t row = bodies.row_of(id);
  const bool own = row < bodies.owned;
  struct {
    std::uint64_t owners, shape, kind, motion;
  } found{};
  if (own)
    found = {1, std::uint64_t(bodies.shape[row]), std::uint64_t(bodies.kind[row]),
             std::uint64_t(bodies.motion[row])};
  found = parallel::sum_over_ranks(scene_.comm, found);
  if (found.owners == 0) throw std::invalid_argument(fmt::format("there is no body {}", id));
  const Steered body{row, own, int(found.shape), int(found.kind), Motion(found.motion)};
  if (body.motion == Motion::fixed) throw std::invalid_argument(fmt::format("body {} is fixed", id));
  return body;
}

void Simulation::add_force(BodyId id, const Vec3& force, const Vec3& torque) {
  const Steered body = steered(id);
  rigid::BodySet& bodies = scene_.bodies;
  std::string fault;
  if (body.own && body.motion == Motion::free)
    fault = fault_of_forces(scene_, body.row, bodies.force[body.row].value() + force,
                            bodies.torque[body.row].value() + torque);
  refuse(scene_.comm, fault);
  faults_.start_again();
  if (!body.own) return;
  bodies.add_force(body.row, force);
  bodies.add_torque(body.row, torque);
}

void Simulation::set_velocity(BodyId id, const Vec3& velocity, const Vec3& angular_velocity) {
  const Steered body = steered(id);
  if (body.motion == Motion::prescribed && setup().kind_motions.count(body.kind))
    throw std::invalid_argument(
        fmt::format("body {} moves as the table `motion` of '{}' says, and a velocity would have no effect",
                    id, setup().kind_names[std::size_t(body.kind)]));
  Diagnostics findings(setup());
  check_velocities(findings, "", body.shape, velocity, angular_velocity);
  for (const Diagnostic& found : findings.list)
    if (found.severity == Diagnostic::Severity::error) throw std::invalid_argument(found.text);
  rigid::BodySet& bodies = scene_.bodies;
  for (int d = 0; d < 3 && !setup().kind_locks.empty(); ++d)
    if (setup().kind_locks[std::size_t(body.kind)] & rigid::locked_about(d) && angular_velocity[d] != 0)
      throw std::invalid_argument(fmt::format(
          "angular_velocity[{}] turns body {} about a locked axis; make that component 0", d, id));
  faults_.start_again();
  if (body.own) {
    bodies.set_velocity(body.row, velocity, angular_velocity);
    coupler::Springs::start(bodies, body.row);
  }
  scene_.exchange->relocate(bodies);  // its holders may have changed
  if (scene_.springs) scene_.springs->share(bodies);
}

/// Requires that a body at its new place is in finest cells and free of walls and other bodies.
void Simulation::require_room(BodyId id, const BodySpec& body) const {
  const std::string key = setup().units.si ? "position (in cells)" : "position";
  const double now = double(step_);
  if (!fault_of_place(setup(), body, key, now).empty())
    throw std::invalid_argument(fault_of_place(in_cells(setup()), body, key, now));
  std::vector<BodyFault> overlaps;
  const rigid::Shape& shape = setup().shapes[std::size_t(body.shape)];
  for (std::size_t row = 0; row < bodies().owned; ++row) {
    const BodySpec other = spec_of(bodies(), row);
    if (bodies().id[row] == id || (body.motion != Motion::free && other.motion != Motion::free)) continue;
    const double depth = overlap_depth(shape, body.pose, setup().shapes[std::size_t(other.shape)], other.pose,
                                       extent_of(setup()));
    if (depth > start_overlap)
      overlaps.push_back(
          {bodies().id[row], 0,
           fmt::format("{} is {}: the body overlaps body {}, at {}, by at least {}; move it away", key,
                       shown(body.pose.position), bodies().id[row], shown(other.pose.position),
                       shown(depth))});
  }
  if (const auto first = first_faults(scene_.comm, std::move(overlaps), 1); !first.empty())
    throw std::invalid_argument(first[0].text);
  if (!setup().coarsening) return;
  const bool coarse = scene_.has_coarser_cells_near(rigid::bounding_box(shape, body.pose));
  refuse(scene_.comm,
         coarse
             ? fmt::format("{} is {}: there are coarser cells within {} cells of the body there; keep cells "
                           "fine by [[coarsening.fine]], or move it in shorter ways",
                           key, shown(body.pose.position), coupler::least_margin(setup().coupling))
             : "");
}

void Simulation::set_pose(BodyId id, const rigid::Pose& pose) {
  const Steered body = steered(id);
  require_room(id, spec_of(pose, body.shape, body.kind, body.motion));
  rigid::BodySet& bodies = scene_.bodies;
  if (body.own) {
    bodies.image[body.row] = {};
    bodies.set_pose(body.row, pose);
  }
  rigid::forget_impulses(bodies, id);
  faults_.start_again();
  scene_.exchange->relocate(bodies);  // its owner may have changed
  if (scene_.springs) scene_.springs->share(bodies);
}

}  // namespace silt
