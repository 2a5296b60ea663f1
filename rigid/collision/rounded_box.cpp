#include "rigid/collision/rounded_box.hpp"

#include <stdexcept>

namespace silt::rigid {

RoundedBox rounded_box(const ConvexShape& shape, const Pose& pose) {
  RoundedBox core{pose.position, Mat3::Identity(), Vec3::Zero(), 0};
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    core.radius = sphere->radius;  // looks the same from everywhere
    return core;
  }
  core.axes = pose.orientation.toRotationMatrix();
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    core.radius = capsule->radius;
    core.half.z() = capsule->half_length;
  } else if (const auto* box = std::get_if<Box>(&shape)) {
    core.half = box->half_edges;
  } else {
    throw std::invalid_argument("only a sphere, a capsule and a box have a box for a core");
  }
  return core;
}

double length_scale(const RoundedBox& a, const RoundedBox& b) {
  return a.half.norm() + b.half.norm() + a.radius + b.radius + (b.centre - a.centre).norm();
}

}  // namespace silt::rigid
