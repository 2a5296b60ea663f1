#include "rigid/detect_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "rigid/reduce_manifold.hpp"

namespace silt::rigid {

namespace {

/// Approach speeds are those before the kick and before contacts; some room for what these two add.
constexpr double margin_safety = 1.5;
/// Keeps resting contacts in sight, relative to the bounding radius.
constexpr double least_margin = 1e-6;

/// Canonical and inside the domain also where a contact point lies behind a wall.
Vec3 into_domain(const Extent& extent, Vec3 x) {
  std::array<std::int32_t, 3> image{};
  extent.wrap(x, image);
  for (int d = 0; d < 3; ++d)
    if (!extent.periodic[d]) x[d] = std::clamp(x[d], 0.0, std::nextafter(extent.size[d], 0.0));
  return x;
}

std::uint64_t packed_feature(std::size_t part_a, std::size_t part_b, std::uint32_t feature) {
  return std::uint64_t{part_a} << 48 | std::uint64_t{part_b} << 32 | feature;
}

}  // namespace

DetectContacts::DetectContacts(std::unique_ptr<BroadPhase> broad_phase)
    : broad_phase_(std::move(broad_phase)) {}

void DetectContacts::learn_shapes(const World& world) {
  for (std::size_t s = shapes_.size(); s < world.shapes.size(); ++s) {
    ShapeParts known;
    known.parts = convex_parts(world.shapes[s]);
    for (const Part& part : known.parts)
      known.radii.push_back(bounding_radius(Compound{{{part.shape, Pose{}}}}));
    known.sphere = is_sphere(world.shapes[s]);
    known.half_space = std::holds_alternative<HalfSpace>(world.shapes[s]);
    const Pose& pose = known.parts[0].pose;
    known.plain =
        known.parts.size() == 1 && pose.position.isZero(0) && pose.orientation.isApprox(Quat::Identity(), 0);
    shapes_.push_back(std::move(known));
  }
}

void DetectContacts::set_reach(const World& world, const BodySet& bodies, double dt) {
  const std::size_t count = bodies.first_wall();
  reach_.resize(count);
  turn_.resize(count);
  boxes_.resize(count);
  const double fall = dt * dt * world.gravity.norm();
  for (std::size_t row = 0; row < count; ++row) {
    const double radius = world.bounding_radii[bodies.shape[row]];
    turn_[row] = shapes_[bodies.shape[row]].sphere ? 0.0 : dt * radius * bodies.angular_velocity[row].norm();
    if (!shapes_[bodies.shape[row]].sphere)
      boxes_[row] = bounding_box(world.shapes[bodies.shape[row]], {Vec3::Zero(), bodies.orientation[row]});
    const double travel =
        dt * bodies.velocity[row].norm() + turn_[row] + fall * std::abs(bodies.weight_factor[row]);
    reach_[row] = {radius, std::min(margin_safety * travel + least_margin * radius, world.contact_margin)};
  }
  wall_normals_.clear();
  for (std::size_t row = count; row < bodies.size(); ++row)
    wall_normals_.push_back(bodies.orientation[row] *
                            std::get<HalfSpace>(world.shapes[bodies.shape[row]]).normal);
}

double DetectContacts::pair_margin(const World& world, const BodySet& bodies, const CandidatePair& p,
                                   double dt) const {
  const bool wall = is_wall(bodies.id[p.row_b]);
  const double approach = dt * (bodies.velocity[p.row_b] - bodies.velocity[p.row_a]).norm();
  const double turn = turn_[p.row_a] + (wall ? 0.0 : turn_[p.row_b]);
  const double fall =
      dt * dt * world.gravity.norm() *
      (std::abs(bodies.weight_factor[p.row_a]) + (wall ? 0.0 : std::abs(bodies.weight_factor[p.row_b])));
  const double least = least_margin * (reach_[p.row_a].radius + (wall ? 0.0 : reach_[p.row_b].radius));
  return std::min(margin_safety * (approach + turn + fall) + least, world.contact_margin);
}

bool DetectContacts::parts_apart(const ShapeParts& a, std::size_t i, const Pose& pose_a, const ShapeParts& b,
                                 std::size_t j, const Pose& pose_b, double margin) const {
  const Vec3 centre_a = pose_a.to_world(a.parts[i].pose.position);
  if (b.half_space) {
    const Vec3 normal = pose_b.orientation * std::get<HalfSpace>(b.parts[j].shape).normal;
    return normal.dot(centre_a - pose_b.position) > a.radii[i] + margin;
  }
  const double range = a.radii[i] + b.radii[j] + margin;
  if ((pose_b.to_world(b.parts[j].pose.position) - centre_a).squaredNorm() > range * range) return true;
  const BoundingBox box_a = part_box(a.parts[i], pose_a), box_b = part_box(b.parts[j], pose_b);
  return ((box_a.lower - box_b.upper).array() > margin).any() ||
         ((box_b.lower - box_a.upper).array() > margin).any();
}

/// By their speeds relative to each other; the broad phase knew only each body's own.
bool DetectContacts::bodies_apart(const BodySet& bodies, const CandidatePair& p, const Vec3& from_a_to_b,
                                  double margin) const {
  const double range = reach_[p.row_a].radius + reach_[p.row_b].radius + margin;
  if (from_a_to_b.squaredNorm() > range * range) return true;
  if (shapes_[bodies.shape[p.row_a]].sphere || shapes_[bodies.shape[p.row_b]].sphere) return false;
  const BoundingBox &a = boxes_[p.row_a], &b = boxes_[p.row_b];
  return ((from_a_to_b + b.lower - a.upper).array() > margin).any() ||
         ((a.lower - b.upper - from_a_to_b).array() > margin).any();
}

void DetectContacts::collide_pair(const World& world, const BodySet& bodies, const BodyExchange& exchange,
                                  CollisionBackend& backend, const CandidatePair& p, const Vec3& from_a_to_b,
                                  double margin, std::vector<Contact>& contacts) {
  const ShapeParts &a = shapes_[bodies.shape[p.row_a]], &b = shapes_[bodies.shape[p.row_b]];
  const Pose pose_a{Vec3::Zero(), bodies.orientation[p.row_a]},
      pose_b{from_a_to_b, bodies.orientation[p.row_b]};
  const bool single = a.parts.size() == 1 && b.parts.size() == 1;
  const Material& material = world.pair(bodies.material[p.row_a], bodies.material[p.row_b]);
  const std::size_t first = contacts.size();
  std::size_t deepest = first;
  for (std::size_t i = 0; i < a.parts.size(); ++i)
    for (std::size_t j = 0; j < b.parts.size(); ++j) {
      if (!single && parts_apart(a, i, pose_a, b, j, pose_b, margin)) continue;
      points_.clear();
      backend.collide(a.parts[i].shape, a.plain ? pose_a : pose_a * a.parts[i].pose, b.parts[j].shape,
                      b.plain ? pose_b : pose_b * b.parts[j].pose, margin, points_);
      reduce_manifold(points_);
      for (const ContactPoint& point : points_) {
        // one common point for both, midway, so that friction keeps angular momentum; a wall has none to keep
        const Vec3 common = b.half_space ? point.on_a : Vec3(0.5 * (point.on_a + point.on_b));
        contacts.push_back({bodies.id[p.row_a], bodies.id[p.row_b], p.image,
                            packed_feature(i, j, point.feature), point.normal, point.gap, common,
                            common - from_a_to_b, material.restitution, material.friction});
        if (point.gap < contacts[deepest].gap) deepest = contacts.size() - 1;
      }
    }
  if (contacts.size() == first) return;
  const Vec3 reference = into_domain(exchange.extent(), bodies.position[p.row_a] + contacts[deepest].r_a);
  if (!exchange.owns_contact_at(reference)) contacts.resize(first);
}

std::size_t DetectContacts::operator()(const World& world, const BodySet& bodies,
                                       const BodyExchange& exchange, CollisionBackend& backend, double dt,
                                       std::vector<Contact>& contacts) {
  contacts.clear();
  learn_shapes(world);
  set_reach(world, bodies, dt);
  (*broad_phase_)(bodies, exchange.extent(), reach_, wall_normals_, pairs_);
  for (const CandidatePair& p : pairs_) {
    const double margin = pair_margin(world, bodies, p, dt);
    // relative to a: small numbers, and the same ones on every rank
    const Vec3 from_a_to_b =
        bodies.position[p.row_b] + exchange.extent().shift(p.image) - bodies.position[p.row_a];
    if (!is_wall(bodies.id[p.row_b]) && bodies_apart(bodies, p, from_a_to_b, margin)) continue;
    collide_pair(world, bodies, exchange, backend, p, from_a_to_b, margin, contacts);
  }
  return pairs_.size();
}

}  // namespace silt::rigid
