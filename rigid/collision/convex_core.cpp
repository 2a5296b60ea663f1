#include "rigid/collision/convex_core.hpp"

namespace silt::rigid {
namespace {

/// Calls use(core), where the core is the shape itself or the swept box.
template <class Use>
decltype(auto) visit_core(const ConvexShape& shape, Use&& use) {
  return std::visit(
      [&](const auto& s) -> decltype(auto) {
        if constexpr (requires { s.core(); })
          return use(s.core());
        else
          return use(s);
      },
      shape);
}

template <class S>
constexpr bool polytope = requires {
  S::is_polytope;
};

template <class S>
Vec3 half_widths(const S& s) {
  if constexpr (requires { s.half_widths(); }) {
    return s.half_widths();
  } else {
    Vec3 half;
    for (int k = 0; k < 3; ++k)
      half[k] = std::max(s.support(Vec3::Unit(k))[k], -s.support(-Vec3::Unit(k))[k]);
    return half;
  }
}

/// Returns the derivative of the support point, by central differences unless the shape provides it.
template <class S>
Mat3 derivative(const S& s, const Vec3& n) {
  if constexpr (requires { s.support_derivative(n); }) {
    return s.support_derivative(n);
  } else if constexpr (polytope<S>) {
    return Mat3::Zero();
  } else {
    constexpr double step = 1e-5;  // radian; balances rounding and the third derivative
    const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
    Mat3 k = Mat3::Zero();
    for (const Vec3& t : {u, v})
      k += (s.support((n + step * t).normalized()) - s.support((n - step * t).normalized())) *
           (t / (2 * step)).transpose();
    return k;
  }
}

}  // namespace

Vec3 ConvexCore::support(const Vec3& n) const {
  const Vec3 d = direction_B(n);
  return to_world(visit_core(*shape, [&](const auto& core) -> Vec3 { return core.support(d); }));
}

Mat3 ConvexCore::support_derivative(const Vec3& n) const {
  if (is_polytope) return Mat3::Zero();
  const Vec3 d = direction_B(n);
  const Mat3 local = visit_core(*shape, [&](const auto& core) { return derivative(core, d); });
  return axes * local * axes.transpose();
}

void ConvexCore::kinks(const Vec3& n, double angle, Kinks& out) const {
  const Vec3 d = direction_B(n);
  visit_core(*shape, [&](const auto& core) {
    if constexpr (requires { core.kinks(*this, d, angle, out); }) core.kinks(*this, d, angle, out);
  });
}

double ConvexCore::touching_ball(const Vec3& x, const Vec3& n) const {
  const Vec3 d = direction_B(n), x_B = direction_B(x - centre);
  return visit_core(*shape, [&](const auto& core) -> double {
    if constexpr (requires { core.touching_ball(x_B, d); })
      return core.touching_ball(x_B, d);
    else
      return 0;
  });
}

bool ConvexCore::is_revolved() const {
  return visit_core(*shape, []<class Core>(const Core&) {
    return requires {
      Core::is_revolved;
    };
  });
}

InnerBall ConvexCore::inner_ball(const Vec3& x) const {
  const Vec3 x_B = direction_B(x - centre);
  const InnerBall ball = visit_core(*shape, [&](const auto& core) -> InnerBall {
    if constexpr (requires { core.inner_ball(x_B); })
      return core.inner_ball(x_B);
    else
      return {Vec3::Zero(), 0};
  });
  return {to_world(ball.centre), ball.radius};
}

void ConvexCore::touching_outline(const Vec3& n, double slack, ContactOutline& out) const {
  visit_core(*shape, [&](const auto& core) {
    if constexpr (requires { core.touching_outline(*this, n, slack, out); })
      core.touching_outline(*this, n, slack, out);
    else
      out.set_point(support(n), 0);
  });
}

void ConvexCore::facing_outline(const Vec3& n, ContactOutline& out) const {
  visit_core(*shape, [&](const auto& core) {
    if constexpr (requires { core.facing_outline(*this, n, out); })
      core.facing_outline(*this, n, out);
    else
      out.set_point(support(n), 0);
  });
}

void ConvexCore::plane_points(const Vec3& n, std::vector<PlanePoint>& out) const {
  visit_core(*shape, [&](const auto& core) {
    if constexpr (requires { core.plane_points(*this, n, out); })
      core.plane_points(*this, n, out);
    else
      out.push_back({support(n), 0});
  });
}

ConvexCore convex_core(const ConvexShape& shape, const Pose& pose) {
  ConvexCore core{{pose.position, Mat3::Identity()}, &shape, Vec3::Zero(), 0, false, false};
  std::visit(
      [&](const auto& s) {
        if constexpr (requires { s.core_radius(); }) core.radius = s.core_radius();
      },
      shape);
  visit_core(shape, [&]<class Core>(const Core& swept) {
    core.half = half_widths(swept);
    core.is_polytope = polytope<Core>;
    core.is_box = std::is_same_v<Core, Box>;
  });
  if (!core.is_point()) core.axes = pose.orientation.toRotationMatrix();  // a point has no orientation
  return core;
}

bool has_codes(const ConvexShape& shape) {
  return std::visit(
      [](const auto& s) {
        if constexpr (requires { s.codes(); })
          return s.codes() <= 1 << 16;
        else
          return true;
      },
      shape);
}

double length_scale(const ConvexCore& a, const ConvexCore& b) {
  return a.half.norm() + b.half.norm() + a.radius + b.radius + (b.centre - a.centre).norm();
}

}  // namespace silt::rigid
