#include "rigid/collision/convex_core.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace silt::rigid {

namespace {

int support_vertex(const PolyhedronMesh& mesh, const Vec3& direction_B) {
  int best = 0;
  double furthest = mesh.vertices[0].dot(direction_B);
  for (int v = 1; v < static_cast<int>(mesh.vertices.size()); ++v)
    if (const double h = mesh.vertices[v].dot(direction_B); h > furthest) furthest = h, best = v;
  return best;
}

/// Of a circle of this radius about z, by the direction's part across z.
Mat3 rim_curvature(double radius, const Vec3& direction_B) {
  const double across = std::hypot(direction_B.x(), direction_B.y());
  if (!(across > 0)) return Mat3::Zero();
  const Vec3 tangent(-direction_B.y() / across, direction_B.x() / across, 0);
  return radius / across * tangent * tangent.transpose();
}

Mat3 ellipsoid_curvature(const Vec3& half_axes, const Vec3& direction_B) {
  const Vec3 squares = half_axes.cwiseAbs2(), an = squares.cwiseProduct(direction_B);
  const double q = std::sqrt(an.dot(direction_B));
  Mat3 k = -an * an.transpose() / (q * q);
  k.diagonal() += squares;
  return k / q;
}

/// Half the square of an angle below which two directions are one.
constexpr double same_plane = 1e-18;

/// Radius of the ball that touches the plane normal to n at x from below and stays inside an infinite
/// cylinder about z: |(x - r n) across z| = radius - r.
double ball_in_barrel(double radius, const Vec3& x, const Vec3& n) {
  const double room = radius - x.head<2>().dot(n.head<2>());
  if (room <= 1e-14 * radius) return radius;  // x is on the side, n its normal
  const double inside = std::max(0.0, radius * radius - x.head<2>().squaredNorm());
  return inside / (room + std::sqrt(std::max(0.0, room * room - n.z() * n.z() * inside)));
}

}  // namespace

Vec3 ConvexCore::support(const Vec3& n) const {
  const Vec3 d = direction_B(n);
  switch (kind) {
    case Kind::box:
      return to_world(
          {std::copysign(half.x(), d.x()), std::copysign(half.y(), d.y()), std::copysign(half.z(), d.z())});
    case Kind::cylinder: {
      const double across = std::hypot(d.x(), d.y()), scale = across > 0 ? half.x() / across : 0;
      return to_world({scale * d.x(), scale * d.y(), std::copysign(half.z(), d.z())});
    }
    case Kind::ellipsoid: {
      const Vec3 scaled = half.cwiseProduct(d);
      return to_world(half.cwiseProduct(scaled) / scaled.norm());
    }
    default:
      return to_world(mesh->vertices[support_vertex(*mesh, d)]);
  }
}

Mat3 ConvexCore::curvature(const Vec3& n) const {
  if (!curved()) return Mat3::Zero();
  const Vec3 d = direction_B(n);
  const Mat3 local = kind == Kind::cylinder ? rim_curvature(half.x(), d) : ellipsoid_curvature(half, d);
  return axes * local * axes.transpose();
}

void ConvexCore::kinks(const Vec3& n, double angle, Kinks& out) const {
  const double sine = std::sin(angle), cosine = std::cos(angle);
  const Vec3 d = direction_B(n);
  if (kind == Kind::box)
    for (int k = 0; k < 3; ++k) {
      if (half[k] > 0 && std::abs(d[k]) <= sine) out.edges.push_back(axes.col(k));
      if (half[(k + 1) % 3] > 0 && half[(k + 2) % 3] > 0 && std::abs(d[k]) >= cosine)
        out.faces.push_back(std::copysign(1.0, d[k]) * axes.col(k));
    }
  if (kind == Kind::cylinder) {
    if (std::abs(d.z()) <= sine) out.edges.push_back(axes.col(2));
    if (std::abs(d.z()) >= cosine) out.faces.push_back(std::copysign(1.0, d.z()) * axes.col(2));
  }
  if (kind != Kind::polyhedron) return;
  const int v = support_vertex(*mesh, d);
  for (const int u : mesh->neighbours[v]) {
    const Vec3 along = (mesh->vertices[u] - mesh->vertices[v]).normalized();
    if (std::abs(along.dot(d)) <= sine) out.edges.push_back(axes * along);
  }
  for (const auto& face : mesh->faces)
    if (face.normal.dot(d) >= cosine) out.faces.push_back(axes * face.normal);
}

double ConvexCore::touching_ball(const Vec3& x, const Vec3& n) const {
  const Vec3 d = direction_B(n), x_B = direction_B(x - centre);
  double radius = std::numeric_limits<double>::infinity();
  const auto under_plane = [&](const Vec3& outward, double below) {
    const double turned = (outward - d).squaredNorm() / 2;  // 1 - cosine
    if (turned > same_plane) radius = std::min(radius, std::max(below, 0.0) / turned);
  };
  if (kind == Kind::ellipsoid) {
    const double least = half.minCoeff();
    return least * least / half.cwiseProduct(d).norm();
  }
  if (kind == Kind::polyhedron) {
    for (const auto& face : mesh->faces) under_plane(face.normal, face.offset - face.normal.dot(x_B));
    return radius;
  }
  if (half.minCoeff() <= 0) return 0;
  for (int k = kind == Kind::box ? 0 : 2; k < 3; ++k)
    for (const double sign : {-1.0, 1.0}) under_plane(sign * Vec3::Unit(k), half[k] - sign * x_B[k]);
  return kind == Kind::box ? radius : std::min(radius, ball_in_barrel(half.x(), x_B, d));
}

ConvexCore convex_core(const ConvexShape& shape, const Pose& pose) {
  using Kind = ConvexCore::Kind;
  ConvexCore core{Kind::box, pose.position, pose.orientation.toRotationMatrix(), Vec3::Zero(), 0};
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    core.kind = Kind::cylinder;
    core.half = Vec3(cylinder->radius, cylinder->radius, cylinder->half_length);
  } else if (const auto* ellipsoid = std::get_if<Ellipsoid>(&shape)) {
    core.kind = Kind::ellipsoid;
    core.half = ellipsoid->half_axes;
  } else if (const auto* polyhedron = std::get_if<Polyhedron>(&shape)) {
    core.kind = Kind::polyhedron;
    core.mesh = polyhedron->mesh.get();
    for (const Vec3& v : core.mesh->vertices) core.half = core.half.cwiseMax(v.cwiseAbs());
  } else {
    const RoundedBox box = rounded_box(shape, pose);
    core.half = box.half;
    core.radius = box.radius;
  }
  return core;
}

double length_scale(const ConvexCore& a, const ConvexCore& b) {
  return a.half.norm() + b.half.norm() + a.radius + b.radius + (b.centre - a.centre).norm();
}

}  // namespace silt::rigid
