#include "rigid/collision/detect_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigid/collision/facet_curvature.hpp"
#include "rigid/collision/hollow_contacts.hpp"
#include "rigid/collision/manifold.hpp"
#include "rigid/collision/mesh_contacts.hpp"
#include "rigid/math/twist.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

struct DetectContacts::ShapeParts {
  std::vector<Part> parts;
  std::vector<double> radii;  // of the parts' bounding spheres, about the parts' own origins
  bool sphere, half_space;
  std::optional<HollowShape> hollow;                          // then there are no parts
  std::shared_ptr<const MeshFeatures> mesh;                   // nor here
  std::shared_ptr<const FacetCurvature> facets;               // of the mesh, where there is lubrication
  std::vector<std::shared_ptr<const MeshFeatures>> surfaces;  // of the parts that are polytopes, for meshes
  bool plain;                                                 // one part, whose pose is the body's
  bool smooth;  // some part of it: lubrication films may form there

  std::size_t pieces() const { return hollow || mesh ? 1 : parts.size(); }
  Pose pose_of(std::size_t piece, const Pose& body) const {
    return hollow || mesh || plain ? body : body * parts[piece].pose;
  }
  ConvexPart part_with_surface(std::size_t i) const { return {parts[i].shape, surfaces[i].get()}; }
};

namespace {

/// Approach speeds are those before the kick and before contacts; some room for what these two add.
constexpr double margin_safety = 1.5;
/// Keeps resting contacts in sight, relative to the bounding radius.
constexpr double least_margin = 1e-6;
/// Least ratio of a gap's lesser curvature to the greater: below, it is a line contact, which the laws of
/// lubrication do not know.
constexpr double least_roundness = 0.02;

/// Cosine of the angle up to which the normals of one gap differ.
constexpr double same_gap = 0.95;

/// Of a contact whose arms reach to either body's own surface: puts them where its impulse acts
/// (rigid/README.md, The arms).
void set_arms(const BodySet& bodies, const CandidatePair& p, const ContactPoint& point, Contact& c) {
  const bool a_moves = bodies.is_dynamic(p.row_a), b_moves = bodies.is_dynamic(p.row_b);
  if (!c.lubrication && !(a_moves && b_moves)) return;
  const double mass_a = bodies.mass[p.row_a], mass_b = bodies.mass[p.row_b];
  const double share = !b_moves ? 0 : !a_moves ? 1 : c.lubrication ? 0.5 : mass_a / (mass_a + mass_b);
  const Vec3 across = point.on_b - point.on_a;
  c.r_a += share * across;
  c.r_b -= (1 - share) * across;
}

/// Canonical and inside the domain also where a contact point lies behind a wall.
Vec3 into_domain(const Extent& extent, Vec3 x) {
  std::array<std::int32_t, 3> image{};
  extent.wrap(x, image);
  for (int d = 0; d < 3; ++d)
    if (!extent.periodic[d]) x[d] = std::clamp(x[d], 0.0, std::nextafter(extent.size[d], 0.0));
  return x;
}

/// Those that a body may meet a wall through.
std::vector<Image> images(const Extent& extent) {
  std::vector<Image> all;
  const auto last = [&](int d) -> std::int8_t { return extent.periodic[d] ? 1 : 0; };
  for (std::int8_t x = -last(0); x <= last(0); ++x)
    for (std::int8_t y = -last(1); y <= last(1); ++y)
      for (std::int8_t z = -last(2); z <= last(2); ++z) all.push_back({x, y, z});
  return all;
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
    known.hollow = hollow_of(world.shapes[s]);
    if (const auto* mesh = std::get_if<Mesh>(&world.shapes[s]))
      known.mesh = std::make_shared<const MeshFeatures>(*mesh), with_meshes_ = true;
    if (known.mesh && world.lubrication) known.facets = std::make_shared<const FacetCurvature>(*known.mesh);
    const Pose pose = known.parts.empty() ? Pose{} : known.parts[0].pose;
    known.plain =
        known.parts.size() == 1 && pose.position.isZero(0) && pose.orientation.isApprox(Quat::Identity(), 0);
    shapes_.push_back(std::move(known));
  }
  if (!with_meshes_) return;
  for (ShapeParts& shape : shapes_)
    for (std::size_t i = shape.surfaces.size(); i < shape.parts.size(); ++i)
      shape.surfaces.push_back(features_of_polytope(shape.parts[i].shape));
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
    const ShapeParts& shape = shapes_[bodies.shape[row]];
    if (world.lubrication && (shape.smooth || shape.mesh))
      margin = std::max(margin, world.lubrication->reach());
    reach_[row] = {radius, margin};
  }
  walls_.clear();
  for (std::size_t row = count; row < bodies.size(); ++row) {
    const Shape& shape = world.shapes[bodies.shape[row]];
    const Quat& turn = bodies.orientation[row];
    const bool moves = bodies.is_active(row);
    if (const auto& hollow = shapes_[bodies.shape[row]].hollow)
      walls_.push_back({.moves = moves, .hollow = hollow, .pose = bodies.pose(row)});
    else if (std::holds_alternative<Mesh>(shape))
      walls_.push_back(WallSurface::out_of_sight());
    else
      walls_.push_back({bodies.position[row], turn * std::get<HalfSpace>(shape).normal, moves});
  }
}

