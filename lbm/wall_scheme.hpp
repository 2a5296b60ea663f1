#pragma once
// What a cut link returns: one formula for every scheme that is linear in the populations of the link,
//   f_opp(x, t+1) = a f*_i(x) + b f*_i(x - c_i) + c f*_opp(x) - k c_i.u_w + e c_i.F,
// its coefficients functions of the wall distance q and the rates of the collision (x the fluid cell, the
// surface at x + q c_i, u_w its velocity there, F the acceleration of the fluid, * after collision).
// a + b + c = 1: fluid at rest stays at rest at any pressure; e = (k - 6 w_i (a - c)) / 2: also where a
// pressure gradient balances F. `single_cell_gap` has b = c = e = 0 and a term in the cell's velocity u,
// - (6 w_i - k) c_i.u, and may have one in its second difference (gap_curvature).
//
// In steady flow such a scheme holds, with d = c_i.grad and u along c_i, the velocity at
//   u + q d u + T (d^2 u - (grad p - F).c_i / (tau - 1/2)) = u_w,
// T its own. (The bracket is what relaxes of the odd half of the pair; 1 + k, b and a - c give the terms.)
// Plain linear schemes of two relaxation times have T = magic at every q, where the parabola wants a T that
// grows as q^2: this is why the drag of a body depends on where it lies in the grid. Below T = magic any such
// scheme is unstable (tried at relaxation times 0.505 to 3), above it none is; at T = magic nothing takes
// away momentum that turns round in every step, u ~ (-1)^(x + t), and next to a cell that lies on a surface
// (q = 0) it grows.
//
// A new scheme: a name, and its line in coefficients().
#include <array>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "lbm/collision_model.hpp"

