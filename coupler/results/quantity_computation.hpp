#pragma once
// How quantities are computed: the form that every family of them (body_quantities, flow_quantities,
// wall_quantities) fills in. Computations are collective, give the same on every rank and any number of
// ranks, and speak lattice units; NaN stands for a value that does not exist (no such body, no step yet).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include "coupler/case/quantity_spec.hpp"
#include "coupler/simulation.hpp"
#include "rigid/math/exact_sum.hpp"

namespace silt::coupler {

/// What a quantity that looks at the whole run has gathered so far: numbers of which the largest over the
/// ranks counts.
using QuantityHistory = std::array<double, 3>;
inline constexpr double not_yet = -std::numeric_limits<double>::infinity();
inline constexpr QuantityHistory no_history{not_yet, not_yet, not_yet};
inline constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// Sums over the ranks that a quantity needs of a step. They are put together many steps at a time, so none
/// waits for another rank: `add` gives this rank's terms after a step, and `fold`, later and on every rank,
/// takes the sums of one step after the other into the history.
struct StepSums {
  int count = 0;  // 0: none
  /// Returns whether the step counts, which every rank must find alike.
  bool (*add)(const Simulation&, const QuantitySpec&, const QuantityHistory&,
              std::span<rigid::ExactSum>) = nullptr;
  void (*fold)(const Case&, const QuantitySpec&, std::int64_t step, std::span<const double>,
               QuantityHistory&) = nullptr;
};

struct Computation {
  void (*observe)(const Simulation&, const QuantitySpec&, QuantityHistory&);  // after every step; or null
  double (*value)(const Simulation&, const QuantitySpec&, const QuantityHistory&);
  StepSums sums = {};
  /// Of a mean over steps: its value in the last one; else null.
  double (*in_last_step)(const QuantityHistory&) = nullptr;
};

/// The name of a type as a template argument.
struct TypeName {
  char text[40] = {};
  constexpr TypeName(std::string_view name) { std::copy(name.begin(), name.end(), text); }
  constexpr TypeName(const char* name) : TypeName(std::string_view(name)) {}
};

template <TypeName name>
consteval Computation missing_computation() {
  static_assert(name.text[0] == 0, "this row of quantity_types has no computation");
  return {};
}

/// The computation of the type of a name. Each family specialises it beside its functions.
template <TypeName name>
inline constexpr Computation computation = missing_computation<name>();

// ---- the usual forms ----

/// A function of the state at the end: f(simulation, spec) or f(simulation).
template <auto f>
double value_at_end(const Simulation& simulation, const QuantitySpec& q, const QuantityHistory&) {
  if constexpr (requires { f(simulation, q); })
    return f(simulation, q);
  else
    return f(simulation);
}
template <auto f>
inline constexpr Computation at_end = {nullptr, value_at_end<f>};

/// What has been observed: the first number of the history.
inline double value_seen(const Simulation&, const QuantitySpec&, const QuantityHistory& h) {
  return h[0] == not_yet ? no_value : h[0];
}
template <auto observe>
inline constexpr Computation seen = {observe, value_seen};

/// The mean over the steps from the spec's time on: their sum, their number, and the value in the last step,
/// which may be before that time. Value of a step: f(case, spec, step, sums) or f(case, spec, sums).
inline double value_mean(const Simulation&, const QuantitySpec&, const QuantityHistory& h) {
  return h[0] == not_yet ? no_value : h[0] / h[1];
}
inline double value_in_last_step(const QuantityHistory& h) {
  return h[2] == not_yet ? no_value : h[2];
}
template <auto f>
void fold_into_mean(const Case& scene, const QuantitySpec& q, std::int64_t step, std::span<const double> sums,
                    QuantityHistory& h) {
  if constexpr (requires { f(scene, q, step, sums); })
    h[2] = f(scene, q, step, sums);
  else
    h[2] = f(scene, q, sums);
  if (static_cast<double>(step) < q.time) return;
  if (h[0] == not_yet) h[0] = h[1] = 0;
  h[0] += h[2];
  h[1] += 1;
}
template <int count, auto add, auto f>
inline constexpr Computation mean_of = {
    nullptr, value_mean, {count, add, fold_into_mean<f>}, value_in_last_step};

/// f(simulation) at the first step within half a step of the spec's time or after it; without a time, at the
/// end.
template <auto f>
void observe_instant(const Simulation& simulation, const QuantitySpec& q, QuantityHistory& h) {
  if (h[0] == not_yet && static_cast<double>(simulation.steps_done()) >= q.time - 0.5) h[0] = f(simulation);
}
template <auto f>
double value_at_instant(const Simulation& simulation, const QuantitySpec& q, const QuantityHistory& h) {
  return std::isfinite(q.time) ? value_seen(simulation, q, h) : f(simulation);
}
template <auto f>
inline constexpr Computation at_instant = {observe_instant<f>, value_at_instant<f>};

}  // namespace silt::coupler
