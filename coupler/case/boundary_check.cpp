#include "coupler/case/boundary_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/case/case.hpp"
#include "coupler/case/speed_check.hpp"

namespace silt::coupler {
namespace {

std::string velocity_key(int side) {
  return fmt::format("{}.velocity", side_key(side));
}

std::string shown_velocity(const Case& scene, const rigid::Vec3& v) {
  const double scale = scene.units.scale(dimension::velocity);
  return fmt::format("[{}, {}, {}]", shown(v[0] * scale), shown(v[1] * scale), shown(v[2] * scale));
}

void check_moving_wall(const Case& scene, Findings& findings, int side) {
  const BoundarySpec& wall = scene.boundary[side];
  check_speed(findings, velocity_key(side), wall.velocity.norm());
  if (std::abs(wall.velocity[side / 2]) > 0)
    findings.error(velocity_key(side),
                   fmt::format("{} moves through itself: the velocity of a moving wall must have no "
                               "component along {}",
                               side_key(side), "xyz"[side / 2]));
}

void check_inlet(const Case& scene, Findings& findings, int side) {
  const rigid::Vec3& velocity = scene.boundary[side].velocity;
  check_speed(findings, velocity_key(side), velocity.norm());
  const double inwards = side % 2 == 0 ? velocity[side / 2] : -velocity[side / 2];
  if (inwards > 0) return;
  rigid::Vec3 turned = velocity;
  turned[side / 2] = -turned[side / 2];
  findings.warning(
      velocity_key(side),
      inwards < 0
          ? fmt::format("{} is {}, which points out of the domain: fluid leaves there; for an inlet "
                        "use velocity = {}",
                        velocity_key(side), shown_velocity(scene, velocity), shown_velocity(scene, turned))
          : fmt::format("{} is {}, of which nothing goes along {}: no fluid comes in; for a wall "
                        "that moves along itself use type = \"moving\"",
                        velocity_key(side), shown_velocity(scene, velocity), "xyz"[side / 2]));
}

void check_outlet(const Case& scene, Findings& findings, int side) {
  const double density = scene.boundary[side].density;
  if (density > 0.5 && density < 1.5) return;
  findings.error(fmt::format("{}.density", side_key(side)),
                 fmt::format("{}.density is {} times the fluid's; it must be between 0.5 and 1.5: in this "
                             "method density is pressure",
                             side_key(side), shown(density)));
}

void check_flows(const Case& scene, Findings& findings) {
  int inlet = -1;
  bool outlet = false;
  for (int side = 0; side < 6; ++side) {
    const BoundaryKind kind = scene.boundary[side].kind;
    if (kind == BoundaryKind::moving) check_moving_wall(scene, findings, side);
    if (kind == BoundaryKind::velocity_inlet) check_inlet(scene, findings, inlet = side);
    if (kind == BoundaryKind::pressure_outlet) check_outlet(scene, findings, side), outlet = true;
  }
  if (inlet >= 0 && !outlet)
    findings.error(side_key(inlet),
                   fmt::format("{} is a velocity-inlet, but no side is a pressure-outlet: the density would "
                               "grow without end; make one side \"pressure-outlet\"",
                               side_key(inlet)));
}

/// A flow needs a fluid.
void check_dry_sides(const Case& scene, Findings& findings) {
  for (int side = 0; side < 6; ++side) {
    const BoundaryKind kind = scene.boundary[side].kind;
    if (kind == BoundaryKind::velocity_inlet || kind == BoundaryKind::pressure_outlet)
      findings.warning(
          side_key(side),
          fmt::format("{} is \"{}\", but the case has no [fluid]: bodies meet it as a wall; write "
                      "\"no-slip\"",
                      side_key(side), boundary_names[kind]));
  }
}

}  // namespace

const char* side_key(int side) {
  constexpr const char* keys[6] = {"domain.boundary.x[0]", "domain.boundary.x[1]", "domain.boundary.y[0]",
                                   "domain.boundary.y[1]", "domain.boundary.z[0]", "domain.boundary.z[1]"};
  return keys[side];
}

void find_boundary_faults(const Case& scene, Findings& findings) {
  for (int d = 0; d < 3; ++d)
    if ((scene.boundary[2 * d].kind == BoundaryKind::periodic) !=
        (scene.boundary[2 * d + 1].kind == BoundaryKind::periodic))
      findings.error(
          fmt::format("domain.boundary.{}", "xyz"[d]),
          fmt::format("domain.boundary.{} is periodic on one side only; a periodic axis has no sides",
                      "xyz"[d]));
  if (scene.fluid)
    check_flows(scene, findings);
  else
    check_dry_sides(scene, findings);
}

}  // namespace silt::coupler
