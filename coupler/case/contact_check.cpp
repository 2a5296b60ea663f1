#include "coupler/case/contact_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coupler/case/body_text.hpp"
#include "coupler/case/case.hpp"
#include "coupler/case/sleep.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

constexpr double most_friction = 5;    // of dry matter it is up to about 1
constexpr double steepest_angle = 89;  // degrees
constexpr double usual_margin = 1;     // cells

/// The key that gives a coefficient, of all pairs or of one, if there is but one.
std::string coefficient_key(const Case& scene, const char* name) {
  std::vector<std::string> keys;
  for (const auto& [key, place] : scene.places)
    if (key.starts_with("contacts") || key.starts_with("material_pairs"))
      if (key.ends_with(fmt::format(".{}", name))) keys.push_back(key);
  return keys.size() == 1 ? keys[0] : "material_pairs";
}

void check_friction(const Case& scene, Findings& findings) {
  double highest = 0;
  for (const rigid::Material& material : scene.pair_materials) highest = std::max(highest, material.friction);
  if (highest <= most_friction) return;
  const double tangent = std::tan(std::min(highest, steepest_angle) * std::numbers::pi / 180);
  findings.warning(coefficient_key(scene, "friction"),
                   fmt::format("a friction is {}; of dry matter it is up to about 1: it is no angle but the "
                               "tangent of one, {:.2f} for {} degrees",
                               shown(highest), tangent, shown(std::min(highest, steepest_angle))));
}

void check_materials(const Case& scene, Findings& findings) {
  for (const rigid::Material& material : scene.pair_materials) {
    if (!(material.restitution >= 0 && material.restitution <= 1))
      findings.error("contacts.restitution", fmt::format("a restitution is {}; it must be between 0 and 1",
                                                         shown(material.restitution)));
    if (!(material.friction >= 0))
      findings.error("contacts.friction",
                     fmt::format("a friction is {}; it must be at least 0", shown(material.friction)));
  }
}

double largest_body(const Case& scene) {
  double largest = 0;
  const auto take = [&](int shape) {
    largest = std::max(largest, 2 * rigid::bounding_radius(scene.shapes[shape]));
  };
  scene.for_each_given([&](const BodySpec& body, std::uint64_t) { take(body.shape); });
  for (const FillSpec& fill : scene.fills) take(fill.shape);
  return largest;
}

void check_margin(const Case& scene, Findings& findings) {
  const double margin = scene.contacts.margin;
  if (margin < 0)
    findings.error("contacts.margin",
                   fmt::format("contacts.margin is {} cells; it must be at least 0", shown(margin)));
  const double shortest = *std::min_element(scene.cells.begin(), scene.cells.end());
  const double largest = largest_body(scene);
  if (!scene.has_bodies() || margin <= std::max(usual_margin, largest)) return;
  findings.warning(
      "contacts.margin",
      fmt::format("contacts.margin is {}, more than the largest body ({}) and {} of the domain's "
                  "shortest side: every pair nearer than that is a contact; use {} (one cell)",
                  shown_length(scene, margin), shown_length(scene, largest), shown(margin / shortest),
                  shown_length(scene, usual_margin)));
}

void check_lubrication(const Case& scene, Findings& findings) {
  if (scene.places.count("coupling.lubrication") && scene.coupling.lubrication && !scene.has_lubrication())
    findings.error("coupling.lubrication",
                   fmt::format("coupling.lubrication is true, but contacts.resolver is '{}', which knows no "
                               "lubrication films; set contacts.resolver = \"sffd\", or remove the key",
                               scene.contacts.resolver));
  const double gap = scene.coupling.lubrication_min_gap;
  if (gap > usual_margin)
    findings.warning(
        "coupling.lubrication_min_gap",
        fmt::format("coupling.lubrication_min_gap is {}, which the lattice resolves ({} cells): it "
                    "is the height of a surface's roughness; without the key it is a "
                    "thousandth of the radius",
                    shown_length(scene, gap), shown(gap)));
}

/// A body at the top of its path must not sleep: it is slower than the speed for as long as gravity takes to
/// give it twice that.
void check_sleep(const Case& scene, Findings& findings) {
  const auto rule = sleep_rule(scene);
  if (!rule) return;
  const double gravity = scene.gravity.norm();
  if (gravity == 0 && !scene.contacts.sleep_time)
    findings.error(
        "contacts.sleep_speed",
        "there is no gravity that tells how long a body is to be slower than contacts.sleep_speed; "
        "give contacts.sleep_time");
  constexpr double most_of_gravity = 0.1;
  if (gravity > 0 && rule->speed / rule->steps > most_of_gravity * gravity)
    findings.warning("contacts.sleep_speed",
                     fmt::format("bodies at rest sleep until {} of gravity is not balanced; use a longer "
                                 "contacts.sleep_time, or a lower contacts.sleep_speed",
                                 shown(rule->speed / rule->steps / gravity)));
}

}  // namespace

void find_contact_faults(const Case& scene, Findings& findings) {
  check_materials(scene, findings);
  check_friction(scene, findings);
  check_margin(scene, findings);
  check_lubrication(scene, findings);
  check_sleep(scene, findings);
}

}  // namespace silt::coupler
