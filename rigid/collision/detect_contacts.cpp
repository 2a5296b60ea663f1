#include "rigid/collision/detect_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "rigid/collision/reduce_manifold.hpp"
#include "rigid/collision/tube_contacts.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

struct DetectContacts::ShapeParts {
  std::vector<Part> parts;
  std::vector<double> radii;  // of the parts' bounding spheres, about the parts' own origins
  bool sphere, half_space;
  std::optional<Tube> tube;  // then there are no parts
  bool plain;                // one part, whose pose is the body's
  bool smooth;               // some part of it: lubrication films may form there
};

namespace {

/// Approach speeds are those before the kick and before contacts; some room for what these two add.
constexpr double margin_safety = 1.5;
/// Keeps resting contacts in sight, relative to the bounding radius.
constexpr double least_margin = 1e-6;
/// Least ratio of a gap's lesser curvature to the greater: below, it is a line contact, which the laws of
/// lubrication do not know.
constexpr double least_roundness = 0.02;

/// Canonical and inside the domain also where a contact point lies behind a wall.
Vec3 into_domain(const Extent& extent, Vec3 x) {
  std::array<std::int32_t, 3> image{};
  extent.wrap(x, image);
  for (int d = 0; d < 3; ++d)
    if (!extent.periodic[d]) x[d] = std::clamp(x[d], 0.0, std::nextafter(extent.size[d], 0.0));
  return x;
}

}  // namespace

DetectContacts::DetectContacts(std::unique_ptr<BroadPhase> broad_phase)
    : broad_phase_(std::move(broad_phase)) {}
DetectContacts::DetectContacts(DetectContacts&&) noexcept = default;
DetectContacts::~DetectContacts() = default;

void DetectContacts::learn_shapes(const World& world) {
  for (std::size_t s = shapes_.size(); s < world.shapes.size(); ++s) {
    ShapeParts known;
    known.parts = convex_parts(world.shapes[s]);
    for (const Part& part : known.parts)
      known.radii.push_back(bounding_radius(Compound{{{part.shape, Pose{}}}}));
    known.smooth = std::any_of(known.parts.begin(), known.parts.end(),
                               [](const Part& part) { return is_smooth(part.shape); });
    known.sphere = is_sphere(world.shapes[s]);
    known.half_space = std::holds_alternative<HalfSpace>(world.shapes[s]);
    if (const auto* tube = std::get_if<Tube>(&world.shapes[s])) known.tube = *tube;
    const Pose pose = known.tube ? Pose{} : known.parts[0].pose;
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
        dt * bodies.velocity[row].norm() + turn_[row] + fall * std::abs(bodies.weight_in_fluid[row]);
    double margin = std::min(margin_safety * travel + least_margin * radius, world.contact_margin);
    if (world.lubrication && shapes_[bodies.shape[row]].smooth)
      margin = std::max(margin, world.lubrication->reach());
    reach_[row] = {radius, margin};
  }
  walls_.clear();
  for (std::size_t row = count; row < bodies.size(); ++row) {
    const Shape& shape = world.shapes[bodies.shape[row]];
    const Quat& turn = bodies.orientation[row];
    if (const auto* tube = std::get_if<Tube>(&shape))
      walls_.push_back({bodies.position[row], turn * Vec3::UnitZ(), tube->radius});
    else
      walls_.push_back({bodies.position[row], turn * std::get<HalfSpace>(shape).normal});
  }
}

double DetectContacts::pair_margin(const World& world, const BodySet& bodies, const CandidatePair& p,
                                   double dt) const {
  const bool wall = is_wall(bodies.id[p.row_b]);
  const double approach = dt * (bodies.velocity[p.row_b] - bodies.velocity[p.row_a]).norm();
  const double turn = turn_[p.row_a] + (wall ? 0.0 : turn_[p.row_b]);
  const double fall =
      dt * dt * world.gravity.norm() *
      (std::abs(bodies.weight_in_fluid[p.row_a]) + (wall ? 0.0 : std::abs(bodies.weight_in_fluid[p.row_b])));
  const double least = least_margin * (reach_[p.row_a].radius + (wall ? 0.0 : reach_[p.row_b].radius));
  const double margin = std::min(margin_safety * (approach + turn + fall) + least, world.contact_margin);
  const auto smooth = [&](std::size_t row) { return shapes_[bodies.shape[row]].smooth; };
  if (!world.lubrication || !smooth(p.row_a) || !smooth(p.row_b)) return margin;
  return std::max(margin, world.lubrication->reach());
}

