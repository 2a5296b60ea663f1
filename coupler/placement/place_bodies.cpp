#include "coupler/placement/place_bodies.hpp"

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

std::vector<BoundingBall> balls_of_fills(const Case& scene) {
  std::vector<BoundingBall> balls;
  for (const FillSpec& fill : scene.fills) balls.push_back(bounding_ball(scene.shapes[fill.shape]));
  return balls;
}

/// The furthest at which a body of a fill asks what is there.
double reach_of(const Case& scene, const std::vector<BoundingBall>& balls) {
  double radius = 0, gap = 0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    radius = std::max(radius, balls[i].radius);
    gap = std::max(gap, scene.fills[i].gap);
  }
  return 2 * radius + gap;
}

/// The largest bodies first: small ones still find room between them.
std::vector<std::size_t> by_size(const std::vector<BoundingBall>& balls) {
  std::vector<std::size_t> order(balls.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return balls[a].radius > balls[b].radius; });
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
void fill_lattice(const Case& scene, std::size_t index, double radius, Surroundings& around,
                  Obstacles& obstacles, PlacedBodies::Filled& filled) {
  const auto count = static_cast<std::uint64_t>(scene.fills[index].count);
  const Lattice lattice = lattice_of(scene, index, radius);
  auto& bodies = filled.bodies = fill_sites(scene, index, radius, lattice, around, obstacles);
  filled.places = places_of(bodies, std::max<std::uint64_t>(1, lattice.total()), around);
  const std::uint64_t sites = around.sum(bodies.size());
  if (sites < std::max<std::uint64_t>(count, 1)) refuse_count(scene, index, sites);
  filled.total = count > 0 ? count : sites;
  const auto past = std::lower_bound(filled.places.begin(), filled.places.end(), filled.total);
  bodies.resize(past - filled.places.begin());
  filled.places.resize(bodies.size());
  add_to_obstacles(bodies, around, obstacles);
}

PlacedBodies::Filled fill(const Case& scene, std::size_t index, const BoundingBall& ball,
                          Surroundings& around, Obstacles& obstacles) {
  const FillSpec& spec = scene.fills[index];
  PlacedBodies::Filled filled;
  filled.alike.shape = spec.shape, filled.alike.material = spec.material, filled.alike.kind = spec.kind;
  filled.alike.density = spec.density;
  filled.centre_of_mass = ball.centre_of_mass;
  obstacles.begin_balls(ball.radius, spec.gap);
  if (spec.arrangement != Arrangement::random) {
    fill_lattice(scene, index, ball.radius, around, obstacles, filled);
    return filled;
  }
  std::uint64_t range = 0;
  filled.bodies = fill_at_random(scene, index, ball.radius, room_for_centres(scene, index, ball.radius),
                                 around, obstacles, range);
  filled.places = places_of(filled.bodies, range, around);
  filled.total = spec.count;
  return filled;
}

}  // namespace

std::size_t PlacedBodies::size() const {
  std::size_t n = given.size();
  for (const Filled& fill : filled) n += fill.bodies.size();
  return n;
}

BodySpec PlacedBodies::Filled::spec(std::size_t i) const {
  BodySpec body = alike;
  body.pose.orientation = bodies[i].orientation;
  body.pose.position = bodies[i].centre - body.pose.orientation * centre_of_mass;
  return body;
}

PlacedBodies place_bodies(const Case& scene, const lbm::Domain& domain, MPI_Comm comm) {
  const auto balls = balls_of_fills(scene);
  const double reach = reach_of(scene, balls);
  Surroundings around(scene, domain, comm, reach);
  PlacedBodies placed;
  placed.given = given_bodies(scene, around);
  if (!scene.fills.empty()) {
    Obstacles obstacles(scene, around.extent, placed.given, reach);
    placed.filled.resize(scene.fills.size());
    for (const std::size_t i : by_size(balls)) placed.filled[i] = fill(scene, i, balls[i], around, obstacles);
  }
  rigid::BodyId id = 1 + count_given(scene);
  for (PlacedBodies::Filled& filled : placed.filled) {
    filled.first_id = id;
    id += filled.total;
  }
  std::erase_if(placed.given, [](const GivenBody& body) { return !body.own; });
  return placed;
}

}  // namespace silt::coupler
