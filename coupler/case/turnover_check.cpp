#include "coupler/case/turnover_check.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "coupler/case/body_text.hpp"
#include "coupler/case/case.hpp"
#include "coupler/case/case_extent.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

std::string box_text(const Case& scene, const Vec3& lower, const Vec3& upper) {
  return fmt::format("{} to {}", shown_point(scene, lower), shown_point(scene, upper));
}

void check_outflow(const Case& scene, Findings& findings, std::size_t index) {
  const OutflowSpec& outflow = scene.outflows[index];
  const std::string key = fmt::format("outflow[{}].box", index);
  const std::string is = fmt::format("{} is {}", key, box_text(scene, outflow.lower, outflow.upper));
  const Vec3 size = extent_of(scene).size;
  if ((outflow.lower.array() < 0).any() || (outflow.upper.array() > size.array()).any())
    return findings.error(key, fmt::format("{}; it must lie in the domain, {}; beyond a side that is not "
                                           "solid_for_bodies bodies leave without it",
                                           is, box_text(scene, Vec3::Zero(), size)));
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    const FillSpec& fill = scene.fills[i];
    if (fill.every > 0 && (outflow.lower.array() < fill.upper.array()).all() &&
        (fill.lower.array() < outflow.upper.array()).all())
      findings.error(key, fmt::format("{}; it meets fill[{}].box, {}, where bodies come in: they would "
                                      "leave at once; move them apart",
                                      is, i, box_text(scene, fill.lower, fill.upper)));
  }
}

/// The step by which a ball that keeps its velocity is wholly beyond a side, and which; infinite if it never
/// is.
struct WayOut {
  double step = std::numeric_limits<double>::infinity();
  int side = 0;
};
WayOut way_out(const Case& scene, const BodySpec& body) {
  const double radius = rigid::bounding_radius(scene.shapes[body.shape]);
  WayOut first;
  for (int d = 0; d < 3; ++d) {
    const double v = body.velocity[d], x = body.pose.position[d];
    if (scene.periodic(d) || v == 0) continue;
    const double step = ((v > 0 ? scene.cells[d] - x : x) + radius) / std::abs(v);
    if (step < first.step) first = {step, 2 * d + (v > 0)};
  }
  return first;
}

/// Bodies of prescribed motion that the case itself moves out of the domain: one message an entry.
void check_prescribed(const Case& scene, Findings& findings) {
  int said_of = -1;
  for (const BodySpec& body : scene.bodies) {
    const WayOut out = way_out(scene, body);
    if (body.motion != rigid::Motion::prescribed || body.entry == said_of ||
        !(out.step < static_cast<double>(scene.steps)))
      continue;
    said_of = body.entry;
    const std::string key = entry_key(body.entry) + ".velocity";
    findings.warning(
        key, fmt::format("{} takes the body out of the domain past {} by step {:.0f} of {}: {}; end the run "
                         "before, or make it slower",
                         key, side_names[Side(out.side)], std::ceil(out.step), scene.steps,
                         scene.boundary[out.side].removes_bodies() ? "it is taken out there"
                                                                   : "the run stops there"));
  }
}

}  // namespace

void find_turnover_faults(const Case& scene, Findings& findings) {
  for (std::size_t i = 0; i < scene.outflows.size(); ++i) check_outflow(scene, findings, i);
  check_prescribed(scene, findings);
  const bool any_free = !scene.fills.empty() || scene.any_given([](const BodySpec& body) {
    return body.motion == rigid::Motion::free;
  });
  if (!scene.outflows.empty() && !any_free)
    findings.warning("outflow", "outflow: the case has no free bodies, and no others leave");
  for (std::size_t i = 0; i < scene.fills.size(); ++i) {
    const FillSpec& fill = scene.fills[i];
    const std::string key = fmt::format("fill[{}].every", i);
    if (fill.every == 0) continue;
    if (fill.every >= scene.steps || static_cast<double>(fill.every) > fill.until)
      findings.warning(
          key, fmt::format("{} is {}, of {} steps in all{}: bodies come at the start only", key, fill.every,
                           scene.steps,
                           static_cast<double>(fill.every) > fill.until ? " and before `until`" : ""));
  }
}

}  // namespace silt::coupler