bool DetectContacts::parts_apart(const ShapeParts& a, std::size_t i, const Pose& pose_a, const ShapeParts& b,
                                 std::size_t j, const Pose& pose_b, double margin) const {
  const Vec3 centre_a = pose_a.to_world(a.parts[i].pose.position);
  if (b.tube) return signed_distance(*b.tube, pose_b.to_body(centre_a)) > a.radii[i] + margin;
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

/// Where both surfaces are smooth and curve away from each other.
void DetectContacts::put_lubrication(const Call& call, const CandidatePair& p, const PosedPart& a,
                                     const PosedPart& b, const ContactPoint& point, Contact& c) const {
  const BodySet& bodies = call.bodies;
  const Vec3& n = point.normal;
  const auto curvature_W = [](const PosedPart& part, const Vec3& x,
                              const Vec3& outward) -> std::optional<Mat3> {
    const Mat3 r = part.pose.orientation.toRotationMatrix();
    const auto k = curvature(part.shape, part.pose.to_body(x), r.transpose() * outward);
    if (!k) return std::nullopt;
    return r * *k * r.transpose();
  };
  const auto of_a = curvature_W(a, point.on_a, n), of_b = curvature_W(b, point.on_b, -n);
  if (!of_a || !of_b) return;
  const double opening = n.dot(bodies.velocity_at(p.row_b, c.r_b) - bodies.velocity_at(p.row_a, c.r_a));
  const Vec3 middle = bodies.position[p.row_a] + 0.5 * (point.on_a + point.on_b);
  const LubricatedGap gap{
      point.gap, call.dt * opening, *of_a, *of_b, middle, n, shapes_[bodies.shape[p.row_b]].half_space};
  const double sum = gap.curvature_sum();
  if (gap.curvature_product() >= least_roundness * sum * sum) c.lubrication = (*call.world.lubrication)(gap);
  if (c.lubrication) c.feature |= lubrication_feature;
}

/// Fills points_ with those of a part of one body and a part or the tube of the other.
void DetectContacts::collide_parts(const PosedPart& a, const ShapeParts& b, std::size_t j, const Pose& pose_b,
                                   double margin, CollisionBackend& backend) {
  points_.clear();
  if (b.tube)
    append_tube_contacts(a.shape, a.pose, *b.tube, pose_b, margin, points_);
  else
    backend.collide(a.shape, a.pose, b.parts[j].shape, pose_b, margin, points_);
  reduce_manifold(points_);
}

void DetectContacts::collide_pair(const Call& call, const CandidatePair& p, const Vec3& from_a_to_b,
                                  double margin, std::vector<Contact>& contacts) {
  const World& world = call.world;
  const BodySet& bodies = call.bodies;
  const ShapeParts &a = shapes_[bodies.shape[p.row_a]], &b = shapes_[bodies.shape[p.row_b]];
  const Pose pose_a{Vec3::Zero(), bodies.orientation[p.row_a]},
      pose_b{from_a_to_b, bodies.orientation[p.row_b]};
  const std::size_t parts_b = b.tube ? 1 : b.parts.size();
  const bool single = a.parts.size() == 1 && parts_b == 1;
  const Material& material = world.pair(bodies.material[p.row_a], bodies.material[p.row_b]);
  const LubricationLaw* const lubrication = a.smooth && b.smooth ? world.lubrication.get() : nullptr;
  const std::size_t first = contacts.size();
  std::size_t deepest = first;
  for (std::size_t i = 0; i < a.parts.size(); ++i)
    for (std::size_t j = 0; j < parts_b; ++j) {
      if (!single && parts_apart(a, i, pose_a, b, j, pose_b, margin)) continue;
      const Pose part_a = a.plain ? pose_a : pose_a * a.parts[i].pose;
      const Pose part_b = b.tube || b.plain ? pose_b : pose_b * b.parts[j].pose;
      collide_parts({a.parts[i].shape, part_a}, b, j, part_b, margin, call.backend);
      for (const ContactPoint& point : points_) {
        // one common point for both, midway, so that friction keeps angular momentum; a wall has none to keep
        const Vec3 common = b.half_space || b.tube ? point.on_a : Vec3(0.5 * (point.on_a + point.on_b));
        contacts.push_back({bodies.id[p.row_a], bodies.id[p.row_b], p.image,
                            packed_feature(i, j, point.feature), point.normal, point.gap, common,
                            common - from_a_to_b, material.restitution, material.friction});
        if (lubrication && points_.size() == 1 && point.gap < lubrication->reach())
          put_lubrication(call, p, {a.parts[i].shape, part_a}, {b.parts[j].shape, part_b}, point,
                          contacts.back());
        if (point.gap < contacts[deepest].gap) deepest = contacts.size() - 1;
      }
    }
  if (contacts.size() == first) return;
  const Vec3 reference =
      into_domain(call.exchange.extent(), bodies.position[p.row_a] + contacts[deepest].r_a);
  if (!call.exchange.owns_contact_at(reference)) contacts.resize(first);
  if (world.lubrication) count_lubrication(*world.lubrication, std::span(contacts).subspan(first));
}

void DetectContacts::count_lubrication(const LubricationLaw& law, std::span<const Contact> contacts) {
  for (const Contact& c : contacts)
    if (c.gap < law.reach()) ++(c.lubrication ? lubrication_counts_.with : lubrication_counts_.without);
}

/// From a to b: small numbers, and the same ones on every rank. A tube is alike all along its axis: it is
/// taken where a is abreast of it.
Vec3 DetectContacts::displacement_to(const World& world, const BodySet& bodies, const Extent& extent,
                                     const CandidatePair& p) const {
  const Vec3 displacement = bodies.position[p.row_b] + extent.shift(p.image) - bodies.position[p.row_a];
  if (!std::holds_alternative<Tube>(world.shapes[bodies.shape[p.row_b]])) return displacement;
  const Vec3 axis = bodies.orientation[p.row_b] * Vec3::UnitZ();
  return displacement - axis.dot(displacement) * axis;
}

std::size_t DetectContacts::operator()(const World& world, const BodySet& bodies,
                                       const BodyExchange& exchange, CollisionBackend& backend, double dt,
                                       std::vector<Contact>& contacts) {
  contacts.clear();
  lubrication_counts_ = {};
  learn_shapes(world);
  set_reach(world, bodies, dt);
  const Call call{world, bodies, exchange, backend, dt};
  (*broad_phase_)(bodies, exchange.extent(), reach_, walls_, pairs_);
  for (const CandidatePair& p : pairs_) {
    const double margin = pair_margin(world, bodies, p, dt);
    const Vec3 from_a_to_b = displacement_to(world, bodies, exchange.extent(), p);
    if (!is_wall(bodies.id[p.row_b]) && bodies_apart(bodies, p, from_a_to_b, margin)) continue;
    collide_pair(call, p, from_a_to_b, margin, contacts);
  }
  return pairs_.size();
}

}  // namespace silt::rigid