/// A point near both bodies, however deep they overlap: the middle of a gap, the surface of the smaller body
/// in an overlap. Whoever looks at it holds both.
Vec3 DetectContacts::point_near_both(const BodySet& bodies, const CandidatePair& p,
                                     const ContactPoint& point) const {
  if (point.gap >= 0) return 0.5 * (point.on_a + point.on_b);
  const bool a_is_smaller = is_wall(bodies.id[p.row_b]) || reach_[p.row_a].radius <= reach_[p.row_b].radius;
  return a_is_smaller ? point.on_a : point.on_b;
}

double DetectContacts::pair_margin(const World& world, const BodySet& bodies, const CandidatePair& p,
                                   const Vec3& shift, double dt) const {
  const bool wall = is_wall(bodies.id[p.row_b]);
  const bool turns = wall && shapes_[bodies.shape[p.row_b]].mesh;  // the others turn in their own surface
  const Vec3 arm = turns ? Vec3(bodies.position[p.row_a] - bodies.position[p.row_b] - shift) : Vec3::Zero();
  const double approach = dt * (bodies.velocity_at(p.row_b, arm) - bodies.velocity[p.row_a]).norm();
  const double turn =
      turn_[p.row_a] + (turns  ? dt * bodies.angular_velocity[p.row_b].norm() * reach_[p.row_a].radius
                        : wall ? 0.0
                               : turn_[p.row_b]);
  const double fall =
      dt * dt * world.gravity.norm() *
      (std::abs(bodies.weight_in_fluid[p.row_a]) + (wall ? 0.0 : std::abs(bodies.weight_in_fluid[p.row_b])));
  const double least = least_margin * (reach_[p.row_a].radius + (wall ? 0.0 : reach_[p.row_b].radius));
  const double margin = std::min(margin_safety * (approach + turn + fall) + least, world.contact_margin);
  if (!world.lubrication || !may_lubricate(shapes_[bodies.shape[p.row_a]], shapes_[bodies.shape[p.row_b]]))
    return margin;
  return std::max(margin, world.lubrication->reach());
}

