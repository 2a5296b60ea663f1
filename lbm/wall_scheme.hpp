#pragma once
// What a cut link returns: one formula for every scheme that is linear in the populations of the link,
//   f_opp(x, t+1) = a f*_i(x) + b f*_i(x - c_i) + c f*_opp(x) - k c_i.u_w,
// its coefficients functions of the wall distance q alone (x the fluid cell, the surface at x + q c_i, u_w
// its velocity there, * after collision). a + b + c = 1: fluid at rest stays at rest at any pressure.
// `narrow` has a = 1, b = c = 0 and a further term, - (6 w_i - k) c_i.u(x).
//
// A new scheme: a name, and its line in coefficients().
#include <array>
#include <cstdint>
#include <string_view>

namespace silt::lbm {

/// `bounce_back`: equation 5 of Goetz et al. (SC10) with rho_w = 1; the surface is taken to be half-way.
/// `cli`: Ginzburg, Verhaeghe, d'Humieres 2008, central linear interpolation.
/// `bouzidi`: Bouzidi, Firdaouss, Lallemand 2001, linear, upwind.
/// `narrow`: of the cell alone, for links of the others where x - c_i is not fluid; no choice of a case.
/// Bounce-back half-way at the velocity there, interpolated between the surface's and the cell's own u(x);
/// a surface nearer than that is taken to be half-way.
enum class WallScheme : std::uint8_t { bounce_back, cli, bouzidi, narrow };
inline constexpr std::array<std::string_view, 3> wall_scheme_names = {"bounce-back", "cli", "bouzidi"};

template <class T>
struct LinkCoefficients {
  T a, b, c, k;
};

/// b + c of cli, which is 0 in the source. All formulas with 2 q (1 - c) = 1 - b are exact where the velocity
/// is linear. Of momentum that turns round in every step, u ~ (-1)^(x + t), they return 1 - 2 (b + c): with 0
/// nothing ever takes it away, and next to a cell that lies on a surface (q = 0, c = -1) it grows. The price
/// of b + c > 0 is an error of the curvature: the magic parameter seems larger by (tau - 1/2) (b + c) (1 + 2
/// q) / 4. With this choice that is 0.00025 (1 + 2 q), or less, at any viscosity.
inline constexpr double damping_of(double relaxation_time) {
  constexpr double cost = 0.001;
  return cost / (relaxation_time - 0.5 + cost);
}

/// Least distance of `narrow`: under bounce-back (1/2) a cell shut in on all sides keeps its momentum for
/// ever; so it loses 2 % a step.
inline constexpr double least_narrow = 1 / 1.98;

/// `weight6`: 6 w_i; `damping`: damping_of. Cheap enough for the inner loop: one division, no branch.
template <WallScheme scheme, class T>
constexpr LinkCoefficients<T> coefficients(T q, T weight6, T damping) {
  if constexpr (scheme == WallScheme::cli) {
    const T s = T(1) / (T(1) + T(2) * q), near = T(2) * q, undamped = T(1) - damping;
    return {undamped, (T(1) - near * undamped) * s, (near - undamped) * s, (T(2) - damping) * weight6 * s};
  } else if constexpr (scheme == WallScheme::bouzidi) {
    const T near = T(2) * q, s = T(1) / (near < T(1) ? T(1) : near);  // q < 1/2: s = 1
    return {near < T(1) ? near : s, near < T(1) ? T(1) - near : T(0), T(1) - s, weight6 * s};
  } else if constexpr (scheme == WallScheme::narrow) {
    return {T(1), T(0), T(0), weight6 * T(0.5) / (q < T(least_narrow) ? T(least_narrow) : q)};
  } else {
    return {T(1), T(0), T(0), weight6};
  }
}

/// Whether the formula reads f*_opp(x) and f*_i(x - c_i) at all; and whether the latter for this q.
constexpr bool reads_behind(WallScheme scheme) {
  return scheme == WallScheme::cli || scheme == WallScheme::bouzidi;
}
constexpr bool reads_behind(WallScheme scheme, double q) {
  return scheme == WallScheme::cli || (scheme == WallScheme::bouzidi && q < 0.5);
}

}  // namespace silt::lbm
