#include "rigid/shapes/cone.hpp"

#include <numbers>

namespace silt::rigid {

double Cone::above_side(const Vec3& x) const {
  return (height * elementary::hypot(x[0], x[1]) + radius * (x[2] - apex()[2])) / slant();
}

/// Seen in the plane through x and the axis: of a triangle.
double Cone::signed_distance(const Vec3& x) const {
  const double below = base().z - x[2], side = above_side(x), rho = elementary::hypot(x[0], x[1]);
  if (std::max(below, side) <= 0) return std::max(below, side);
  if (below >= 0 && rho <= radius) return below;
  // from the rim up along the side
  const double out = rho - radius, up = -below, length = slant();
  const double along = std::clamp((height * up - radius * out) / length, 0.0, length) / length;
  return elementary::hypot(out + along * radius, up - along * height);
}

/// The line is inside where rho^2 - (radius w / height)^2 <= 0 and 0 <= w <= height, w being the depth below
/// the apex. A line that is steeper than the side is inside that double cone before one root and after the
/// other; the one where w > 0 is wanted.
std::optional<LineInterval> Cone::line_interval(const Vec3& o, const Vec3& d) const {
  const auto between_ends = in_slab(o[2] - (apex()[2] - height / 2), d[2], height / 2);
  if (!between_ends) return {};
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double k = radius / height, w = apex()[2] - o[2], rho = elementary::hypot(o[0], o[1]);
  const double across = elementary::hypot(d[0], d[1]);
  const double a = (across - k * d[2]) * (across + k * d[2]),
               b = o[0] * d[0] + o[1] * d[1] + k * k * w * d[2];
  const double c = (rho - k * w) * (rho + k * w);
  if (a > 0) return in_both(between_roots(a, b, c), between_ends);
  if (a == 0 && b == 0) return c <= 0 ? between_ends : std::nullopt;
  // the root of a line with no other (a == 0), or both
  const double s = std::sqrt(std::max(0.0, b * b - a * c)), q = b >= 0 ? -b - s : -b + s;
  const double t1 = a < 0 ? q / a : -std::copysign(infinity, b), t2 = q != 0 ? c / q : t1;
  if (a == 0) return in_both(LineInterval{std::min(t1, t2), std::max(t1, t2)}, between_ends);
  const LineInterval nappe =
      d[2] < 0 ? LineInterval{std::max(t1, t2), infinity} : LineInterval{-infinity, std::min(t1, t2)};
  return in_both(nappe, between_ends);
}

BoundingBox Cone::bounding_box(const Pose& pose) const {
  const Vec3 axis = pose.orientation * Vec3::UnitZ(), tip = pose.to_world(apex());
  const Vec3 across = (Vec3::Ones() - axis.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  BoundingBox box = BoundingBox::around(pose.to_world({0, 0, base().z}), radius * across);
  box.add({tip, tip});
  return box;
}

double Cone::reach(const Pose& pose) const {
  const Vec3 centre = pose.orientation.conjugate() * pose.position;
  const double rim =
      elementary::hypot(elementary::hypot(centre[0], centre[1]) + radius, centre[2] + base().z);
  return std::max(rim, (centre + apex()).norm());
}

Vec3 Cone::support(const Vec3& n) const {
  if (apex_lead(n) >= 0) return apex();
  const double across = elementary::hypot(n[0], n[1]), scale = across > 0 ? radius / across : 0;
  return {scale * n[0], scale * n[1], base().z};
}

MassProperties Cone::mass_properties() const {
  const double r2 = radius * radius, volume = std::numbers::pi * r2 * height / 3;
  const double across = volume * (3. / 20 * r2 + 3. / 80 * height * height);
  return {volume, Vec3::Zero(), Vec3(across, across, 0.3 * volume * r2).asDiagonal()};
}

/// The largest ball, smaller ones from there to the apex, and points of the base.
void Cone::add_inner_balls(std::vector<InnerBall>& balls) const {
  constexpr int chain = 6, points = 12;
  const double largest = radius * height / (radius + slant()), to_apex = height - largest;
  for (int i = 0; i <= chain; ++i) {
    const double share = 1 - double(i) / chain;
    balls.push_back({apex() - Vec3(0, 0, share * to_apex), share * largest});
  }
  balls.push_back({{0, 0, base().z}, 0});
  for (int k = 0; k < points; ++k) {
    const double angle = 2 * std::numbers::pi * k / points;
    for (const double r : {0.5 * radius, radius})
      balls.push_back({{r * elementary::cos(angle), r * elementary::sin(angle), base().z}, 0});
  }
}

Mat3 Cone::support_derivative(const Vec3& n) const {
  return apex_lead(n) >= 0 ? Mat3(Mat3::Zero()) : rim_derivative(radius, n);
}

/// The normal of the side makes an angle with the circle through x about the axis: its curvature is that of
/// the circle times the cosine (Meusnier).
std::optional<Mat3> Cone::curvature(const Vec3& x, const Vec3& n) const {
  constexpr double at_apex = 1e-6;  // of the base's radius
  if (is_along(-Vec3::UnitZ(), n)) return Mat3(Mat3::Zero());
  const Vec3 around = n.cross(Vec3::UnitZ()).normalized();
  const Vec3 side = (height * Vec3::UnitZ().cross(around) + radius * Vec3::UnitZ()) / slant();
  const double from_axis = elementary::hypot(x[0], x[1]);
  if (!is_along(side, n) || from_axis <= at_apex * radius) return std::nullopt;
  return Mat3(height / slant() / from_axis * around * around.transpose());
}

void Cone::kinks(const Placement& at, const Vec3& n_B, double angle, Kinks& out) const {
  const double from_axis = elementary::atan2(elementary::hypot(n_B[0], n_B[1]), n_B[2]);
  if (std::abs(from_axis - elementary::atan2(height, radius)) <= angle)
    out.circles.push_back({at.axes.col(2), radius / slant()});
  if (-n_B[2] >= elementary::cos(angle)) out.faces.push_back(-at.axes.col(2));
}

/// The largest, wherever.
InnerBall Cone::inner_ball(const Vec3&) const {
  const double largest = radius * height / (radius + slant());
  return {{0, 0, base().z + largest}, largest};
}

/// The ball reaches, on the base, up to the side and, on the side, up to the axis or the base.
double Cone::touching_ball(const Vec3& x, const Vec3& n) const {
  constexpr double same = 1e-9;  // radian, of two normals
  const double rise = radius / slant(), run = height / slant(), rho = elementary::hypot(x[0], x[1]);
  if ((n + Vec3::UnitZ()).norm() <= same) return std::max(0.0, -above_side(x)) / (1 + rise);
  if (!(rho > 0) || (n - Vec3(run * x[0] / rho, run * x[1] / rho, rise)).norm() > same) return 0;
  return std::min(rho / run, std::max(0.0, x[2] - base().z) / (1 + rise));
}

void Cone::side_line(const Placement& at, const Vec3& n, ContactOutline& out) const {
  out.reset();
  out.code = Disc::side_code;
  out.corners.push_back(base().lowest(at, n));
  out.corners.push_back({at.to_world(apex()), Disc::apex_code, Disc::side_code});
  out.corners[0].edge_code = Disc::side_code;
}

void Cone::touching_outline(const Placement& at, const Vec3& n, double slack, ContactOutline& out) const {
  const Vec3 d = at.direction_B(n);
  const double lead = apex_lead(d);
  if (d[2] < 0 && 2 * radius * elementary::hypot(d[0], d[1]) <= slack) return base().outline(at, out);
  if (std::abs(lead) <= slack) return side_line(at, n, out);
  if (lead > 0) return out.set_point(at.to_world(apex()), Disc::apex_code);
  const auto lowest = base().lowest(at, n);
  out.set_point(lowest.x, lowest.code);
}

/// The base where it lies flat, the side's line within 45 degrees, else the apex or the rim's furthest point.
void Cone::facing_outline(const Placement& at, const Vec3& n, ContactOutline& out) const {
  const Vec3 d = at.direction_B(n);
  if (base().is_flat_against(d)) return base().outline(at, out);
  const double to_side = (height * elementary::hypot(d[0], d[1]) + radius * d[2]) / slant();
  touching_outline(at, n, 0, out);
  if (to_side >= std::numbers::sqrt2 / 2) side_line(at, n, out);
}

void Cone::plane_points(const Placement& at, const Vec3& n, std::vector<PlanePoint>& out) const {
  base().add_plane_points(at, n, out);
  out.push_back({at.to_world(apex()), Disc::apex_code});
}

}  // namespace silt::rigid
