#include "silt/case/quiet_start_steps.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "silt/case/case.hpp"

namespace silt {

using rigid::Vec3;

namespace {

bool has_weights(const Case& setup) {
  return !setup.gravity_at(0.5).isZero(0) && std::ranges::any_of(entries_of(setup), [](const Entry& entry) {
    return entry.is_free() && entry.density != 1;
  });
}

/// Returns whether pressure must balance a load; of a periodic body force only with an obstacle.
bool is_loaded(const Case& setup) {
  if (has_weights(setup) || !setup.springs.empty()) return true;
  const Vec3 force = setup.fluid->body_force_over_time.at(0) * setup.fluid->body_force;
  for (int d = 0; d < 3; ++d)
    if (force[d] != 0 && (!setup.periodic(d) || setup.has_surfaces())) return true;
  return false;
}

}  // namespace

bool begins_at_rest(const Case& setup) {
  const coupler::InitialSpec& initial = setup.fluid->initial;
  return initial.type == coupler::InitialFlow::rest && initial.noise == 0 && !setup.start &&
         std::ranges::none_of(setup.boundary, &coupler::BoundarySpec::is_inlet);
}

std::int64_t quiet_start_steps(const Case& setup) {
  if (!setup.fluid || !setup.fluid->quiet_start || !begins_at_rest(setup) || !is_loaded(setup)) return 0;
  double way = 0;
  for (int d = 0; d < 3; ++d) way = std::max(way, (setup.periodic(d) ? 1. : 2.) * setup.cells[d]);
  const std::int64_t stride = setup.coarsening ? setup.coarsening->stride() : 1;
  return stride * std::int64_t(std::ceil(way * std::numbers::sqrt3 / double(stride)));
}

}  // namespace silt
