#pragma once
// The models trt and bgk for a vector of cells (method.md, equations 3 to 7). Only for *_kernel.cpp files,
// which are built once per instruction set (SILT_BUILD).
#include "lbm/collision/cell_velocity.hpp"

namespace silt::lbm::SILT_BUILD {

struct TwoRelaxationTimes {
  /// Collides cells, given for each pair the sum and difference of the populations that arrive along and
  /// against its first direction; the last sum is the population at rest. Calls set_rest(population at rest
  /// after the collision), set_pair(k, p, q), where p + q leaves along the first direction of pair k and p -
  /// q against it, and see(squares of the cells' speeds times square_scale).
  template <bool source, class V, class Rates, class SetRest, class SetPair, class See>
  [[gnu::always_inline]] SILT_DEVICE static void collide(const V (&sum)[D3Q19::pairs + 1],
                                                         const V (&difference)[D3Q19::pairs], const Rates& r,
                                                         SetRest&& set_rest, SetPair&& set_pair, See&& see) {
    using T = typename Rates::Number;
    const V rho = ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7])) +
                  (sum[8] + sum[D3Q19::pairs]);
    V ux, uy, uz;
    set_velocity<source>(difference, r, ux, uy, uz);
    V kx = r.square * ux, ky = r.square * uy, kz = r.square * uz;
    if constexpr (source) {
      kx += r.even_force[0];
      ky += r.even_force[1];
      kz += r.even_force[2];
    }
    const V xx = kx * ux, yy = ky * uy, zz = kz * uz;
    const V square = xx + yy + zz;
    see(square);
    V isotropic = r.density * rho - square;
    V qx = r.momentum * ux, qy = r.momentum * uy, qz = r.momentum * uz;
    if constexpr (source) {
      qx += r.odd_force[0];
      qy += r.odd_force[1];
      qz += r.odd_force[2];
    }

    set_rest(V(r.keep_even_twice * sum[D3Q19::pairs] + T(12) * isotropic));
    const auto relax = [&](int k, const V& even, const V& odd) __attribute__((always_inline)) {
      set_pair(k, V(r.keep_even * sum[k] + even), V(r.keep_odd * difference[k] + odd));
    };
    const V x3 = isotropic + T(3) * xx, y3 = T(3) * yy, z3 = T(3) * zz;
    relax(0, x3 + x3, qx + qx);
    const V y1 = isotropic + y3, z1 = isotropic + z3;
    relax(1, y1 + y1, qy + qy);
    relax(2, z1 + z1, qz + qz);
    V xy, xz, yz;
    if constexpr (source) {
      xy = T(3) * (kx * uy + ky * ux);
      xz = T(3) * (kx * uz + kz * ux);
      yz = T(3) * (ky * uz + kz * uy);
    } else {
      const V kx6 = T(6) * kx;
      xy = kx6 * uy;
      xz = kx6 * uz;
      yz = T(6) * ky * uz;
    }
    const V sxy = x3 + y3, sxz = x3 + z3, syz = y1 + z3;
    relax(3, sxy + xy, qx + qy);
    relax(4, sxy - xy, qx - qy);
    relax(5, sxz + xz, qx + qz);
    relax(6, sxz - xz, qx - qz);
    relax(7, syz + yz, qy + qz);
    relax(8, syz - yz, qy - qz);
  }
  /// Returns the factor of the squared speeds that see() receives.
  template <class T>
  SILT_DEVICE static T square_scale(const CollisionRates<T>& r) {
    return r.square;
  }
};

}  // namespace silt::lbm::SILT_BUILD
