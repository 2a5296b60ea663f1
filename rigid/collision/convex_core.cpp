#include "rigid/collision/convex_core.hpp"

#include "rigid/shapes/defaults.hpp"

namespace silt::rigid {

namespace {

/// Calls use(core), the core being the shape itself or what is swept.
template <class Use>
decltype(auto) visit_core(const ConvexShape& shape, Use&& use) {
  return std::visit([&](const auto& s) { return use(solid::core(s)); }, shape);
}

}  // namespace

Vec3 ConvexCore::support(const Vec3& n) const {
  const Vec3 d = direction_B(n);
  return to_world(visit_core(*shape, [&](const auto& core) -> Vec3 { return core.support(d); }));
}

Mat3 ConvexCore::support_derivative(const Vec3& n) const {
  if (is_polytope) return Mat3::Zero();
  const Vec3 d = direction_B(n);
  const Mat3 local =
      visit_core(*shape, [&](const auto& core) -> Mat3 { return solid::support_derivative(core, d); });
  return axes * local * axes.transpose();
}

void ConvexCore::kinks(const Vec3& n, double angle, Kinks& out) const {
  const Vec3 d = direction_B(n);
  visit_core(*shape, [&](const auto& core) { solid::kinks(core, *this, d, angle, out); });
}

double ConvexCore::touching_ball(const Vec3& x, const Vec3& n) const {
  const Vec3 d = direction_B(n), x_B = direction_B(x - centre);
  return visit_core(*shape, [&](const auto& core) { return solid::touching_ball(core, x_B, d); });
}

bool ConvexCore::is_revolved() const {
  return visit_core(*shape,
                    [](const auto& core) { return solid::is_revolved<std::remove_cvref_t<decltype(core)>>; });
}

InnerBall ConvexCore::inner_ball(const Vec3& x) const {
  const Vec3 x_B = direction_B(x - centre);
  const InnerBall ball = visit_core(*shape, [&](const auto& core) { return solid::inner_ball(core, x_B); });
  return {to_world(ball.centre), ball.radius};
}

void ConvexCore::touching_outline(const Vec3& n, double slack, ContactOutline& out) const {
  visit_core(*shape, [&](const auto& core) { solid::touching_outline(core, *this, n, slack, out); });
}

void ConvexCore::facing_outline(const Vec3& n, ContactOutline& out) const {
  visit_core(*shape, [&](const auto& core) { solid::facing_outline(core, *this, n, out); });
}

void ConvexCore::plane_points(const Vec3& n, std::vector<PlanePoint>& out) const {
  visit_core(*shape, [&](const auto& core) { solid::plane_points(core, *this, n, out); });
}

ConvexCore convex_core(const ConvexShape& shape, const Pose& pose) {
  ConvexCore core{
      {pose.position, pose.orientation.toRotationMatrix()}, &shape, Vec3::Zero(), 0, false, false};
  core.radius = std::visit([](const auto& s) { return solid::core_radius(s); }, shape);
  visit_core(shape, [&]<class Core>(const Core& swept) {
    core.half = solid::half_widths(swept);
    core.is_polytope = solid::is_polytope<Core>;
    core.is_box = std::is_same_v<Core, Box>;
  });
  return core;
}

bool has_codes(const ConvexShape& shape) {
  return std::visit([](const auto& s) { return solid::codes(s); }, shape) <= 1 << 16;
}

double length_scale(const ConvexCore& a, const ConvexCore& b) {
  return a.half.norm() + b.half.norm() + a.radius + b.radius + (b.centre - a.centre).norm();
}

}  // namespace silt::rigid
