#include "rigid/shapes/box.hpp"

#include "rigid/math/elementary.hpp"

namespace silt::rigid {

double Box::signed_distance(const Vec3& x) const {
  const Vec3 outside = x.cwiseAbs() - half_edges;
  return outside.maxCoeff() <= 0 ? outside.maxCoeff() : outside.cwiseMax(0.0).norm();
}

std::optional<LineInterval> Box::line_interval(const Vec3& o, const Vec3& d) const {
  return in_both(in_both(in_slab(o[0], d[0], half_edges[0]), in_slab(o[1], d[1], half_edges[1])),
                 in_slab(o[2], d[2], half_edges[2]));
}

BoundingBox Box::bounding_box(const Pose& pose) const {
  return BoundingBox::around(pose.position, pose.orientation.toRotationMatrix().cwiseAbs() * half_edges);
}

/// Computes the distance of the corner furthest from the origin, in the box's own frame.
double Box::reach(const Pose& pose) const {
  const Vec3 centre = pose.orientation.conjugate() * pose.position;
  return (centre.cwiseAbs() + half_edges).norm();
}

MassProperties Box::mass_properties() const {
  const Vec3 sq = half_edges.cwiseAbs2();
  const double volume = 8 * half_edges.prod();
  const Vec3 moments = volume / 3 * Vec3(sq[1] + sq[2], sq[0] + sq[2], sq[0] + sq[1]);
  return {volume, Vec3::Zero(), moments.asDiagonal()};
}

/// Adds the largest ball about the centre and a grid of points on the faces.
void Box::add_inner_balls(std::vector<InnerBall>& balls) const {
  constexpr int points = 5;  // along an edge
  balls.push_back({Vec3::Zero(), half_edges.minCoeff()});
  for (int i = 0; i < points; ++i)
    for (int j = 0; j < points; ++j)
      for (int k = 0; k < points; ++k) {
        const bool on_face = i % (points - 1) == 0 || j % (points - 1) == 0 || k % (points - 1) == 0;
        const Vec3 corner = Vec3(i, j, k) * (2. / (points - 1)) - Vec3::Ones();
        if (on_face) balls.push_back({half_edges.cwiseProduct(corner), 0});
      }
}

std::optional<Mat3> Box::curvature(const Vec3&, const Vec3& n) const {
  for (int k = 0; k < 3; ++k)
    if (is_along(std::copysign(1.0, n[k]) * Vec3::Unit(k), n)) return Mat3(Mat3::Zero());
  return std::nullopt;
}

void Box::kinks(const Placement& at, const Vec3& n_B, double angle, Kinks& out) const {
  const double sine = elementary::sin(angle), cosine = elementary::cos(angle);
  for (int k = 0; k < 3; ++k) {
    if (half_edges[k] > 0 && std::abs(n_B[k]) <= sine) out.circles.push_back(at.axes.col(k));
    if (half_edges[(k + 1) % 3] > 0 && half_edges[(k + 2) % 3] > 0 && std::abs(n_B[k]) >= cosine)
      out.faces.push_back(std::copysign(1.0, n_B[k]) * at.axes.col(k));
  }
}

InnerBall Box::inner_ball(const Vec3& x) const {
  const double radius = half_edges.minCoeff();
  const Vec3 free = half_edges - Vec3::Constant(radius);
  return {x.cwiseMax(-free).cwiseMin(free), radius};
}

double Box::touching_ball(const Vec3& x, const Vec3& n) const {
  if (half_edges.minCoeff() <= 0) return 0;
  BallUnderPlanes ball(n);
  for (int k = 0; k < 3; ++k)
    for (const double sign : {-1.0, 1.0}) ball.add(sign * Vec3::Unit(k), half_edges[k] - sign * x[k]);
  return ball.radius;
}

namespace {

/// Writes the corners of a face, edge or vertex: along axes of sign 0 the feature extends.
void outline_of(const Box& box, const Placement& at, const Feature& f, ContactOutline& out) {
  out.reset();
  out.code = f.code();
  int free_axes[3], count = 0;
  for (int k = 0; k < 3; ++k)
    if (!f.sign[k] && box.half_edges[k] > 0)
      free_axes[count++] = k;
    else if (f.sign[k])
      out.normal = f.sign[k] * at.axes.col(k);
  const int corners = count == 0 ? 1 : count == 1 ? 2 : 4;
  constexpr std::int8_t si[] = {-1, 1, 1, -1}, sj[] = {-1, -1, 1, 1};
  for (int c = 0; c < corners; ++c) {
    Feature corner = f, edge = f;
    if (count > 0) corner.sign[free_axes[0]] = si[c];
    if (count > 1) {
      corner.sign[free_axes[1]] = sj[c];
      if (c % 2 == 0)
        edge.sign[free_axes[1]] = sj[c];
      else
        edge.sign[free_axes[0]] = si[c];
    }
    const Vec3 signs(corner.sign[0], corner.sign[1], corner.sign[2]);
    out.corners.push_back({at.to_world(box.half_edges.cwiseProduct(signs)), corner.code(), edge.code()});
  }
}

}  // namespace

void Box::touching_outline(const Placement& at, const Vec3& n, double slack, ContactOutline& out) const {
  const Vec3 d = at.direction_B(n);
  Feature f;
  for (int k = 0; k < 3; ++k)
    if (half_edges[k] > 0 && 2 * half_edges[k] * std::abs(d[k]) > slack) f.sign[k] = d[k] < 0 ? -1 : 1;
  outline_of(*this, at, f, out);
}

void Box::facing_outline(const Placement& at, const Vec3& n, ContactOutline& out) const {
  const Vec3 d = at.direction_B(n);
  const bool point = half_edges.isZero(0), segment = half_edges.x() == 0 && half_edges.z() > 0;
  Feature f;
  if (!point && !segment) {
    int k = 0;
    d.cwiseAbs().maxCoeff(&k);
    f.sign[k] = d[k] < 0 ? -1 : 1;
  }
  outline_of(*this, at, f, out);
}

}  // namespace silt::rigid
