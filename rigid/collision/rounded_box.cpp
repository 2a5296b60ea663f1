#include "rigid/collision/rounded_box.hpp"

#include <stdexcept>

#include "rigid/shapes/defaults.hpp"

namespace silt::rigid {

namespace {

/// Its core, where that is a box.
std::optional<Box> box_of(const ConvexShape& shape) {
  return std::visit(
      []<class S>(const S& s) -> std::optional<Box> {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(solid::core(s))>, Box>)
          return solid::core(s);
        else
          return std::nullopt;
      },
      shape);
}

}  // namespace

bool has_rounded_box(const ConvexShape& shape) {
  return box_of(shape).has_value();
}

RoundedBox rounded_box(const ConvexShape& shape, const Pose& pose) {
  const std::optional<Box> box = box_of(shape);
  if (!box) throw std::invalid_argument("only a sphere, a capsule and a box have a box for a core");
  const double radius = std::visit([](const auto& s) { return solid::core_radius(s); }, shape);
  RoundedBox core{pose.position, Mat3::Identity(), box->half_edges, radius};
  if (core.extent() > 0)
    core.axes = pose.orientation.toRotationMatrix();  // else it looks alike from everywhere
  return core;
}

double length_scale(const RoundedBox& a, const RoundedBox& b) {
  return a.half.norm() + b.half.norm() + a.radius + b.radius + (b.centre - a.centre).norm();
}

}  // namespace silt::rigid
