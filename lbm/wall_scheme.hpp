#pragma once
// What a cut link returns: one formula for every scheme that is linear in the populations of the link,
//   f_opp(x, t+1) = a f*_i(x) + b f*_i(x - c_i) + c f*_opp(x) - k c_i.u_w,
// its coefficients functions of the wall distance q alone (x the fluid cell, the surface at x + q c_i, u_w
// its velocity there, * after collision). a + b + c = 1: fluid at rest stays at rest at any pressure.
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
/// Bounce-back less a little of the odd part: under bounce-back a cell shut in on all sides keeps its
/// momentum for ever, turning it round in every step.
enum class WallScheme : std::uint8_t { bounce_back, cli, bouzidi, narrow };
inline constexpr std::array<std::string_view, 3> wall_scheme_names = {"bounce-back", "cli", "bouzidi"};

template <class T>
struct LinkCoefficients {
  T a, b, c, k;
};

/// Share of the momentum that a shut-in cell loses in a step; the wall seems 0.5 % further than half-way.
inline constexpr double narrow_damping = 0.02;

/// `weight6`: 6 w_i. Cheap enough for the inner loop: one division, no branch.
template <WallScheme scheme, class T>
constexpr LinkCoefficients<T> coefficients(T q, T weight6) {
  if constexpr (scheme == WallScheme::cli) {
    const T s = T(1) / (T(1) + T(2) * q), kappa = (T(1) - T(2) * q) * s;
    return {T(1), kappa, -kappa, T(2) * weight6 * s};
  } else if constexpr (scheme == WallScheme::bouzidi) {
    const T near = T(2) * q, s = T(1) / (near < T(1) ? T(1) : near);  // q < 1/2: s = 1
    return {near < T(1) ? near : s, near < T(1) ? T(1) - near : T(0), T(1) - s, weight6 * s};
  } else if constexpr (scheme == WallScheme::narrow) {
    constexpr T lost = T(narrow_damping / 2);
    return {T(1) - lost, T(0), lost, (T(1) - lost) * weight6};
  } else {
    return {T(1), T(0), T(0), weight6};
  }
}

/// Whether the formula reads f*_opp(x), and f*_i(x - c_i), at all; and whether the latter for this q.
constexpr bool reads_against(WallScheme scheme) {
  return scheme != WallScheme::bounce_back;
}
constexpr bool reads_behind(WallScheme scheme) {
  return scheme == WallScheme::cli || scheme == WallScheme::bouzidi;
}
constexpr bool reads_behind(WallScheme scheme, double q) {
  return scheme == WallScheme::cli || (scheme == WallScheme::bouzidi && q < 0.5);
}

}  // namespace silt::lbm
