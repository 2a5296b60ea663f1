#include "rigid/shapes/convex_shape.hpp"

namespace silt::rigid {

namespace {

template <class S>
constexpr bool has_curvature = requires(const S& s, const Vec3& x) {
  s.curvature(x, x);
};

}  // namespace

Vec3 support(const ConvexShape& shape, const Vec3& direction) {
  const double length = direction.norm();
  const Vec3 unit = length > 0 ? Vec3(direction / length) : Vec3(Vec3::UnitX());
  return std::visit([&](const auto& s) -> Vec3 { return s.support(unit); }, shape);
}

std::optional<LineInterval> line_interval(const ConvexShape& shape, const Vec3& origin,
                                          const Vec3& direction) {
  return std::visit([&](const auto& s) { return s.line_interval(origin, direction); }, shape);
}

std::optional<Mat3> curvature(const ConvexShape& shape, const Vec3& x, const Vec3& n) {
  return std::visit(
      [&]<class S>(const S& s) -> std::optional<Mat3> {
        if constexpr (has_curvature<S>)
          return s.curvature(x, n);
        else
          return std::nullopt;
      },
      shape);
}

bool is_smooth(const ConvexShape& shape) {
  return std::visit([]<class S>(const S&) { return has_curvature<S>; }, shape);
}

}  // namespace silt::rigid
