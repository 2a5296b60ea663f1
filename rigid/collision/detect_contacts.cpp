#include "rigid/collision/detect_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigid/collision/manifold.hpp"
#include "rigid/collision/mesh_contacts.hpp"
#include "rigid/collision/mesh_features.hpp"
#include "rigid/collision/shape_parts.hpp"
#include "rigid/collision/tube_contacts.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

namespace {

/// Factor on the approach, whose speeds are those before gravity, forces and contacts.
constexpr double margin_safety = 1.5;
/// Least margins relative to the bounding radius, to detect resting contacts, and cohesive ones that open.
constexpr double least_margin = 1e-6, least_margin_of_cohesion = 1e-4;

/// Sets the arms, which reach to either body's surface, to the point of action (method.md, C3a).
void set_arms(const BodySet& bodies, const CandidatePair& p, const Vec3& across, Contact& c) {
  const bool a_moves = bodies.is_dynamic(p.row_a), b_moves = bodies.is_dynamic(p.row_b);
  if (!c.lubrication && !(a_moves && b_moves)) return;
  const double mass_a = bodies.mass[p.row_a], mass_b = bodies.mass[p.row_b];
  const double share = !b_moves ? 0 : !a_moves ? 1 : c.lubrication ? 0.5 : mass_a / (mass_a + mass_b);
  c.r_a += share * across;
  c.r_b -= (1 - share) * across;
}

/// Walls other than meshes rotate in their own surface, so their normals are constant.
NormalTurns normal_turns(const ShapeParts& a, const ShapeParts& b) {
  using enum NormalTurns;
  if (b.half_space || b.tube) return never;
  if (a.sphere) return b.sphere ? with_centres : with_b;
  return b.sphere ? with_a : with_both;
}

/// Returns the canonical position, moved into the domain if a contact point lies behind a wall.
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

void DetectContacts::prepare_shapes(const World& world) {
  for (std::size_t s = shapes_.size(); s < world.shapes.size(); ++s) {
    shapes_.emplace_back(world.shapes[s], world.lubrication || world.needs_radii());
    with_meshes_ |= shapes_.back().mesh != nullptr;
  }
  if (!with_meshes_) return;
  for (ShapeParts& shape : shapes_)
    for (std::size_t i = shape.surfaces.size(); i < shape.parts.size(); ++i)
      shape.surfaces.push_back(features_of_polytope(shape.parts[i].shape));
}

void DetectContacts::set_reach(const World& world, const BodySet& bodies, double dt) {
  const std::size_t count = bodies.first_wall();
  reach_.resize(count), turn_.resize(count), boxes_.resize(count);
  const double fall = dt * dt * world.gravity.norm();
  least_margin_ = least_margin;
  for (const Material& material : world.materials)
    if (material.pulls()) least_margin_ = least_margin_of_cohesion;
  pull_reach_ = world.van_der_waals_reach();
  for (std::size_t row = 0; row < count; ++row) {
    const std::uint32_t number = bodies.shape[row];
    const ShapeParts& shape = shapes_[number];
    const double radius = world.bounding_radii[number];
    turn_[row] = shape.sphere ? 0.0 : dt * radius * bodies.angular_velocity[row].norm();
    if (!shape.sphere)
      boxes_[row] = bounding_box(world.shapes[number], {Vec3::Zero(), bodies.orientation[row]});
    const double travel =
        dt * bodies.velocity[row].norm() + turn_[row] + fall * std::abs(bodies.weight_in_fluid[row]);
    double margin = std::min(margin_safety * travel + least_margin_ * radius, world.contact_margin);
    if (world.lubrication && (shape.smooth || shape.mesh))
      margin = std::max(margin, world.lubrication->reach());
    reach_[row] = {radius, std::max(margin, pull_reach_)};
  }
  walls_.clear();
  for (std::size_t row = count; row < bodies.size(); ++row) {
    const ShapeParts& shape = shapes_[bodies.shape[row]];
    if (shape.mesh)
      walls_.push_back(WallSurface::unreachable());
    else if (shape.tube)
      walls_.push_back({.tube = shape.tube, .pose = bodies.pose(row)});
    else
      walls_.push_back(
          {bodies.position[row], bodies.orientation[row] * std::get<HalfSpace>(shape.parts[0].shape).normal});
  }
}

/// Returns a point near both bodies for any overlap, so that every rank that tests it holds both: the middle
/// of a gap, or the surface point of the smaller body in an overlap.
Vec3 DetectContacts::point_near_both(const Pair& p, const ContactPoint& point) const {
  if (point.gap >= 0) return 0.5 * (point.on_a + point.on_b);
  const bool b_is_smaller =
      !is_wall(p.call.bodies.id[p.row_b]) && reach_[p.row_a].radius > reach_[p.row_b].radius;
  return b_is_smaller ? point.on_b : point.on_a;
}

double DetectContacts::pair_margin(const Call& call, const CandidatePair& p, const Vec3& shift) const {
  const auto& [world, bodies, exchange, backend, dt] = call;
  const bool wall = is_wall(bodies.id[p.row_b]);
  const bool turns = wall && shapes_[bodies.shape[p.row_b]].mesh;  // other walls rotate in their own surface
  const Vec3 arm = turns ? Vec3(bodies.position[p.row_a] - bodies.position[p.row_b] - shift) : Vec3::Zero();
  const double approach = dt * (bodies.velocity_at(p.row_b, arm) - bodies.velocity[p.row_a]).norm();
  const double turn =
      turn_[p.row_a] + (turns  ? dt * bodies.angular_velocity[p.row_b].norm() * reach_[p.row_a].radius
                        : wall ? 0.0
                               : turn_[p.row_b]);
  const double fall =
      dt * dt * world.gravity.norm() *
      (std::abs(bodies.weight_in_fluid[p.row_a]) + (wall ? 0.0 : std::abs(bodies.weight_in_fluid[p.row_b])));
  const double least = least_margin_ * (reach_[p.row_a].radius + (wall ? 0.0 : reach_[p.row_b].radius));
  const double margin =
      std::max(std::min(margin_safety * (approach + turn + fall) + least, world.contact_margin), pull_reach_);
  if (!world.lubrication || !may_lubricate(shapes_[bodies.shape[p.row_a]], shapes_[bodies.shape[p.row_b]]))
    return margin;
  return std::max(margin, world.lubrication->reach());
}

bool DetectContacts::pieces_apart(const Piece& a, const Piece& b, double margin) {
  if (a.of->mesh || b.of->mesh) return false;
  const Vec3& centre_a = a.pose.position;
  const double radius_a = a.of->radii[a.index];
  if (b.of->tube) return b.of->tube->gap(b.pose, centre_a) > radius_a + margin;
  if (b.of->half_space) {
    const Vec3 normal = b.pose.orientation * std::get<HalfSpace>(b.of->parts[b.index].shape).normal;
    return normal.dot(centre_a - b.pose.position) > radius_a + margin;
  }
  const double range = radius_a + b.of->radii[b.index] + margin;
  if ((b.pose.position - centre_a).squaredNorm() > range * range) return true;
  const auto box_of = [](const Piece& p) {
    return std::visit([&](const auto& s) { return s.bounding_box(p.pose); }, p.of->parts[p.index].shape);
  };
  const BoundingBox box_a = box_of(a), box_b = box_of(b);
  return ((box_a.lower - box_b.upper).array() > margin).any() ||
         ((box_b.lower - box_a.upper).array() > margin).any();
}

/// Tests with the bodies' relative velocity; the broad phase only used each body's own speed.
bool DetectContacts::bodies_apart(const Pair& p) const {
  const auto& shape = p.call.bodies.shape;
  const double range = reach_[p.row_a].radius + reach_[p.row_b].radius + p.margin;
  if (p.from_a_to_b.squaredNorm() > range * range) return true;
  if (shapes_[shape[p.row_a]].sphere || shapes_[shape[p.row_b]].sphere) return false;
  const BoundingBox &a = boxes_[p.row_a], &b = boxes_[p.row_b];
  return ((p.from_a_to_b + b.lower - a.upper).array() > p.margin).any() ||
         ((a.lower - b.upper - p.from_a_to_b).array() > p.margin).any();
}

/// Fills points_ with the contact points of one piece of each body.
void DetectContacts::collide_pieces(const Pair& p, const Piece& a, const Piece& b) {
  points_.clear();
  CollisionBackend& backend = p.call.backend;
  const auto shape_of = [](const Piece& piece) -> const ConvexShape& {
    return piece.of->parts[piece.index].shape;
  };
  const auto convex_at = [&](const Piece& piece) {
    return ConvexAt{shape_of(piece), piece.of->surfaces[piece.index].get(), piece.pose};
  };
  const auto mesh_at = [](const Piece& piece) { return MeshAt{*piece.of->mesh, piece.pose}; };
  if (!a.of->mesh && !b.of->mesh) {
    if (b.of->tube)
      append_tube_contacts(shape_of(a), a.pose, *b.of->tube, b.pose, p.margin, points_);
    else
      backend.collide(shape_of(a), a.pose, shape_of(b), b.pose, p.margin, points_);
    reduce_manifold(points_);
  } else if (!a.of->mesh) {
    append_mesh_contacts(convex_at(a), mesh_at(b), p.margin, backend, points_);
  } else if (b.of->mesh) {
    append_mesh_contacts(mesh_at(a), mesh_at(b), p.margin, backend, points_);
  } else if (b.of->tube) {
    append_mesh_contacts(mesh_at(a), *b.of->tube, b.pose, p.margin, points_);
  } else if (b.of->half_space) {
    append_mesh_contacts(mesh_at(a), std::get<HalfSpace>(shape_of(b)), b.pose, p.margin, points_);
  } else {
    append_mesh_contacts(convex_at(b), mesh_at(a), p.margin, backend, points_);
    for (ContactPoint& point : points_) std::swap(point.on_a, point.on_b), point.normal = -point.normal;
  }
}

void DetectContacts::collide_pair(const Pair& p, std::vector<Contact>& contacts) {
  const World& world = p.call.world;
  const BodySet& bodies = p.call.bodies;
  const ShapeParts &a = shapes_[bodies.shape[p.row_a]], &b = shapes_[bodies.shape[p.row_b]];
  const Pose pose_a{Vec3::Zero(), bodies.orientation[p.row_a]},
      pose_b{p.from_a_to_b, bodies.orientation[p.row_b]};
  const bool single = a.pieces() == 1 && b.pieces() == 1, with_mesh = a.mesh || b.mesh;
  const Material& material = world.pair(bodies.material[p.row_a], bodies.material[p.row_b]);
  const bool with_radii = material.needs_radii();
  const LubricationLaw* const lubrication = may_lubricate(a, b) ? world.lubrication.get() : nullptr;
  const std::size_t first = contacts.size();
  double least_gap = std::numeric_limits<double>::infinity();
  Vec3 narrowest = Vec3::Zero();  // point near both bodies at the least gap
  pieces_of_b_.clear();
  for (std::size_t j = 0; j < b.pieces(); ++j) pieces_of_b_.push_back({&b, j, b.pose_of(j, pose_b)});
  for (std::size_t i = 0; i < a.pieces(); ++i) {
    const Piece of_a{&a, i, a.pose_of(i, pose_a)};
    for (const Piece& of_b : pieces_of_b_) {
      if (!single && pieces_apart(of_a, of_b, p.margin)) continue;
      collide_pieces(p, of_a, of_b);
      const std::size_t first_of_pieces = contacts.size();
      for (const ContactPoint& point : points_) {
        const std::uint64_t feature = with_mesh ? packed_mesh_feature(i + of_b.index, point.feature)
                                                : packed_feature(i, of_b.index, point.feature);
        contacts.push_back({.a = bodies.id[p.row_a],
                            .b = bodies.id[p.row_b],
                            .image = p.image,
                            .feature = feature,
                            .normal = point.normal,
                            .gap = point.gap,
                            .r_a = point.on_a,
                            .r_b = point.on_b - p.from_a_to_b,
                            .restitution = material.restitution,
                            .friction = material.friction});
        if (lubrication && point.gap < lubrication->reach() && has_lubrication(point, with_mesh))
          add_lubrication(p, of_a, of_b, point, contacts.back());
        if (with_radii) contacts.back().radii = radii_of(p, of_a, of_b, point);
        set_arms(bodies, p, point.on_b - point.on_a, contacts.back());
        if (material.pulls()) contacts.back().normal_turns = normal_turns(a, b);
        if (point.gap < least_gap) least_gap = point.gap, narrowest = point_near_both(p, point);
      }
      set_separating_normals(p, of_a, of_b, std::span(contacts).subspan(first_of_pieces));
    }
  }
  if (contacts.size() == first) return;
  const Vec3 reference = into_domain(p.call.exchange.extent(), bodies.position[p.row_a] + narrowest);
  if (!p.call.exchange.owns_contact_at(reference)) contacts.resize(first);
  for (const Contact& c : std::span(contacts).subspan(first))
    if (world.lubrication && c.gap < world.lubrication->reach())
      ++(c.lubrication ? lubrication_counts_.with : lubrication_counts_.without);
}

/// Replaces the normal of contacts between two pieces that pass each other without touching: each contact,
/// point by point in points_, that would act nevertheless gets the normal of the plane between them.
void DetectContacts::set_separating_normals(const Pair& p, const Piece& a, const Piece& b,
                                            std::span<Contact> of_pieces) const {
  if (a.of->sphere || b.of->sphere || b.of->half_space || b.of->tube) return;
  const BodySet& bodies = p.call.bodies;
  const double slack = separation_slack * (reach_[p.row_a].radius +
                                           (is_wall(bodies.id[p.row_b]) ? 0.0 : reach_[p.row_b].radius));
  std::optional<SeparatingPlane> found;
  bool searched = false;
  for (std::size_t k = 0; k < of_pieces.size(); ++k) {
    Contact& c = of_pieces[k];
    const ContactPoint& point = points_[k];
    const Vec3 motion = p.call.dt * (bodies.velocity_at(p.row_b, c.r_b) - bodies.velocity_at(p.row_a, c.r_a));
    if (c.lubrication || c.gap < -slack || c.gap + c.normal.dot(motion) >= -slack) continue;
    if (!searched || a.of->mesh || b.of->mesh)
      found = find_separating_plane(p, a, b, point, std::abs(c.gap) + motion.norm() + slack);
    searched = true;
    if (!found) continue;
    c.normal = found->normal;
    c.gap = std::min(found->front_b - c.normal.dot(point.on_a), c.normal.dot(point.on_b) - found->front_a);
  }
}

std::optional<SeparatingPlane> DetectContacts::find_separating_plane(const Pair& p, const Piece& a,
                                                                     const Piece& b,
                                                                     const ContactPoint& point,
                                                                     double reach) const {
  const BodySet& bodies = p.call.bodies;
  const double dt = p.call.dt;
  const auto moving = [&](const Piece& piece, std::size_t row, const Vec3& position, std::uint32_t code) {
    const ConvexShape* convex = piece.of->mesh ? nullptr : &piece.of->parts[piece.index].shape;
    const Vec3 fall = bodies.is_dynamic(row)
                          ? Vec3(dt * dt * bodies.weight_in_fluid[row] * p.call.world.gravity)
                          : Vec3(Vec3::Zero());
    Pose after{position + dt * bodies.velocity[row],
               (cayley(dt * bodies.angular_velocity[row]) * bodies.orientation[row]).normalized()};
    MovingPart part{convex, piece.of->mesh.get(), code, piece.pose, piece.of->pose_of(piece.index, after), {},
                    fall};
    after.position += fall;
    part.fallen = piece.of->pose_of(piece.index, after);
    return part;
  };
  return separating_plane(moving(a, p.row_a, Vec3::Zero(), code_of_a(b, point)),
                          moving(b, p.row_b, p.from_a_to_b, feature_of(point.feature)), point.on_a, reach);
}

/// Returns the displacement from a to b, computed bitwise the same on every rank from small numbers. Of a
/// tube the point of the axis next to a is taken.
Vec3 DetectContacts::displacement_to(const Call& call, const CandidatePair& p) const {
  const BodySet& bodies = call.bodies;
  const Vec3 displacement =
      bodies.position[p.row_b] + call.exchange.extent().shift(p.image) - bodies.position[p.row_a];
  if (!shapes_[bodies.shape[p.row_b]].tube) return displacement;
  const Vec3 axis = bodies.orientation[p.row_b] * Vec3::UnitZ();
  return displacement - axis.dot(displacement) * axis;
}

/// Adds the free bodies near the box of each wall that is a mesh. The broad phase leaves these out: a mesh
/// may be as large as the domain and move, while only few triangles, which its tree finds, are near a body.
void DetectContacts::add_mesh_walls(const Call& call) {
  const BodySet& bodies = call.bodies;
  const Extent& extent = call.exchange.extent();
  const auto first = static_cast<std::ptrdiff_t>(pairs_.size());
  for (std::size_t wall = bodies.first_wall(); wall < bodies.size(); ++wall) {
    const auto& mesh = shapes_[bodies.shape[wall]].mesh;
    if (!mesh) continue;
    const BoundingBox box =
        Mesh{mesh->mesh().surface}.bounding_box(bodies.pose(wall));  // finite if hollow, too
    for (const Image image : images_of(extent))
      for (std::size_t row = 0; row < bodies.first_wall(); ++row) {
        if (!bodies.is_dynamic(row)) continue;
        const CandidatePair p{row, wall, image};
        const Vec3 shift = extent.shift(image), x = bodies.position[row] - shift;
        const double reach = reach_[row].radius + pair_margin(call, p, shift);
        const double beyond = (box.lower - x).cwiseMax(x - box.upper).maxCoeff();
        if (beyond <= reach) pairs_.push_back(p);
      }
  }
  const auto before = pair_order([&](std::size_t row) { return bodies.id[row]; });
  std::sort(pairs_.begin() + first, pairs_.end(), before);
  std::inplace_merge(pairs_.begin(), pairs_.begin() + first, pairs_.end(), before);
}

std::size_t DetectContacts::operator()(const World& world, const BodySet& bodies,
                                       const BodyExchange& exchange, CollisionBackend& backend, double dt,
                                       std::vector<Contact>& contacts) {
  contacts.clear(), lubrication_counts_ = {};
  prepare_shapes(world);
  set_reach(world, bodies, dt);
  const Call call{world, bodies, exchange, backend, dt};
  (*broad_phase_)(bodies, exchange.extent(), reach_, walls_, pairs_);
  if (with_meshes_) add_mesh_walls(call);
  for (const CandidatePair& p : pairs_) {
    const Pair pair{p, call, displacement_to(call, p),
                    pair_margin(call, p, exchange.extent().shift(p.image))};
    if (!is_wall(bodies.id[p.row_b]) && bodies_apart(pair)) continue;
    collide_pair(pair, contacts);
  }
  return pairs_.size();
}

}  // namespace silt::rigid
