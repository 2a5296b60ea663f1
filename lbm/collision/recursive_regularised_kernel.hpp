#pragma once
// The model `regularised` for a vector of cells (method.md, equations 24 to 28). Only for *_kernel.cpp files,
// which are built once per instruction set (SILT_BUILD).
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "cpu/lanes.hpp"
#include "lbm/collision/cell_velocity.hpp"

namespace silt::lbm::SILT_BUILD {

template <class V>
[[gnu::always_inline]] SILT_DEVICE inline V root(const V& x) {
  if constexpr (std::is_floating_point_v<V>) {
    return std::sqrt(x);
  } else {
    V y;
    for (std::size_t i = 0; i < sizeof(V) / sizeof(x[0]); ++i) y[i] = std::sqrt(x[i]);
    return y;
  }
}

/// ghosts: third and fourth moments keep a part of their own; otherwise they follow from the stress.
template <bool ghosts>
struct RecursiveRegularised {
  /// Collides with the arguments of TwoRelaxationTimes::collide. Rounding errors enter the populations with
  /// both signs, so that mass and momentum are conserved as sums.
  template <bool source, class V, class Rates, class SetRest, class SetPair, class See>
  [[gnu::always_inline]] SILT_DEVICE static void collide(const V (&sum)[D3Q19::pairs + 1],
                                                         const V (&difference)[D3Q19::pairs], const Rates& r,
                                                         SetRest&& set_rest, SetPair&& set_pair, See&& see) {
    using T = typename Rates::Number;
    const V *const s = sum, *const d = difference;
    const V in_xy = s[3] + s[4], in_xz = s[5] + s[6], in_yz = s[7] + s[8];
    V rho = ((s[0] + s[1]) + (s[2] + sum[D3Q19::pairs])) + (in_xy + (in_xz + in_yz));
    V ux, uy, uz;
    set_velocity<source>(difference, r, ux, uy, uz);

    // second moments of the traceless stress, less those of the equilibrium
    const V mxx = s[0] + (in_xy + in_xz), myy = s[1] + (in_xy + in_yz), mzz = s[2] + (in_xz + in_yz);
    const V mean = T(1. / 3) * (mxx + (myy + mzz));
    const V sxx = ux * ux, syy = uy * uy, szz = uz * uz;
    V trace = sxx + (syy + szz);
    see(trace);
    const V third = T(1. / 3) * trace, density = rho;
    const V nxx = (mxx - mean) - (sxx - third), nyy = (myy - mean) - (syy - third);
    const V nxy = (s[3] - s[4]) - ux * uy, nxz = (s[5] - s[6]) - ux * uz, nyz = (s[7] - s[8]) - uy * uz;

    // a quarter of the kept part of fourth moments beyond the stress
    V gxy{}, gxz{}, gyz{};
    if constexpr (ghosts) {
      const T quarter = T(0.25) * r.keep_fourth;
      const V offset = T(1. / 18) * rho - mean;
      gxy = quarter * (in_xy + (T(0.5) * mzz + offset));
      gxz = quarter * (in_xz + (T(0.5) * myy + offset));
      gyz = quarter * (in_yz + (T(0.5) * mxx + offset));
    }

    // second moments of the whole stress after the collision
    const V keep = share_kept(r, nxx, nyy, nxy, nxz, nyz);
    V axx = sxx + keep * nxx, ayy = syy + keep * nyy;
    V axy = ux * uy + keep * nxy, axz = ux * uz + keep * nxz, ayz = uy * uz + keep * nyz;
    V px = ux, py = uy, pz = uz;  // momentum after the collision
    if constexpr (source) {
      const auto* const h = r.half_force;
      const V share = T(1) + keep, power = h[0] * ux + (h[1] * uy + h[2] * uz);
      const V mean_power = T(2. / 3) * (power - share * power);
      axx += share * (T(2) * h[0] * ux) + mean_power;
      ayy += share * (T(2) * h[1] * uy) + mean_power;
      trace += T(2) * power;
      axy += share * (h[0] * uy + h[1] * ux);
      axz += share * (h[0] * uz + h[2] * ux);
      ayz += share * (h[1] * uz + h[2] * uy);
      px += h[0];
      py += h[1];
      pz += h[2];
    }
    const V azz = trace - (axx + ayy);

    // a quarter of each third moment: the part that follows from the stress, then the kept part of the rest
    const T kept = ghosts ? r.keep_third : T(0), lost = T(1) - kept;
    const V shift = keep - kept;
    const V exx = T(0.25) * (shift * nxx - lost * sxx), eyy = T(0.25) * (shift * nyy - lost * syy),
            ezz = T(-0.25) * (shift * (nxx + nyy) + lost * szz);
    const V oxy = T(0.5) * (shift * nxy + lost * (ux * uy)), oxz = T(0.5) * (shift * nxz + lost * (ux * uz)),
            oyz = T(0.5) * (shift * nyz + lost * (uy * uz));
    V wx = lost * ux, wy = lost * uy, wz = lost * uz;
    if constexpr (source) {
      wx += (T(1) + kept) * r.half_force[0];
      wy += (T(1) + kept) * r.half_force[1];
      wz += (T(1) + kept) * r.half_force[2];
    }
    const V vx = T(1. / 12) * wx, vy = T(1. / 12) * wy, vz = T(1. / 12) * wz;
    V xyy = vx + (ux * eyy + uy * oxy), xzz = vx + (ux * ezz + uz * oxz);
    V yxx = vy + (uy * exx + ux * oxy), yzz = vy + (uy * ezz + uz * oyz);
    V zxx = vz + (uz * exx + ux * oxz), zyy = vz + (uz * eyy + uy * oyz);
    if constexpr (ghosts) {
      const T quarter = T(0.25) * kept;
      const V spread = (mean - T(1. / 3) * density) - third;  // a third of the trace off equilibrium
      xyy += quarter * ((d[3] + d[4]) - spread * ux);
      xzz += quarter * ((d[5] + d[6]) - spread * ux);
      yxx += quarter * ((d[3] - d[4]) - spread * uy);
      yzz += quarter * ((d[7] + d[8]) - spread * uy);
      zxx += quarter * ((d[5] - d[6]) - spread * uz);
      zyy += quarter * ((d[7] - d[8]) - spread * uz);
    }

    // the even halves
    const V part = T(1. / 18) * rho - T(1. / 12) * trace;
    const V base = T(0.5) * part + T(0.125) * trace;
    set_rest(V((rho - (T(12) * part + T(1.5) * trace)) + T(4) * (gxy + (gxz + gyz))));
    set_pair(0, V((part + T(0.25) * axx) - T(2) * (gxy + gxz)), V(T(0.5) * px - T(2) * (xyy + xzz)));
    set_pair(1, V((part + T(0.25) * ayy) - T(2) * (gxy + gyz)), V(T(0.5) * py - T(2) * (yxx + yzz)));
    set_pair(2, V((part + T(0.25) * azz) - T(2) * (gxz + gyz)), V(T(0.5) * pz - T(2) * (zxx + zyy)));
    const V bxy = (base - T(0.125) * azz) + gxy, bxz = (base - T(0.125) * ayy) + gxz,
            byz = (base - T(0.125) * axx) + gyz;
    const V qxy = T(0.25) * axy, qxz = T(0.25) * axz, qyz = T(0.25) * ayz;
    set_pair(3, V(bxy + qxy), V(xyy + yxx));
    set_pair(4, V(bxy - qxy), V(xyy - yxx));
    set_pair(5, V(bxz + qxz), V(xzz + zxx));
    set_pair(6, V(bxz - qxz), V(xzz - zxx));
    set_pair(7, V(byz + qyz), V(yzz + zyy));
    set_pair(8, V(byz - qyz), V(yzz - zyy));
  }
  template <class T>
  SILT_DEVICE static T square_scale(const CollisionRates<T>&) {
    return 1;
  }

 private:
  /// Returns the fraction of stress off equilibrium that the collision keeps: 1 - 1/tau, or less where the
  /// stress is that of an unresolved eddy.
  template <class V, class T>
  [[gnu::always_inline]] SILT_DEVICE static V share_kept(const CollisionRates<T>& r, const V& nxx,
                                                         const V& nyy, const V& nxy, const V& nxz,
                                                         const V& nyz) {
    const V nzz = nxx + nyy;
    const V square = T(0.5) * (nxx * nxx + (nyy * nyy + nzz * nzz)) + (nxy * nxy + (nxz * nxz + nyz * nyz));
    V keep = V{} + r.keep_even_twice;
    const auto eddies = square > V{} + r.resolved_square;
    if (any_lane(eddies)) [[unlikely]] {
      const V tau = T(0.25) + root(V(T(0.0625) + r.eddy * root(square)));
      keep = eddies ? V(T(1) - T(1) / tau) : keep;
    }
    return keep;
  }
};

}  // namespace silt::lbm::SILT_BUILD
