#include "rigid/shapes/shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "rigid/shapes/ellipsoid.hpp"
#include "rigid/shapes/ray_interval.hpp"

namespace silt::rigid {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// One function object out of several lambdas, to visit a variant with.
template <class... F>
struct Visitor : F... {
  using F::operator()...;
};
template <class... F>
Visitor(F...) -> Visitor<F...>;

double distance_to(const Sphere& s, const Vec3& x) {
  return x.norm() - s.radius;
}
double distance_to(const Box& b, const Vec3& x) {
  const Vec3 outside = x.cwiseAbs() - b.half_edges;
  return outside.maxCoeff() <= 0 ? outside.maxCoeff() : outside.cwiseMax(0.0).norm();
}
double distance_to(const Capsule& c, const Vec3& x) {
  const double along = std::clamp(x[2], -c.half_length, c.half_length);
  return Vec3(x[0], x[1], x[2] - along).norm() - c.radius;
}
double distance_to(const Cylinder& c, const Vec3& x) {
  const double across = std::sqrt(x[0] * x[0] + x[1] * x[1]) - c.radius,
               along = std::abs(x[2]) - c.half_length;
  if (std::max(across, along) <= 0) return std::max(across, along);
  return std::hypot(std::max(across, 0.0), std::max(along, 0.0));
}
double distance_to(const Ellipsoid& e, const Vec3& x) {
  return ellipsoid_distance(e.half_axes, x);
}
double distance_to(const Polyhedron& q, const Vec3& x) {
  return signed_distance(*q.mesh, x);
}
double distance_to(const HalfSpace& h, const Vec3& x) {
  return h.normal.dot(x);
}
double distance_to(const Tube& t, const Vec3& x) {
  return t.radius - std::sqrt(x[0] * x[0] + x[1] * x[1]);
}
double distance_to(const Compound& c, const Vec3& x) {
  double least = infinity;
  for (const Part& part : c.parts) {
    const Vec3 x_P = part.pose.to_body(x);
    least = std::min(least, std::visit([&](const auto& s) { return distance_to(s, x_P); }, part.shape));
  }
  return least;
}

/// The sign of distance_to, where that is cheaper to have.
template <class S>
bool holds(const S& shape, const Vec3& x) {
  return distance_to(shape, x) <= 0;
}
bool holds(const Ellipsoid& e, const Vec3& x) {
  return in_ellipsoid(e.half_axes, x);
}
bool holds(const Polyhedron& q, const Vec3& x) {
  return std::all_of(q.mesh->faces.begin(), q.mesh->faces.end(),
                     [&](const auto& face) { return face.normal.dot(x) - face.offset <= 0; });
}
bool holds(const Compound& c, const Vec3& x) {
  return std::any_of(c.parts.begin(), c.parts.end(), [&](const Part& part) {
    const Vec3 x_P = part.pose.to_body(x);
    return std::visit([&](const auto& s) { return holds(s, x_P); }, part.shape);
  });
}

double hit(const ConvexShape& shape, const Vec3& origin, const Vec3& direction, double t_max) {
  const auto inside = ray_interval(shape, origin, direction);
  if (!inside || inside->leave < 0) return t_max;
  return std::clamp(inside->enter, 0.0, t_max);
}

/// Where a line leaves the hollow of the tube.
double hit(const Tube& tube, const Vec3& origin, const Vec3& direction, double t_max) {
  const auto hollow = hollow_interval(tube, origin, direction);
  return hollow ? std::clamp(hollow->leave, 0.0, t_max) : 0.0;
}

BoundingBox around(const Vec3& centre, const Vec3& half) {
  return {centre - half, centre + half};
}

BoundingBox box_of(const Sphere& s, const Pose& p) {
  return around(p.position, Vec3::Constant(s.radius));
}
BoundingBox box_of(const Box& b, const Pose& p) {
  return around(p.position, p.orientation.toRotationMatrix().cwiseAbs() * b.half_edges);
}
BoundingBox box_of(const Capsule& c, const Pose& p) {
  const Vec3 axis = p.orientation * Vec3::UnitZ();
  return around(p.position, axis.cwiseAbs() * c.half_length + Vec3::Constant(c.radius));
}
BoundingBox box_of(const Cylinder& c, const Pose& p) {
  const Vec3 axis = p.orientation * Vec3::UnitZ();
  const Vec3 across = (Vec3::Ones() - axis.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  return around(p.position, axis.cwiseAbs() * c.half_length + c.radius * across);
}
BoundingBox box_of(const Ellipsoid& e, const Pose& p) {
  const Mat3 r = p.orientation.toRotationMatrix();
  return around(p.position, (r * e.half_axes.asDiagonal()).rowwise().norm());
}
BoundingBox box_of(const Polyhedron& q, const Pose& p) {
  BoundingBox all{Vec3::Constant(infinity), Vec3::Constant(-infinity)};
  for (const Vec3& v : q.mesh->vertices) {
    const Vec3 x = p.to_world(v);
    all.lower = all.lower.cwiseMin(x);
    all.upper = all.upper.cwiseMax(x);
  }
  return all;
}
BoundingBox box_of(const HalfSpace&, const Pose&) {
  return {Vec3::Constant(-infinity), Vec3::Constant(infinity)};
}
BoundingBox box_of(const Tube&, const Pose&) {
  return {Vec3::Constant(-infinity), Vec3::Constant(infinity)};
}
BoundingBox box_of(const Compound& c, const Pose& p) {
  BoundingBox all{Vec3::Constant(infinity), Vec3::Constant(-infinity)};
  for (const Part& part : c.parts) {
    const BoundingBox one = part_box(part, p);
    all.lower = all.lower.cwiseMin(one.lower);
    all.upper = all.upper.cwiseMax(one.upper);
  }
  return all;
}

}  // namespace

std::string_view shape_name(const Shape& shape) {
  constexpr std::string_view names[] = {"sphere",     "box",        "capsule",  "cylinder", "ellipsoid",
                                        "polyhedron", "half-space", "compound", "tube"};
  return names[shape.index()];
}

bool contains(const Shape& shape, const Vec3& x_B) {
  return std::visit([&](const auto& s) { return holds(s, x_B); }, shape);
}

double signed_distance(const Shape& shape, const Vec3& x_B) {
  return std::visit([&](const auto& s) { return distance_to(s, x_B); }, shape);
}

double ray_distance(const Shape& shape, const Vec3& origin_B, const Vec3& direction_B, double t_max) {
  const auto* compound = std::get_if<Compound>(&shape);
  if (!compound)
    return std::visit(Visitor{[&](const Compound&) { return t_max; },
                              [&](const auto& s) { return hit(s, origin_B, direction_B, t_max); }},
                      shape);
  double t = t_max;
  for (const Part& part : compound->parts)
    t = hit(part.shape, part.pose.to_body(origin_B), part.pose.orientation.conjugate() * direction_B, t);
  return t;
}

BoundingBox bounding_box(const Shape& shape, const Pose& pose) {
  return std::visit([&](const auto& s) { return box_of(s, pose); }, shape);
}

BoundingBox part_box(const Part& part, const Pose& body) {
  return std::visit([&](const auto& s) { return box_of(s, body * part.pose); }, part.shape);
}

double reach(const Part& part) {
  const Pose& pose = part.pose;
  return std::visit(Visitor{[&](const Sphere& s) { return pose.position.norm() + s.radius; },
                            [&](const Box& b) {
                              // the corner furthest from the origin, seen from the box's own frame
                              const Vec3 centre = pose.orientation.conjugate() * pose.position;
                              return (centre.cwiseAbs() + b.half_edges).norm();
                            },
                            [&](const Capsule& c) {
                              const Vec3 end = pose.orientation * Vec3(0, 0, c.half_length);
                              return c.radius +
                                     std::max((pose.position + end).norm(), (pose.position - end).norm());
                            },
                            [&](const Cylinder& c) {
                              // the rim point furthest from the origin, seen from the cylinder's own frame
                              const Vec3 centre = pose.orientation.conjugate() * pose.position;
                              return std::hypot(std::hypot(centre[0], centre[1]) + c.radius,
                                                std::abs(centre[2]) + c.half_length);
                            },
                            [&](const Ellipsoid& e) {
                              const Vec3 centre = pose.orientation.conjugate() * pose.position;
                              return ellipsoid_reach(e.half_axes, -centre);
                            },
                            [&](const Polyhedron& q) {
                              double furthest = 0;
                              for (const Vec3& v : q.mesh->vertices)
                                furthest = std::max(furthest, pose.to_world(v).norm());
                              return furthest;
                            },
                            [](const HalfSpace&) { return infinity; }},
                    part.shape);
}

double bounding_radius(const Shape& shape) {
  if (std::holds_alternative<Tube>(shape)) return infinity;
  double radius = 0;
  for (const Part& part : convex_parts(shape)) radius = std::max(radius, reach(part));
  return radius;
}

Vec3 support(const ConvexShape& shape, const Vec3& d) {
  const double length = d.norm();
  const Vec3 unit = length > 0 ? Vec3(d / length) : Vec3(Vec3::UnitX());
  return std::visit(Visitor{[&](const Sphere& s) -> Vec3 { return s.radius * unit; },
                            [&](const Box& b) -> Vec3 {
                              return {std::copysign(b.half_edges[0], d[0]),
                                      std::copysign(b.half_edges[1], d[1]),
                                      std::copysign(b.half_edges[2], d[2])};
                            },
                            [&](const Capsule& c) -> Vec3 {
                              return c.radius * unit + Vec3(0, 0, std::copysign(c.half_length, d[2]));
                            },
                            [&](const Cylinder& c) -> Vec3 {
                              const double across = std::hypot(unit[0], unit[1]);
                              const double scale = across > 0 ? c.radius / across : 0;
                              return {scale * unit[0], scale * unit[1], std::copysign(c.half_length, d[2])};
                            },
                            [&](const Ellipsoid& e) -> Vec3 {
                              const Vec3 scaled = e.half_axes.cwiseProduct(unit);
                              return e.half_axes.cwiseProduct(scaled) / scaled.norm();
                            },
                            [&](const Polyhedron& q) -> Vec3 {
                              const Vec3* best = &q.mesh->vertices[0];
                              for (const Vec3& v : q.mesh->vertices)
                                if (v.dot(unit) > best->dot(unit)) best = &v;
                              return *best;
                            },
                            [](const HalfSpace&) -> Vec3 {
                              throw std::invalid_argument("a half-space has no furthest point");
                            }},
                    shape);
}

Shape recentred(const Shape& shape, const Vec3& centre) {
  if (const auto* polyhedron = std::get_if<Polyhedron>(&shape))
    return Polyhedron{shifted(*polyhedron->mesh, -centre)};
  const auto* compound = std::get_if<Compound>(&shape);
  if (!compound) return shape;
  Compound moved = *compound;
  for (Part& part : moved.parts) part.pose.position -= centre;
  return moved;
}

bool is_sphere(const Shape& shape) {
  return std::holds_alternative<Sphere>(shape);
}

std::vector<Part> convex_parts(const Shape& shape) {
  return std::visit(
      Visitor{[](const Compound& c) { return c.parts; }, [](const Tube&) { return std::vector<Part>{}; },
              [](const auto& s) {
                return std::vector<Part>{{s, Pose{}}};
              }},
      shape);
}

}  // namespace silt::rigid
