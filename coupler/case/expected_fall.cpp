#include "coupler/case/expected_fall.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "coupler/case/body_text.hpp"
#include "coupler/case/case.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

constexpr double endless = std::numeric_limits<double>::infinity();
constexpr double least_exponent = 2.4;  // of Richardson and Zaki, at high Reynolds numbers

/// How far it is from a place to the first side that holds bodies, along a direction.
double way_to_a_side(const Case& scene, const Vec3& x, const Vec3& direction) {
  double way = endless;
  for (int d = 0; d < 3; ++d) {
    const bool up = direction[d] > 0;
    if (scene.periodic(d) || direction[d] == 0) continue;
    way = std::min(way, ((up ? scene.cells[d] : 0) - x[d]) / direction[d]);
  }
  return std::max(0., way);
}

/// Where it is as much as a body weighs.
Vec3 direction_of(const Case& scene, double density) {
  return (density > 1 ? 1 : -1) * scene.gravity.normalized();
}

double speed_of(const Case& scene, const Fall& fall, double gravity) {
  const double steady =
      terminal_velocity(fall.diameter, fall.density, gravity, scene.fluid->kinematic_viscosity);
  const double gain = std::abs(fall.density - 1) / (fall.density + 0.5) * gravity;
  const double on_the_way = std::sqrt(fall.start * fall.start + 2 * gain * fall.height);
  const double in_time = fall.start + gain * static_cast<double>(scene.steps);
  return std::min({fall.hindrance * steady, on_the_way, in_time});
}

double volume_of(const Case& scene, int shape) {
  return rigid::mass_properties(scene.shapes[shape]).volume;
}

double volume_fraction(const Case& scene) {
  double volume = 0;
  scene.for_each_given([&](const BodySpec& body, std::uint64_t count) {
    volume += static_cast<double>(count) * volume_of(scene, body.shape);
  });
  for (const FillSpec& fill : scene.fills)
    volume += static_cast<double>(fill.count) * volume_of(scene, fill.shape);
  return std::clamp(volume / (1. * scene.cells[0] * scene.cells[1] * scene.cells[2]), 0., 0.6);
}

/// The corner of a box that has the longest way to go.
Vec3 furthest_corner(const Vec3& lower, const Vec3& upper, const Vec3& direction) {
  Vec3 corner;
  for (int d = 0; d < 3; ++d) corner[d] = direction[d] > 0 ? lower[d] : upper[d];
  return corner;
}

double diameter_of(const Case& scene, int shape) {
  return std::cbrt(6 / std::numbers::pi * volume_of(scene, shape));
}

}  // namespace

std::vector<Fall> expected_falls(const Case& scene) {
  std::vector<Fall> falls;
  if (!scene.fluid || scene.gravity.norm() == 0) return falls;
  const double hindrance = std::pow(1 - volume_fraction(scene), least_exponent);
  scene.for_each_given([&](const BodySpec& body, std::uint64_t) {
    if (body.motion != rigid::Motion::free || body.density == 1) return;
    const std::string entry = entry_key(body.entry);
    if (falls.empty() || falls.back().entry != entry)
      falls.push_back({entry, diameter_of(scene, body.shape), body.density, hindrance});
    const Vec3 down = direction_of(scene, body.density);
    const double height = body.point > 0 ? endless : way_to_a_side(scene, body.pose.position, down);
    falls.back().start = std::max(falls.back().start, body.velocity.norm());
    falls.back().height = std::max(falls.back().height, height);
  });
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    const FillSpec& fill = scene.fills[i];
    if (fill.density == 1) continue;
    const Vec3 down = direction_of(scene, fill.density);
    const double height = way_to_a_side(scene, furthest_corner(fill.lower, fill.upper, down), down);
    falls.push_back({fmt::format("fill[{}]", i), diameter_of(scene, fill.shape), fill.density, hindrance,
                     fill.velocity.norm(), height});
  }
  for (Fall& fall : falls) fall.speed = speed_of(scene, fall, scene.gravity.norm());
  return falls;
}

double gravity_share(const Case& scene, const Fall& fall, double speed) {
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (speed_of(scene, fall, middle * scene.gravity.norm()) > speed ? high : low) = middle;
  }
  return low;
}

double terminal_velocity(double diameter, double density, double gravity, double nu) {
  const double buoyancy = 4. / 3 * std::abs(density - 1) * gravity * diameter;  // u^2 C_D
  const auto drag = [&](double u) {
    const double reynolds = u * diameter / nu;
    return 24 * nu / diameter * u * (1 + 0.15 * std::pow(reynolds, 0.687));
  };
  double low = 0, high = buoyancy * diameter / (24 * nu);  // Stokes: an upper bound
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (drag(middle) < buoyancy ? low : high) = middle;
  }
  return low;
}

}  // namespace silt::coupler