namespace silt::lbm {

/// `bounce_back`: equation 5 of Goetz et al. (SC10) with rho_w = 1; the surface is taken to be half-way.
/// `cli`: Ginzburg, Verhaeghe, d'Humieres 2008, central linear interpolation; T is least_excess above magic.
/// `bouzidi`: Bouzidi, Firdaouss, Lallemand 2001, linear, upwind.
/// `parabolic`: T = 5/8 q^2 where that is above the T of `cli`, else that. Taylor's series would have q^2 / 2
/// of d^2 u, but part of that is taken up by the pressure: 3/4 q^2 is exact for Poiseuille flow along the
/// grid, 5/8 q^2 leaves the least of the drag of spheres. Of the multi-reflection kind (Ginzburg, d'Humieres
/// 2003), with the odd half that relaxes taken from the three populations of a linear scheme: [f*_i(x - c_i)
/// - f_opp(x, t+1)] - [f*_i(x) - f*_opp(x)], halved. `single_cell_gap`: of the cell alone, for links of the
/// others where x - c_i is not fluid; no choice of a case. Bounce-back half-way at the velocity there,
/// interpolated between the surface's and the cell's own u(x), and under `parabolic` the surface's on the
/// other side; a surface nearer than half-way is taken to be there.
enum class WallScheme : std::uint8_t { bounce_back, cli, bouzidi, parabolic, single_cell_gap };
inline constexpr std::array<std::string_view, 4> wall_scheme_names = {"bounce-back", "cli", "bouzidi",
                                                                      "parabolic"};

/// Calls f with the scheme as a constant of the type.
template <class F>
void with_scheme(WallScheme scheme, F&& f) {
  using enum WallScheme;
  switch (scheme) {
    case cli:
      return f(std::integral_constant<WallScheme, cli>{});
    case bouzidi:
      return f(std::integral_constant<WallScheme, bouzidi>{});
    case parabolic:
      return f(std::integral_constant<WallScheme, parabolic>{});
    case single_cell_gap:
      return f(std::integral_constant<WallScheme, single_cell_gap>{});
    case bounce_back:
      return f(std::integral_constant<WallScheme, bounce_back>{});
  }
}

/// T / q^2 of `parabolic`.
inline constexpr double parabola = 0.625;

/// The magic at which the drag of spheres comes out best, see README.md.
constexpr double best_magic(WallScheme scheme) {
  return scheme == WallScheme::parabolic ? 1.0 / 16 : 1.0 / 6;
}

/// What a scheme knows of the collision: magic, 1 / (tau - 1/2), and the acceleration of the fluid.
template <class T>
struct WallFluid {
  T magic = T(1.0 / 6), inverse_rate = T(2);
  T force[3] = {};
  WallFluid() = default;
  explicit WallFluid(const CollisionSpec& s)
      : magic(T(s.magic_in_effect())),
        inverse_rate(T(1 / (s.relaxation_time - 0.5))),
        force{T(s.force[0]), T(s.force[1]), T(s.force[2])} {}
};

/// V: a population's type, or a vector of it.
template <class V>
struct LinkCoefficients {
  V a, b, c, k;
};

/// Least T - magic of interpolated schemes, over 1/2 + q.
inline constexpr double least_excess = 0.0005;
/// Least distance of `single_cell_gap`: under bounce-back (1/2) a cell shut in on all sides keeps its
/// momentum for ever; so it loses 2 % a step.
inline constexpr double least_gap_distance = 1 / 1.98;

/// Of the scheme that holds the velocity at T = magic + excess, on both sides of the cell.
template <class V, class T>
constexpr LinkCoefficients<V> central(V q, V excess, V weight6, const WallFluid<T>& fluid) {
  const V g = excess * fluid.inverse_rate, s = T(1) / (T(0.5) + q + g);
  return {(q + T(0.5) - g) * s, T(1) - T(2) * q * s, (q - T(0.5) + g) * s, weight6 * s};
}

/// The surface that a link's opposite hits, when that is cut too: how far it is (0: not known) and c_i.u
/// there.
template <class V>
struct OppositeWall {
  V q{}, u{};
};

/// q of `single_cell_gap`. V: T or a vector of it.
template <class T, class V>
constexpr V gap_distance(V q) {
  return q < T(least_gap_distance) ? V{} + T(least_gap_distance) : q;
}

/// What the velocity half-way has beyond interpolation, - q/4 d^2 u, for a cell between two walls: of its
/// velocity `u` and theirs (all along c_i) the parabola is known. The links' own T = 2 q magic, of the
/// bracket above, has part of it: two thirds of d^2 u remain there, as in flow along a gap, which comes out
/// exactly, at any viscosity, for q of 8/3 magic and more.
template <class V, class T>
constexpr V gap_curvature(V q, V u, V u_w, const OppositeWall<V>& far, const WallFluid<T>& fluid) {
  const V none{}, h = gap_distance<T>(q), p = gap_distance<T>(far.q);
  const V share = h * T(0.25) - T(2.0 / 3) * fluid.magic;
  const V second = T(2) * ((u_w - u) / h + (far.u - u) / p) / (h + p);
  return far.q > none ? (share > none ? -share * second : none) : none;
}

/// `weight6`: 6 w_i. Cheap enough for the inner loop: one division, no branch.
template <WallScheme scheme, class V, class T>
constexpr LinkCoefficients<V> coefficients(V q, V weight6, const WallFluid<T>& fluid) {
  const V none{}, one = none + T(1), least = T(least_excess) * (T(0.5) + q);
  if constexpr (scheme == WallScheme::cli) {
    return central(q, least, weight6, fluid);
  } else if constexpr (scheme == WallScheme::parabolic) {
    const V wanted = T(parabola) * q * q - fluid.magic;
    return central(q, V(wanted > least ? wanted : least), weight6, fluid);
  } else if constexpr (scheme == WallScheme::bouzidi) {
    const V near = T(2) * q, s = T(1) / (near < T(1) ? one : near);  // q < 1/2: s = 1
    return {near < T(1) ? near : s, near < T(1) ? T(1) - near : none, T(1) - s, weight6 * s};
  } else if constexpr (scheme == WallScheme::single_cell_gap) {
    return {one, none, none, weight6 * T(0.5) / gap_distance<T>(q)};
  } else {
    return {one, none, none, weight6};
  }
}

/// Whether the formula reads f*_opp(x) and f*_i(x - c_i) at all; and whether the latter for this q.
constexpr bool reads_behind(WallScheme scheme) {
  return scheme == WallScheme::cli || scheme == WallScheme::bouzidi || scheme == WallScheme::parabolic;
}
constexpr bool reads_behind(WallScheme scheme, double q) {
  return scheme == WallScheme::bouzidi ? q < 0.5 : reads_behind(scheme);
}

}  // namespace silt::lbm
