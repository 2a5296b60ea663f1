#pragma once
// The population that a cut link returns (method.md, equation 9). One formula serves all schemes,
//     f_opp(x, t+1) = a f*_i(x) + b f*_i(x - c_i) + c f*_opp(x) + d f*_opp(x - c_i) + g f*_i(x - 2 c_i)
//                     - k c_i.u_w + e c_i.F,
// with coefficients that depend on the wall distance q and the collision rates. x is the fluid cell, x + q
// c_i the wall, u_w the velocity there, F the acceleration of the fluid; * means after collision. V is a
// number of type T or a vector of them.
#include <type_traits>
#include <utility>

#include "cpu/device_code.hpp"
#include "lbm/collision/collision_model.hpp"
#include "lbm/walls/wall_scheme.hpp"

namespace silt::lbm {

/// Calls f with the scheme as an integral_constant.
template <class F>
SILT_DEVICE void with_scheme(WallScheme scheme, F&& f) {
  using enum WallScheme;
  switch (scheme) {
    case cli:
      return f(std::integral_constant<WallScheme, cli>{});
    case parabolic:
      return f(std::integral_constant<WallScheme, parabolic>{});
    case multireflection:
      return f(std::integral_constant<WallScheme, multireflection>{});
    case single_cell_gap:
      return f(std::integral_constant<WallScheme, single_cell_gap>{});
    case bounce_back:
      return f(std::integral_constant<WallScheme, bounce_back>{});
  }
}

/// The properties of the fluid that schemes use: magic, 1 / (tau - 1/2), the stable shares of
/// `multireflection` and of other curvature terms, the share of `parabolic` in the remainder of
/// `multireflection`, and the acceleration.
template <class T>
struct WallFluid {
  T magic = T(1.0 / 6), inverse_rate = T(2), share = T(1), curved = T(1), parabolic = T(0);
  T force[3] = {};
  WallFluid() = default;
  explicit WallFluid(const CollisionSpec& s)
      : magic(T(s.magic_in_effect())),
        inverse_rate(T(1 / (s.relaxation_time - 0.5))),
        share(T(stable_share(s))),
        curved(T(curved_share(s))),
        parabolic(T(parabolic_share(s))),
        force{T(s.force[0]), T(s.force[1]), T(s.force[2])} {}
  SILT_DEVICE bool has_force() const { return force[0] != 0 || force[1] != 0 || force[2] != 0; }
};

/// The coefficients; e follows from the others (equation 11). Only schemes that read beyond use d and g.
template <class V>
struct LinkCoefficients {
  V a, b, c, k, d{}, g{};
};

/// T / q^2 of `parabolic` (equation 14).
inline constexpr double parabola = 0.625;
/// The least T - magic of interpolated schemes, divided by 1/2 + q (equation 14).
inline constexpr double least_excess = 0.0005;
/// The least distance of `single_cell_gap`: with 1/2 (bounce-back) a cell enclosed on all sides would keep
/// its momentum for ever; with this it loses 2 % per step.
inline constexpr double least_gap_distance = 1 / 1.98;

/// Returns the coefficients of the scheme with T = magic + excess (equation 12) that reads on both sides of
/// the cell (equation 13).
template <class V, class T>
constexpr LinkCoefficients<V> central(V q, V excess, V weight6, const WallFluid<T>& fluid) {
  const V g = excess * fluid.inverse_rate, s = T(1) / (T(0.5) + q + g);
  return {(q + T(0.5) - g) * s, T(1) - T(2) * q * s, (q - T(0.5) + g) * s, weight6 * s};
}

/// Returns T - magic of `parabolic` with a share of its excess over magic (equation 14); 0: of `cli`.
template <class V, class T>
constexpr V parabolic_excess(V q, T share, const WallFluid<T>& fluid) {
  const V least = T(least_excess) * (T(0.5) + q), wanted = share * (T(parabola) * q * q - fluid.magic);
  return wanted > least ? wanted : least;
}

/// Returns coefficients that are exact for a parabola along the link, in the share that is stable; the
/// remainder is `cli` or `parabolic` (equations 19 to 20b).
template <class V, class T>
constexpr LinkCoefficients<V> multireflection(V q, V weight6, const WallFluid<T>& fluid) {
  const T share = fluid.share, rest = T(1) - share, odd = T(2) * fluid.magic * fluid.inverse_rate;
  const V m = share / ((T(1) + q) * (T(1) + q)), first = m * (T(1) - T(2) * q - T(2) * q * q),
          second = m * q * q, further = m * odd;
  const V k = T(2) * m * weight6, away = -second - further, toward = second - further;
  if (!(rest > T(0)))  // the same for all links
    return {V{} + share, first + further, further - first, k, away, toward};
  const LinkCoefficients<V> linear = central(q, parabolic_excess(q, fluid.parabolic, fluid), weight6, fluid);
  return {share + rest * linear.a,
          rest * linear.b + first + further,
          rest * linear.c - first + further,
          rest * linear.k + k,
          away,
          toward};
}

/// The wall that the opposite of a link hits: its distance (0: unknown) and its c_i.u.
template <class V>
struct OppositeWall {
  V q{}, u{};
};

/// Returns the distance that `single_cell_gap` uses: the wall is at least about half a link away.
template <class T, class V>
constexpr V gap_distance(V q) {
  return q < T(least_gap_distance) ? V{} + T(least_gap_distance) : q;
}

/// Returns the velocity half-way less its linear interpolation, for a cell between two walls (equation 16).
/// `u` and `u_w` are the velocities of the cell and of the link's wall along c_i.
template <class V, class T>
constexpr V gap_curvature(V q, V u, V u_w, const OppositeWall<V>& opposite, const WallFluid<T>& fluid) {
  const V none{}, h = gap_distance<T>(q), p = gap_distance<T>(opposite.q);
  const V share = fluid.curved * (h * T(0.25) - T(2.0 / 3) * fluid.magic);
  const V second = T(2) * ((u_w - u) / h + (opposite.u - u) / p) / (h + p);
  return opposite.q > none ? (share > none ? -share * second : none) : none;
}

/// Returns the coefficients of a scheme; `weight6` is 6 w_i. Takes one division and no branch.
template <WallScheme scheme, class V, class T>
constexpr LinkCoefficients<V> coefficients(V q, V weight6, const WallFluid<T>& fluid) {
  const V none{}, one = none + T(1);
  if constexpr (scheme == WallScheme::cli) {
    return central(q, V(T(least_excess) * (T(0.5) + q)), weight6, fluid);
  } else if constexpr (scheme == WallScheme::parabolic) {
    return central(q, parabolic_excess(q, fluid.curved, fluid), weight6, fluid);
  } else if constexpr (scheme == WallScheme::multireflection) {
    return multireflection(q, weight6, fluid);
  } else if constexpr (scheme == WallScheme::single_cell_gap) {
    return {one, none, none, weight6 * T(0.5) / gap_distance<T>(q)};
  } else {
    static_assert(scheme == WallScheme::bounce_back);
    return {one, none, none, weight6};
  }
}

/// Returns whether every scheme has nonzero coefficients only for populations that it reads.
constexpr bool schemes_read_what_they_use() {
  const auto reads = [](auto scheme, double q) {
    const LinkCoefficients<double> s = coefficients<scheme()>(q, 1.0, WallFluid<double>());
    return (reads_behind(scheme()) || (s.b == 0 && s.c == 0)) &&
           (reads_beyond(scheme()) || (s.d == 0 && s.g == 0));
  };
  return [&]<int... scheme>(std::integer_sequence<int, scheme...>) {
    return (reads(std::integral_constant<WallScheme, WallScheme(scheme)>(), 0.3) && ...);
  }
  (std::make_integer_sequence<int, int(WallScheme::single_cell_gap) + 1>());
}
static_assert(schemes_read_what_they_use(), "reads_behind() or reads_beyond() lacks a scheme");

}  // namespace silt::lbm
