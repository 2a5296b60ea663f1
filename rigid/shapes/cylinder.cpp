#include "rigid/shapes/cylinder.hpp"

#include <numbers>

namespace silt::rigid {

double Cylinder::signed_distance(const Vec3& x) const {
  const double across = std::sqrt(x[0] * x[0] + x[1] * x[1]) - radius, along = std::abs(x[2]) - half_length;
  if (std::max(across, along) <= 0) return std::max(across, along);
  return elementary::hypot(std::max(across, 0.0), std::max(along, 0.0));
}

std::optional<LineInterval> Cylinder::line_interval(const Vec3& o, const Vec3& d) const {
  const double a = d[0] * d[0] + d[1] * d[1], rho = std::sqrt(o[0] * o[0] + o[1] * o[1]);
  const auto between_ends = in_slab(o[2], d[2], half_length);
  if (!(a > 0)) return rho <= radius ? between_ends : std::nullopt;
  const double b = o[0] * d[0] + o[1] * d[1];
  return in_both(between_roots(a, b, (rho - radius) * (rho + radius)), between_ends);
}

BoundingBox Cylinder::bounding_box(const Pose& pose) const {
  const Vec3 axis = pose.orientation * Vec3::UnitZ();
  const Vec3 across = (Vec3::Ones() - axis.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  return BoundingBox::around(pose.position, axis.cwiseAbs() * half_length + radius * across);
}

/// Computes the distance of the rim point furthest from the origin, in the cylinder's own frame.
double Cylinder::reach(const Pose& pose) const {
  const Vec3 centre = pose.orientation.conjugate() * pose.position;
  return elementary::hypot(elementary::hypot(centre[0], centre[1]) + radius,
                           std::abs(centre[2]) + half_length);
}

MassProperties Cylinder::mass_properties() const {
  const double r2 = radius * radius, l = half_length, volume = 2 * std::numbers::pi * r2 * l;
  const double across = volume * (0.25 * r2 + l * l / 3);
  return {volume, Vec3::Zero(), Vec3(across, across, 0.5 * volume * r2).asDiagonal()};
}

/// Adds a row of balls along the axis and points on the ends.
void Cylinder::add_inner_balls(std::vector<InnerBall>& balls) const {
  constexpr int most = 64, points = 12;
  const double r = std::min(radius, half_length), free = half_length - r;
  const int gaps = std::clamp(static_cast<int>(std::ceil(4 * free / r)), 1, most);
  for (int i = 0; i <= gaps; ++i) balls.push_back({{0, 0, free * (2. * i / gaps - 1)}, r});
  for (const double z : {-half_length, half_length}) {
    balls.push_back({{0, 0, z}, 0});
    for (int k = 0; k < points; ++k) {
      const double angle = 2 * std::numbers::pi * k / points;
      for (const double r_k : {0.5 * radius, radius})
        balls.push_back({{r_k * elementary::cos(angle), r_k * elementary::sin(angle), z}, 0});
    }
  }
}

std::optional<Mat3> Cylinder::curvature(const Vec3&, const Vec3& n) const {
  if (is_along(std::copysign(1.0, n.z()) * Vec3::UnitZ(), n)) return Mat3(Mat3::Zero());
  const Vec3 around = n.cross(Vec3::UnitZ()).normalized();
  if (!is_along(Vec3::UnitZ().cross(around), n)) return std::nullopt;
  return Mat3(around * around.transpose() / radius);
}

void Cylinder::kinks(const Placement& at, const Vec3& n_B, double angle, Kinks& out) const {
  if (std::abs(n_B.z()) <= elementary::sin(angle)) out.circles.push_back(at.axes.col(2));
  if (std::abs(n_B.z()) >= elementary::cos(angle))
    out.faces.push_back(std::copysign(1.0, n_B.z()) * at.axes.col(2));
}

InnerBall Cylinder::inner_ball(const Vec3& x) const {
  const double ball = std::min(radius, half_length), along = half_length - ball, aside = radius - ball;
  const double from_axis = elementary::hypot(x[0], x[1]), share = from_axis > aside ? aside / from_axis : 1;
  return {{share * x[0], share * x[1], std::clamp(x[2], -along, along)}, ball};
}

namespace {

/// Returns the radius r of the ball inside an infinite cylinder about z that touches, from below, the plane
/// normal to n at x: |(x - r n) across z| = radius - r.
double ball_in_barrel(double radius, const Vec3& x, const Vec3& n) {
  const double room = radius - x.head<2>().dot(n.head<2>());
  if (room <= 1e-14 * radius) return radius;  // x is on the side, n its normal
  const double inside = std::max(0.0, radius * radius - x.head<2>().squaredNorm());
  return inside / (room + std::sqrt(std::max(0.0, room * room - n.z() * n.z() * inside)));
}

}  // namespace

double Cylinder::touching_ball(const Vec3& x, const Vec3& n) const {
  if (std::min(radius, half_length) <= 0) return 0;
  BallUnderPlanes ball(n);
  for (const double sign : {-1.0, 1.0}) ball.add(sign * Vec3::UnitZ(), half_length - sign * x[2]);
  return std::min(ball.radius, ball_in_barrel(radius, x, n));
}

void Cylinder::side_line(const Placement& at, const Vec3& n, ContactOutline& out) const {
  out.reset();
  out.code = Disc::side_code;
  out.barrel_radius = radius;
  for (const int side : {-1, 1}) {
    out.corners.push_back(end(side).lowest(at, n));
    out.corners.back().edge_code = Disc::side_code;
  }
}

void Cylinder::touching_outline(const Placement& at, const Vec3& n, double slack, ContactOutline& out) const {
  const Vec3 d = at.direction_B(n);
  const int side = d.z() < 0 ? -1 : 1;
  if (2 * radius * elementary::hypot(d.x(), d.y()) <= slack) return end(side).outline(at, out);
  if (2 * half_length * std::abs(d.z()) <= slack) return side_line(at, n, out);
  const auto lowest = end(side).lowest(at, n);
  out.set_point(lowest.x, lowest.code);
}

/// The outline is an end that lies flat, the line of the side within 45 degrees, else the furthest rim point.
void Cylinder::facing_outline(const Placement& at, const Vec3& n, ContactOutline& out) const {
  const Vec3 d = at.direction_B(n);
  const Disc facing = end(d.z() < 0 ? -1 : 1);
  if (facing.is_flat_against(d)) return facing.outline(at, out);
  if (std::abs(d.z()) <= std::numbers::sqrt2 / 2) return side_line(at, n, out);
  const auto lowest = facing.lowest(at, n);
  out.set_point(lowest.x, lowest.code);
}

void Cylinder::plane_points(const Placement& at, const Vec3& n, std::vector<PlanePoint>& out) const {
  const Vec3 d = at.direction_B(n);
  const bool lies_on[] = {end(-1).is_flat_against(d), end(1).is_flat_against(d)};
  if (!lies_on[1]) end(-1).add_plane_points(at, n, out);
  if (!lies_on[0]) end(1).add_plane_points(at, n, out);
}

ContactOutline::Corner Disc::lowest(const Placement& at, const Vec3& n) const {
  const Vec3 d = at.direction_B(n);
  const double across = elementary::hypot(d.x(), d.y()), scale = across > 0 ? radius / across : 0;
  const std::uint32_t code = first_lowest + (side > 0);
  return {at.to_world({scale * d.x(), scale * d.y(), z}), code, code};
}

void Disc::outline(const Placement& at, ContactOutline& out) const {
  out.reset();
  const int upper = side > 0;
  out.code = first_end + upper;
  out.normal = side * at.axes.col(2);
  out.centre = at.to_world({0, 0, z});
  out.disc_radius = radius;
  for (int k = 0; k < rim_points; ++k) {
    const double angle = 2 * std::numbers::pi * k / rim_points;
    const Vec3 x = out.centre + out.disc_radius * (elementary::cos(angle) * at.axes.col(0) +
                                                   elementary::sin(angle) * at.axes.col(1));
    const std::uint32_t which = upper * rim_points + k;
    out.corners.push_back({x, first_rim + which, first_chord + which});
  }
}

void Disc::add_plane_points(const Placement& at, const Vec3& n, std::vector<PlanePoint>& out) const {
  const bool flat = is_flat_against(at.direction_B(n));
  if (flat) {
    thread_local ContactOutline end;
    outline(at, end);
    for (const auto& corner : end.corners) out.push_back({corner.x, corner.code});
  }
  const auto corner = lowest(at, n);
  out.push_back({corner.x, corner.code, flat});
}

Mat3 rim_derivative(double radius, const Vec3& n) {
  const double across = elementary::hypot(n.x(), n.y());
  if (!(across > 0)) return Mat3::Zero();
  const Vec3 tangent(-n.y() / across, n.x() / across, 0);
  return radius / across * tangent * tangent.transpose();
}

}  // namespace silt::rigid
