#pragma once
// A small closed-form collision backend for the tests of rigid/ alone: spheres, boxes and capsules against
// half-spaces, spheres against all, capsules against capsules, boxes against boxes by their faces (no
// edge-edge).
#include <algorithm>
#include <cmath>

#include "rigid/collision_backend.hpp"

namespace silt::rigid::testing {

class TestBackend : public CollisionBackend {
 public:
  std::string_view name() const override { return "test"; }
  bool supports(const ConvexShape&, const ConvexShape&) const override { return true; }

  void collide(const ConvexShape& a, const Pose& pa, const ConvexShape& b, const Pose& pb, double tolerance,
               std::vector<ContactPoint>& out) override {
    ++counters_.queries;
    const std::size_t first = out.size();
    std::visit([&](const auto& sa, const auto& sb) { pair(sa, pa, sb, pb, out); }, a, b);
    std::erase_if(out, [&, k = std::size_t{0}](const ContactPoint& p) mutable {
      return k++ >= first && p.gap > tolerance;
    });
  }

 private:
  using Points = std::vector<ContactPoint>;

  static void balls(const Vec3& xa, double ra, const Vec3& xb, double rb, std::uint32_t feature,
                    Points& out) {
    const Vec3 d = xb - xa;
    const double distance = d.norm();
    const Vec3 n = distance > 0 ? Vec3(d / distance) : Vec3(Vec3::UnitX());
    out.push_back({xa + ra * n, xb - rb * n, n, distance - ra - rb, feature});
  }
  /// A ball of radius r at x against the plane of a half-space.
  static void ball_plane(const Vec3& x, double r, const HalfSpace& h, const Pose& p, std::uint32_t feature,
                         Points& out) {
    const Vec3 n = p.orientation * h.normal;
    const double gap = n.dot(x - p.position) - r;
    const Vec3 on_a = x - r * n;
    out.push_back({on_a, on_a - gap * n, -n, gap, feature});
  }
  static void flip(Points& out, std::size_t first) {
    for (std::size_t k = first; k < out.size(); ++k) {
      std::swap(out[k].on_a, out[k].on_b);
      out[k].normal = -out[k].normal;
    }
  }
  static Vec3 on_axis(const Capsule& c, const Pose& p, const Vec3& x) {
    const double z = std::clamp(p.to_body(x)[2], -c.half_length, c.half_length);
    return p.to_world({0, 0, z});
  }