bool DetectContacts::parts_apart(const ShapeParts& a, std::size_t i, const Pose& pose_a, const ShapeParts& b,
                                 std::size_t j, const Pose& pose_b, double margin) const {
  if (a.mesh || b.mesh) return false;
  const Vec3 centre_a = pose_a.to_world(a.parts[i].pose.position);
  if (b.hollow) return b.hollow->gap(pose_b, centre_a) > a.radii[i] + margin;
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

/// A mesh stands for a smooth surface that it is near to. Of two meshes nothing is known.
bool DetectContacts::may_lubricate(const ShapeParts& a, const ShapeParts& b) {
  const auto any = [](const ShapeParts& s) { return s.smooth || s.mesh || s.hollow; };
  return (a.smooth && any(b)) || (b.smooth && any(a));
}

/// The gap between two convex pieces that touch at one point has a film there. A mesh may touch a body at
/// several points of one gap: its film is where it is narrowest.
bool DetectContacts::has_lubrication(const ContactPoint& point, bool with_mesh) const {
  if (!with_mesh) return points_.size() == 1;
  const auto is_wider_than = [&](const ContactPoint& other) {
    return std::tie(other.gap, other.feature) < std::tie(point.gap, point.feature) &&
           other.normal.dot(point.normal) > same_gap;
  };
  return std::none_of(points_.begin(), points_.end(), is_wider_than);
}

/// Where both surfaces are smooth and curve away from each other.
void DetectContacts::put_lubrication(const Call& call, const CandidatePair& p, const Piece& a, const Piece& b,
                                     const ContactPoint& point, Contact& c) const {
  const BodySet& bodies = call.bodies;
  const Vec3& n = point.normal;
  const auto curvature_W = [&](const Piece& piece, const Vec3& x,
                               const Vec3& outward) -> std::optional<Mat3> {
    const Mat3 r = piece.pose.orientation.toRotationMatrix();
    const Vec3 outward_B = r.transpose() * outward;
    const auto k = piece.of.mesh ? piece.of.facets->at(feature_of(point.feature))
                   : piece.of.hollow
                       ? piece.of.hollow->curvature(outward_B)
                       : curvature(piece.of.parts[piece.index].shape, piece.pose.to_body(x), outward_B);
    if (!k) return std::nullopt;
    return r * *k * r.transpose();
  };
  const auto of_a = curvature_W(a, point.on_a, n), of_b = curvature_W(b, point.on_b, -n);
  if (!of_a || !of_b) return;
  const double opening = n.dot(bodies.velocity_at(p.row_b, c.r_b) - bodies.velocity_at(p.row_a, c.r_a));
  const Vec3 middle = bodies.position[p.row_a] + 0.5 * (point.on_a + point.on_b);
  const LubricatedGap gap{point.gap, call.dt * opening, *of_a, *of_b, middle, n, b.of.half_space};
  const double sum = gap.curvature_sum();
  if (sum > 0 && gap.curvature_product() >= least_roundness * sum * sum)
    c.lubrication = (*call.world.lubrication)(gap);
  if (c.lubrication) c.feature |= lubrication_feature;
}

/// Fills points_ with those of a piece of one body and a piece of the other.
void DetectContacts::collide_pieces(const Piece& a, const Piece& b, double margin,
                                    CollisionBackend& backend) {
  points_.clear();
  if (a.of.mesh || b.of.mesh) return collide_meshes(a, b, margin, backend);
  const ConvexShape& shape = a.of.parts[a.index].shape;
  if (b.of.hollow)
    append_hollow_contacts(shape, a.pose, *b.of.hollow, b.pose, margin, points_);
  else
    backend.collide(shape, a.pose, b.of.parts[b.index].shape, b.pose, margin, points_);
  reduce_manifold(points_);
}

void DetectContacts::collide_meshes(const Piece& a, const Piece& b, double margin,
                                    CollisionBackend& backend) {
  if (a.of.mesh && b.of.mesh) {
    append_mesh_contacts(*a.of.mesh, a.pose, *b.of.mesh, b.pose, margin, backend, points_);
  } else if (b.of.mesh) {
    append_mesh_contacts(a.of.part_with_surface(a.index), a.pose, *b.of.mesh, b.pose, margin, backend,
                         points_);
  } else if (b.of.hollow) {
    append_mesh_contacts(*a.of.mesh, a.pose, *b.of.hollow, b.pose, margin, points_);
  } else if (b.of.half_space) {
    append_mesh_contacts(*a.of.mesh, a.pose, std::get<HalfSpace>(b.of.parts[b.index].shape), b.pose, margin,
                         points_);
  } else {
    append_mesh_contacts(b.of.part_with_surface(b.index), b.pose, *a.of.mesh, a.pose, margin, backend,
                         points_);
    exchange_sides(points_);
  }
}

void DetectContacts::collide_pair(const Call& call, const CandidatePair& p, const Vec3& from_a_to_b,
                                  double margin, std::vector<Contact>& contacts) {
  const World& world = call.world;
  const BodySet& bodies = call.bodies;
  const ShapeParts &a = shapes_[bodies.shape[p.row_a]], &b = shapes_[bodies.shape[p.row_b]];
  const Pose pose_a{Vec3::Zero(), bodies.orientation[p.row_a]},
      pose_b{from_a_to_b, bodies.orientation[p.row_b]};
  const bool single = a.pieces() == 1 && b.pieces() == 1, with_mesh = a.mesh || b.mesh;
  const Material& material = world.pair(bodies.material[p.row_a], bodies.material[p.row_b]);
  const LubricationLaw* const lubrication = may_lubricate(a, b) ? world.lubrication.get() : nullptr;
  const std::size_t first = contacts.size();
  double least_gap = std::numeric_limits<double>::infinity();
  Vec3 narrowest = Vec3::Zero();  // a point near both bodies at the least gap
  for (std::size_t i = 0; i < a.pieces(); ++i)
    for (std::size_t j = 0; j < b.pieces(); ++j) {
      if (!single && parts_apart(a, i, pose_a, b, j, pose_b, margin)) continue;
      const Pose piece_a = a.pose_of(i, pose_a), piece_b = b.pose_of(j, pose_b);
      const Piece of_a{a, i, piece_a}, of_b{b, j, piece_b};
      collide_pieces(of_a, of_b, margin, call.backend);
      const std::size_t first_of_pieces = contacts.size();
      for (const ContactPoint& point : points_) {
        const std::uint64_t feature =
            with_mesh ? packed_mesh_feature(i + j, point.feature) : packed_feature(i, j, point.feature);
        contacts.push_back({bodies.id[p.row_a], bodies.id[p.row_b], p.image, feature, point.normal, point.gap,
                            point.on_a, point.on_b - from_a_to_b, material.restitution, material.friction});
        if (lubrication && point.gap < lubrication->reach() && has_lubrication(point, with_mesh))
          put_lubrication(call, p, of_a, of_b, point, contacts.back());
        set_arms(bodies, p, point, contacts.back());
        if (point.gap < least_gap) least_gap = point.gap, narrowest = point_near_both(bodies, p, point);
      }
      let_pass(call, p, of_a, of_b, from_a_to_b, std::span(contacts).subspan(first_of_pieces));
    }
  if (contacts.size() == first) return;
  const Vec3 reference = into_domain(call.exchange.extent(), bodies.position[p.row_a] + narrowest);
  if (!call.exchange.owns_contact_at(reference)) contacts.resize(first);
  if (world.lubrication) count_lubrication(*world.lubrication, std::span(contacts).subspan(first));
}

/// The contacts of two pieces, those of points_ one by one, that would act although the pieces pass each
/// other get the plane between which they do so.
void DetectContacts::let_pass(const Call& call, const CandidatePair& p, const Piece& a, const Piece& b,
                              const Vec3& from_a_to_b, std::span<Contact> of_pieces) const {
  if (a.of.sphere || b.of.sphere || b.of.half_space || b.of.hollow) return;
  const BodySet& bodies = call.bodies;
  const double slack =
      passing_slack * (reach_[p.row_a].radius + (is_wall(bodies.id[p.row_b]) ? 0.0 : reach_[p.row_b].radius));
  std::optional<Passing> found;
  bool looked = false;
  for (std::size_t k = 0; k < of_pieces.size(); ++k) {
    Contact& c = of_pieces[k];
    const ContactPoint& point = points_[k];
    const Vec3 motion = call.dt * (bodies.velocity_at(p.row_b, c.r_b) - bodies.velocity_at(p.row_a, c.r_a));
    if (c.lubrication || c.gap < -slack || c.gap + c.normal.dot(motion) >= -slack) continue;
    if (!looked || a.of.mesh || b.of.mesh)
      found = find_passing(call, p, a, b, from_a_to_b, point, std::abs(c.gap) + motion.norm() + slack);
    looked = true;
    if (!found) continue;
    c.normal = found->normal;
    c.gap = std::min(found->front_b - c.normal.dot(point.on_a), c.normal.dot(point.on_b) - found->front_a);
  }
}

/// By the motion before the kick, which bodies at rest on others have, and by that with gravity's kick if
/// they pass each other then as well, as bodies do that fall.
std::optional<Passing> DetectContacts::find_passing(const Call& call, const CandidatePair& p, const Piece& a,
                                                    const Piece& b, const Vec3& from_a_to_b,
                                                    const ContactPoint& point, double reach) const {
  const BodySet& bodies = call.bodies;
  const auto fall = [&](std::size_t row) -> Vec3 {
    return bodies.is_free(row) ? Vec3(call.dt * call.dt * bodies.weight_in_fluid[row] * call.world.gravity)
                               : Vec3(Vec3::Zero());
  };
  const auto moving = [&](const Piece& piece, std::size_t row, const Vec3& position, const Vec3& fallen) {
    const ConvexShape* convex = piece.of.mesh ? nullptr : &piece.of.parts[piece.index].shape;
    const Pose after{position + call.dt * bodies.velocity[row] + fallen,
                     (cayley(call.dt * bodies.angular_velocity[row]) * bodies.orientation[row]).normalized()};
    return MovingPart{convex, piece.of.mesh.get(), piece.pose, piece.of.pose_of(piece.index, after)};
  };
  const std::uint32_t code_b = feature_of(point.feature), code_a = b.of.mesh ? point.feature >> 32 : code_b;
  const auto look = [&](const Vec3& fall_a, const Vec3& fall_b) {
    return passing(moving(a, p.row_a, Vec3::Zero(), fall_a), code_a, moving(b, p.row_b, from_a_to_b, fall_b),
                   code_b, point.on_a, reach);
  };
  const auto found = look(Vec3::Zero(), Vec3::Zero());
  if (!found) return {};
  const Vec3 fall_a = fall(p.row_a), fall_b = fall(p.row_b);
  if (found->least + found->normal.dot(fall_b - fall_a) >= 0) return found;
  const auto falling = look(fall_a, fall_b);
  return falling ? falling : found;
}

void DetectContacts::count_lubrication(const LubricationLaw& law, std::span<const Contact> contacts) {
  for (const Contact& c : contacts)
    if (c.gap < law.reach()) ++(c.lubrication ? lubrication_counts_.with : lubrication_counts_.without);
}

/// From a to b: small numbers, and the same ones on every rank. A hollow that is alike all along its axis is
/// taken where a is abreast of it.
Vec3 DetectContacts::displacement_to(const BodySet& bodies, const Extent& extent,
                                     const CandidatePair& p) const {
  const Vec3 displacement = bodies.position[p.row_b] + extent.shift(p.image) - bodies.position[p.row_a];
  const auto& hollow = shapes_[bodies.shape[p.row_b]].hollow;
  if (!hollow || !hollow->slides()) return displacement;
  const Vec3 axis = bodies.orientation[p.row_b] * Vec3::UnitZ();
  return displacement - axis.dot(displacement) * axis;
}

/// The broad phase sees no wall that is a mesh: it may be as large as the domain, and move, while few of its
/// triangles are near a body, which the mesh's tree tells. Adds the free bodies that come near its box.
void DetectContacts::add_mesh_walls(const Call& call) {
  const BodySet& bodies = call.bodies;
  const Extent& extent = call.exchange.extent();
  const auto first = static_cast<std::ptrdiff_t>(pairs_.size());
  for (std::size_t wall = bodies.first_wall(); wall < bodies.size(); ++wall) {
    const auto& mesh = shapes_[bodies.shape[wall]].mesh;
    if (!mesh) continue;
    const BoundingBox box =
        Mesh{mesh->mesh().surface}.bounding_box(bodies.pose(wall));  // of a hollow one too
    for (const Image image : images(extent))
      for (std::size_t row = 0; row < bodies.first_wall(); ++row) {
        if (!bodies.is_dynamic(row) || !(bodies.is_active(row) || bodies.is_active(wall))) continue;
        const CandidatePair p{row, wall, image};
        const Vec3 shift = extent.shift(image), x = bodies.position[row] - shift;
        const double reach = reach_[row].radius + pair_margin(call.world, bodies, p, shift, call.dt);
        const double beyond = (box.lower - x).cwiseMax(x - box.upper).maxCoeff();
        if (beyond <= reach) pairs_.push_back(p);
      }
  }
  const auto before = [&](const CandidatePair& p, const CandidatePair& q) {
    return std::tuple(bodies.id[p.row_a], bodies.id[p.row_b], p.image) <
           std::tuple(bodies.id[q.row_a], bodies.id[q.row_b], q.image);
  };
  std::sort(pairs_.begin() + first, pairs_.end(), before);
  std::inplace_merge(pairs_.begin(), pairs_.begin() + first, pairs_.end(), before);
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
  if (with_meshes_) add_mesh_walls(call);
  for (const CandidatePair& p : pairs_) {
    const double margin = pair_margin(world, bodies, p, exchange.extent().shift(p.image), dt);
    const Vec3 from_a_to_b = displacement_to(bodies, exchange.extent(), p);
    if (!is_wall(bodies.id[p.row_b]) && bodies_apart(bodies, p, from_a_to_b, margin)) continue;
    collide_pair(call, p, from_a_to_b, margin, contacts);
  }
  return pairs_.size();
}

}  // namespace silt::rigid
