#include "coupler/placement/apply_fills.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "coupler/case/case.hpp"
#include "coupler/case/fill_room.hpp"
#include "coupler/placement/lattice_fill.hpp"
#include "coupler/placement/number_off.hpp"
#include "coupler/placement/random_fill.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

double radius_of_fill(const Case& scene, std::size_t fill) {
  return rigid::bounding_radius(scene.shapes[scene.fills[fill].shape]);
}

/// Places of the applications, the largest bodies first: small ones still find room between them.
std::vector<std::size_t> by_size(const Case& scene, const std::vector<FillApplication>& applications) {
  std::vector<double> radii;
  for (const FillApplication& application : applications)
    radii.push_back(radius_of_fill(scene, application.fill));
  std::vector<std::size_t> order(applications.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return radii[a] > radii[b]; });
  return order;
}

std::vector<std::uint64_t> places_of(const std::vector<FilledBody>& bodies, std::uint64_t range,
                                     Surroundings& around) {
  std::vector<std::uint64_t> numbers;
  for (const FilledBody& body : bodies) numbers.push_back(body.number);
  return number_off(around.messages, numbers, range);
}

[[noreturn]] void refuse_count(const Case& scene, std::size_t index, std::uint64_t sites) {
  throw CaseError(scene.place(fmt::format("fill[{}].count", index)),
                  fmt::format("fill[{}].count is {}, but there are only {} free sites; lower count, gap or "
                              "spacing, or enlarge box or domain",
                              index, scene.fills[index].count, sites));
}

/// The first sites that are free, as many as asked for or all.
void fill_lattice(const Case& scene, FillApplication application, double radius, Surroundings& around,
                  Obstacles& obstacles, AppliedFill& filled) {
  const auto count = static_cast<std::uint64_t>(scene.fills[application.fill].count);
  const Lattice lattice = lattice_of(scene, application, radius);
  auto& bodies = filled.bodies = fill_sites(scene, application, radius, lattice, around, obstacles);
  filled.places = places_of(bodies, std::max<std::uint64_t>(1, lattice.total()), around);
  const std::uint64_t sites = around.sum(bodies.size());
  if (application.is_first() && sites < std::max<std::uint64_t>(count, 1))
    refuse_count(scene, application.fill, sites);
  filled.total = count > 0 ? std::min(count, sites) : sites;
  const auto past = std::lower_bound(filled.places.begin(), filled.places.end(), filled.total);
  bodies.resize(past - filled.places.begin());
  filled.places.resize(bodies.size());
  add_to_obstacles(bodies, around, obstacles);
}

void fill_randomly(const Case& scene, FillApplication application, double radius, Surroundings& around,
                   Obstacles& obstacles, AppliedFill& filled) {
  const rigid::BoundingBox room = room_for_centres(scene, application.fill, radius);
  RandomlyFilled random = fill_at_random(scene, application, radius, room, around, obstacles);
  filled.places = places_of(random.bodies, random.range, around);
  filled.bodies = std::move(random.bodies);
  filled.total = random.total;
}

AppliedFill apply(const Case& scene, FillApplication application, Surroundings& around,
                  Obstacles& obstacles) {
  const FillSpec& spec = scene.fills[application.fill];
  const double radius = radius_of_fill(scene, application.fill);
  AppliedFill filled;
  filled.alike.shape = spec.shape, filled.alike.material = spec.material, filled.alike.kind = spec.kind;
  filled.alike.density = spec.density, filled.alike.velocity = spec.velocity;
  obstacles.begin_balls(radius, spec.gap);
  if (spec.arrangement == Arrangement::random)
    fill_randomly(scene, application, radius, around, obstacles, filled);
  else
    fill_lattice(scene, application, radius, around, obstacles, filled);
  const auto count = static_cast<std::uint64_t>(spec.count);
  filled.refused = count - std::min(count, filled.total);
  return filled;
}

}  // namespace

BodySpec AppliedFill::spec(std::size_t i) const {
  BodySpec body = alike;
  body.pose.orientation = bodies[i].orientation;
  body.pose.position = bodies[i].centre;
  return body;
}

double reach_of_fills(const Case& scene) {
  double radius = 0, gap = 0;
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    radius = std::max(radius, radius_of_fill(scene, i));
    gap = std::max(gap, scene.fills[i].gap);
  }
  return 2 * radius + gap;
}

std::vector<AppliedFill> apply_fills(const Case& scene, const std::vector<FillApplication>& applications,
                                     std::span<const GivenBody> there, Surroundings& around,
                                     rigid::BodyId& next_id) {
  std::vector<AppliedFill> applied(applications.size());
  if (applications.empty()) return applied;
  Obstacles obstacles(scene, around.extent, there, reach_of_fills(scene));
  for (const std::size_t i : by_size(scene, applications))
    applied[i] = apply(scene, applications[i], around, obstacles);
  for (AppliedFill& filled : applied) {
    filled.first_id = next_id;
    next_id += filled.total;
  }
  return applied;
}

}  // namespace silt::coupler
