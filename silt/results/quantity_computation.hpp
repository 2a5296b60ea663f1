#pragma once
// Defines quantities: rows of families (body_, flow_, heat_, motion_, wall_quantities) with type and
// computation. Computations are collective and give the same on every rank and any number of ranks, in
// lattice units; NaN stands for a value that does not exist (no such body, no step yet).
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <string_view>

#include "rigid/math/exact_sum.hpp"
#include "silt/case/quantity_spec.hpp"
#include "silt/simulation.hpp"

namespace silt {

/// The accumulated numbers of a quantity of the whole run; of several ranks the maximum counts.
using QuantityHistory = std::array<double, 3>;
inline constexpr double not_yet = -std::numeric_limits<double>::infinity();
inline constexpr QuantityHistory no_history{not_yet, not_yet, not_yet};
inline constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// Sums over ranks that a quantity needs per step. Many steps are summed together, so that no rank waits.
struct StepSums {
  int count = 0;  // 0: none
  /// Adds this rank's terms after a step.
  void (*add)(const Simulation&, const QuantitySpec&, std::span<rigid::ExactSum>) = nullptr;
  /// Returns whether the step counts, equally on every rank; null: every step does.
  bool (*counts)(const Simulation&, const QuantitySpec&, const QuantityHistory&) = nullptr;
};

/// The value of a quantity in a step, from sums and maxima over ranks: for series and for the report.
struct StepValue {
  /// Computes the value from the sums, followed by the maxima.
  double (*of)(const Case&, const QuantitySpec&, std::int64_t step, std::span<const double>) = nullptr;
  bool of_all_axes = false;  // terms do not depend on the spec's axis
  int largest = 0;
  void (*see)(const Simulation&, const QuantitySpec&, std::span<double> largest) = nullptr;
};

/// The computation of a type of quantity.
struct Computation {
  void (*observe)(const Simulation&, const QuantitySpec&, QuantityHistory&);  // after every step; or null
  double (*value)(const Simulation&, const QuantitySpec&, const QuantityHistory&);
  StepSums sums = {};
  /// Adds the sums of one step after another to the history, on every rank; null: only series need sums.
  void (*fold)(const Case&, const QuantitySpec&, std::int64_t step, std::span<const double>,
               QuantityHistory&) = nullptr;
  /// Returns the value in the last step of a mean over steps; null for others.
  double (*in_last_step)(const QuantityHistory&) = nullptr;
  StepValue in_step = {};  // for types with a value in every step
  bool of_start = false;   // the history is that of the start, and can be recomputed
  std::string_view type = "";

  /// Returns whether the value is accumulated step by step.
  bool gathers() const { return (observe || fold) && !of_start; }
};

/// A row of a family.
struct Quantity {
  QuantityType type;
  Computation computation;

  constexpr Quantity(std::string_view name, Dimension dimension, unsigned keys, unsigned needs,
                     const Computation& by, std::string_view meaning, std::string_view unit = "")
      : type{name, dimension, keys, needs, meaning, unit}, computation(by) {
    computation.type = name;
  }
};

extern const std::span<const Quantity> body_quantities, flow_quantities, heat_quantities, motion_quantities,
    wall_quantities;

/// Returns the computation of a type. Throws std::logic_error if there is none.
const Computation& computation_of(std::string_view type);

/// Returns the value in the last step; NaN if the step does not count. Collective; ranks wait.
double value_in_last_step(const Simulation&, const QuantitySpec&);

/// Calls visit(row) for the owned bodies that a quantity selects.
template <class Visit>
void for_bodies_of(const rigid::BodySet& bodies, const QuantitySpec& q, Visit&& visit) {
  for (std::size_t row = 0; row < bodies.owned; ++row)
    if (q.is_about(bodies.kind[row])) visit(row);
}

/// Adds the numbers terms(simulation, spec, row) of each owned body that a quantity selects.
template <auto terms>
void add_over_bodies(const Simulation& simulation, const QuantitySpec& q, std::span<rigid::ExactSum> sums) {
  for_bodies_of(simulation.bodies(), q, [&](std::size_t row) {
    const auto x = terms(simulation, q, row);
    for (int k = 0; k < int(x.size()); ++k) sums[k].add(x[k]);
  });
}

/// Returns the mean of value(row) over the bodies that a quantity selects.
double mean_over_bodies(const Simulation&, const QuantitySpec&,
                        const std::function<double(std::size_t)>& value);

/// Returns the share of the quantity's box inside bodies: exact for convex bodies wholly inside, else along
/// lines through the box, or by points for shapes without convex parts.
double packing_fraction(const Simulation&, const QuantitySpec&);

// ---- common forms ----

/// A function of the state at the end: f(simulation, spec) or f(simulation).
template <auto f>
constexpr Computation at_end() {
  return {nullptr, [](const Simulation& simulation, const QuantitySpec& q, const QuantityHistory&) {
            if constexpr (requires { f(simulation, q); })
              return f(simulation, q);
            else
              return f(simulation);
          }};
}

/// Returns the first number of the history.
inline double value_seen(const Simulation&, const QuantitySpec&, const QuantityHistory& h) {
  return h[0] == not_yet ? no_value : h[0];
}

/// Returns the value of a step: f(case, spec, step, sums) or f(case, spec, sums).
template <auto f>
double of_step(const Case& setup, const QuantitySpec& q, std::int64_t step, std::span<const double> sums) {
  if constexpr (requires { f(setup, q, step, sums); })
    return f(setup, q, step, sums);
  else
    return f(setup, q, sums);
}

/// Returns whether forces have acted, i.e. after the first step.
inline bool has_acted(const Simulation& simulation, const QuantitySpec&, const QuantityHistory&) {
  return simulation.steps_done() > 0;
}

/// A value of the last step, or of the present state, at the end.
constexpr Computation in_step(const StepSums& sums, const StepValue& value) {
  return {nullptr,
          [](const Simulation& simulation, const QuantitySpec& q, const QuantityHistory&) {
            return value_in_last_step(simulation, q);
          },
          sums,
          nullptr,
          nullptr,
          value};
}

/// Mean over the steps from the spec's time on. History: sum, number, and the value in the last step.
template <auto f>
void fold_into_mean(const Case& setup, const QuantitySpec& q, std::int64_t step, std::span<const double> sums,
                    QuantityHistory& h) {
  h[2] = of_step<f>(setup, q, step, sums);
  if (double(step) < q.time) return;
  if (h[0] == not_yet) h[0] = h[1] = 0;
  h[0] += h[2];
  h[1] += 1;
}
template <auto f>
constexpr Computation mean_of(const StepSums& sums) {
  return {nullptr,
          [](const Simulation&, const QuantitySpec&, const QuantityHistory& h) {
            return h[0] == not_yet ? no_value : h[0] / h[1];
          },
          sums,
          fold_into_mean<f>,
          [](const QuantityHistory& h) { return h[2] == not_yet ? no_value : h[2]; },
          {of_step<f>}};
}

/// f(simulation) at the step nearest to the spec's time, or at the end without a time.
template <auto f>
constexpr Computation at_instant() {
  return {[](const Simulation& simulation, const QuantitySpec& q, QuantityHistory& h) {
            const auto step = double(simulation.steps_done());
            if (step >= q.time - 0.5 && step < q.time + 0.5) h[0] = f(simulation);
          },
          [](const Simulation& simulation, const QuantitySpec& q, const QuantityHistory& h) {
            return std::isfinite(q.time) ? value_seen(simulation, q, h) : f(simulation);
          }};
}

}  // namespace silt