  static void pair(const Sphere& a, const Pose& pa, const Sphere& b, const Pose& pb, Points& out) {
    balls(pa.position, a.radius, pb.position, b.radius, 0, out);
  }
  static void pair(const Sphere& a, const Pose& pa, const HalfSpace& h, const Pose& pb, Points& out) {
    ball_plane(pa.position, a.radius, h, pb, 0, out);
  }
  static void pair(const Sphere& a, const Pose& pa, const Capsule& b, const Pose& pb, Points& out) {
    balls(pa.position, a.radius, on_axis(b, pb, pa.position), b.radius, 0, out);
  }
  static void pair(const Sphere& a, const Pose& pa, const Box& b, const Pose& pb, Points& out) {
    const Vec3 x = pb.to_body(pa.position);
    Vec3 near = x.cwiseMax(-b.half_edges).cwiseMin(b.half_edges), n = near - x;
    double distance = n.norm();
    if (distance == 0) {  // the centre is inside: out through the nearest face
      int axis;
      (b.half_edges - x.cwiseAbs()).minCoeff(&axis);
      near[axis] = std::copysign(b.half_edges[axis], x[axis]);
      n = x - near, distance = -n.norm();
    }
    n /= std::abs(distance);
    const Vec3 n_W = pb.orientation * n;
    out.push_back({pa.position + a.radius * n_W, pb.to_world(near), n_W, distance - a.radius, 0});
  }
  static void pair(const Capsule& a, const Pose& pa, const HalfSpace& h, const Pose& pb, Points& out) {
    ball_plane(pa.to_world({0, 0, -a.half_length}), a.radius, h, pb, 0, out);
    ball_plane(pa.to_world({0, 0, a.half_length}), a.radius, h, pb, 1, out);
  }
  static void pair(const Box& a, const Pose& pa, const HalfSpace& h, const Pose& pb, Points& out) {
    for (unsigned k = 0; k < 8; ++k) ball_plane(pa.to_world(corner(a, k)), 0, h, pb, k, out);
  }
  static void pair(const Capsule& a, const Pose& pa, const Capsule& b, const Pose& pb, Points& out) {
    // closest points of two segments
    const Vec3 u = pa.orientation * Vec3::UnitZ(), v = pb.orientation * Vec3::UnitZ(),
               w = pa.position - pb.position;
    const double c = u.dot(v), det = 1 - c * c;
    double s = det > 1e-12 ? std::clamp((c * v.dot(w) - u.dot(w)) / det, -a.half_length, a.half_length) : 0;
    const double t = std::clamp(c * s + v.dot(w), -b.half_length, b.half_length);
    s = std::clamp(c * t - u.dot(w), -a.half_length, a.half_length);
    balls(pa.position + s * u, a.radius, pb.position + t * v, b.radius, 0, out);
  }
  static void pair(const Box& a, const Pose& pa, const Box& b, const Pose& pb, Points& out) {
    const Mat3 ra = pa.orientation.toRotationMatrix(), rb = pb.orientation.toRotationMatrix();
    const Vec3 d = pb.position - pa.position;
    double best = -1e300;
    Vec3 n;
    bool of_a = true;
    for (int k = 0; k < 6; ++k) {
      const bool face_a = k < 3;
      const Vec3 axis = face_a ? ra.col(k) : rb.col(k - 3);
      const double other = face_a ? (rb.transpose() * axis).cwiseAbs().dot(b.half_edges)
                                  : (ra.transpose() * axis).cwiseAbs().dot(a.half_edges);
      const double own = face_a ? a.half_edges[k] : b.half_edges[k - 3];
      const double gap = std::abs(axis.dot(d)) - own - other;
      if (gap > best + 1e-9) best = gap, n = axis.dot(d) < 0 ? Vec3(-axis) : axis, of_a = face_a;
    }
    const std::size_t first = out.size();
    if (of_a) {
      clip(a, pa, b, pb, n, out);
    } else {
      clip(b, pb, a, pa, -n, out);
      flip(out, first);
    }
  }
  /// Corners of b's face that looks against n, and where its outline crosses a's face with normal n.
  static void clip(const Box& a, const Pose& pa, const Box& b, const Pose& pb, const Vec3& n, Points& out) {
    const Vec3 n_a = pa.orientation.conjugate() * n, n_b = pb.orientation.conjugate() * n;
    int axis, incident;
    n_a.cwiseAbs().maxCoeff(&axis);
    n_b.cwiseAbs().maxCoeff(&incident);
    const int i1 = (incident + 1) % 3, i2 = (incident + 2) % 3;
    std::vector<Vec3> polygon;
    for (int k = 0; k < 4; ++k) {
      Vec3 x = b.half_edges;
      x[incident] *= n_b[incident] > 0 ? -1 : 1;
      if (k == 1 || k == 2) x[i1] = -x[i1];
      if (k >= 2) x[i2] = -x[i2];
      polygon.push_back(pa.to_body(pb.to_world(x)));
    }
    for (int d = 1; d <= 2; ++d)
      for (double side : {-1.0, 1.0}) {
        const int e = (axis + d) % 3;
        std::vector<Vec3> kept;
        for (std::size_t k = 0; k < polygon.size(); ++k) {
          const Vec3 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
          const double fp = side * p[e] - a.half_edges[e], fq = side * q[e] - a.half_edges[e];
          if (fp <= 0) kept.push_back(p);
          if ((fp < 0 && fq > 0) || (fp > 0 && fq < 0)) kept.push_back(p + (q - p) * (fp / (fp - fq)));
        }
        polygon = kept;
      }
    const double face = a.half_edges[axis];
    std::uint32_t feature = 0;
    for (const Vec3& x : polygon) {
      const double gap = std::copysign(1.0, n_a[axis]) * x[axis] - face;
      const Vec3 x_W = pa.to_world(x);
      out.push_back({x_W - gap * n, x_W, n, gap, feature++});
    }
  }
  static Vec3 corner(const Box& b, unsigned k) {
    return {(k & 1 ? 1 : -1) * b.half_edges[0], (k & 2 ? 1 : -1) * b.half_edges[1],
            (k & 4 ? 1 : -1) * b.half_edges[2]};
  }
  template <class A, class B>
  static void pair(const A& a, const Pose& pa, const B& b, const Pose& pb, Points& out) {
    if constexpr (!std::is_same_v<A, HalfSpace> && (std::is_same_v<B, Sphere>)) {
      const std::size_t first = out.size();
      pair(b, pb, a, pa, out);
      flip(out, first);
    }
  }
};

}  // namespace silt::rigid::testing
