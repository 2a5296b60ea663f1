// Built once an instruction set. Links are taken 64 at a time: gather, arithmetic, scatter, sums, each a
// loop that vectorises by itself.
#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>

#include "lbm/kernels.hpp"

namespace silt::lbm::SILT_ISA {
namespace {

inline constexpr int chunk = 64;

/// Adds terms rounded to whole quanta: x / quantum + 3 * 2^51 has the rounded integer in its low mantissa
/// bits.
struct FixedAdder {
  std::int64_t sum = 0;
  std::int64_t bad = 0;
  static constexpr double magic = 0x1.8p52, limit = 0x1p50;

  void add(const double* x, int n, double inverse_quantum) {
    std::int64_t s = 0, out = 0;
    for (int l = 0; l < n; ++l) {
      const double scaled = x[l] * inverse_quantum;
      s += std::bit_cast<std::int64_t>(scaled + magic) - std::bit_cast<std::int64_t>(magic);
      out |= !(std::fabs(scaled) < limit);
    }
    sum += s, bad |= out;
  }
};

template <class T>
struct Geometry {  // of a run's direction
  T c[3];
  T weight6;
  explicit Geometry(int i) : c{T(lbm::c[i].x), T(lbm::c[i].y), T(lbm::c[i].z)}, weight6(T(6 * w(i))) {}
};

/// k and the lever arm r x c of the links [l0, l0 + n).
template <WallScheme scheme, class T>
struct Levers {
  T k[chunk], ax[chunk], ay[chunk], az[chunk];
  Levers(const CutLinks<T>& links, std::uint32_t l0, int n, const Geometry<T>& g) {
    for (int l = 0; l < n; ++l) {
      const T x = links.rx[l0 + l], y = links.ry[l0 + l], z = links.rz[l0 + l];
      k[l] = coefficients<scheme>(links.q[l0 + l], g.weight6).k;
      ax[l] = y * g.c[2] - z * g.c[1], ay[l] = z * g.c[0] - x * g.c[2], az[l] = x * g.c[1] - y * g.c[0];
    }
  }
};

template <class T>
struct Motion {
  T v[3], o[3];
  explicit Motion(const SurfaceMotion& m) {
    for (int d = 0; d < 3; ++d) v[d] = T(m.v[d]), o[d] = T(m.omega[d]);
  }
};

/// Calls f with the scheme as a constant of the type.
template <class F>
void with_scheme(WallScheme scheme, F&& f) {
  using enum WallScheme;
  switch (scheme) {
    case bounce_back:
      return f(std::integral_constant<WallScheme, bounce_back>{});
    case cli:
      return f(std::integral_constant<WallScheme, cli>{});
    case bouzidi:
      return f(std::integral_constant<WallScheme, bouzidi>{});
    case narrow:
      return f(std::integral_constant<WallScheme, narrow>{});
  }
}

template <WallScheme scheme, class T>
void apply_links(Block<T>& block, Parity parity, const CutLinks<T>& links, const LinkRun& run,
                 const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  const int i = run.direction, j = opposite(i);
  const Geometry<T> g(i);
  const Motion<T> u(motion);
  const T cv = g.c[0] * u.v[0] + g.c[1] * u.v[1] + g.c[2] * u.v[2];
  T* const p = block.data();
  const T* const out = p + block.leaving(i, parity);      // f*_i(x)
  const T* const behind = p + block.arriving(i, parity);  // f*_i(x - c_i)
  const T* const against = p + block.leaving(j, parity);  // f*_opp(x)
  T* const back = p + block.arriving(j, parity);          // f_opp(x, t+1)
  FixedAdder force[3], torque[3], mass;

  for (std::uint32_t l0 = run.begin; l0 < run.end; l0 += chunk) {
    const int n = int(std::min<std::uint32_t>(chunk, run.end - l0));
    const std::int32_t* const cell = links.cell.data() + l0;
    T o[chunk], f[chunk], b[chunk], r[chunk];
    for (int l = 0; l < n; ++l) o[l] = out[cell[l]];
    if constexpr (reads_behind(scheme))
      for (int l = 0; l < n; ++l) f[l] = behind[cell[l]];
    if constexpr (reads_against(scheme))
      for (int l = 0; l < n; ++l) b[l] = against[cell[l]];
    const Levers<scheme, T> lever(links, l0, n, g);
    for (int l = 0; l < n; ++l) {
      const auto s = coefficients<scheme>(links.q[l0 + l], g.weight6);
      const T cu = cv + (lever.ax[l] * u.o[0] + lever.ay[l] * u.o[1] + lever.az[l] * u.o[2]);
      r[l] = s.a * o[l] - s.k * cu;
      if constexpr (reads_behind(scheme))
        r[l] += s.b * f[l] + s.c * b[l];
      else if constexpr (reads_against(scheme))
        r[l] += s.c * b[l];
    }
#pragma GCC ivdep
    for (int l = 0; l < n; ++l) back[cell[l]] = r[l];

    double fx[chunk], fy[chunk], fz[chunk], tx[chunk], ty[chunk], tz[chunk], m[chunk];
    const T galilean = form == ForceForm::galilean ? T(1) : T(0);
    for (int l = 0; l < n; ++l) {
      const T x = links.rx[l0 + l], y = links.ry[l0 + l], z = links.rz[l0 + l];
      const T sum = o[l] + r[l], difference = (o[l] - r[l]) * galilean;
      const double gx = g.c[0] * sum - (u.v[0] + (u.o[1] * z - u.o[2] * y)) * difference;
      const double gy = g.c[1] * sum - (u.v[1] + (u.o[2] * x - u.o[0] * z)) * difference;
      const double gz = g.c[2] * sum - (u.v[2] + (u.o[0] * y - u.o[1] * x)) * difference;
      fx[l] = gx, fy[l] = gy, fz[l] = gz;
      tx[l] = y * gz - z * gy, ty[l] = z * gx - x * gz, tz[l] = x * gy - y * gx;
      m[l] = double(r[l]) - double(o[l]);
    }
    constexpr double scale = 1 / link_quantum;
    force[0].add(fx, n, scale), force[1].add(fy, n, scale), force[2].add(fz, n, scale);
    torque[0].add(tx, n, scale), torque[1].add(ty, n, scale), torque[2].add(tz, n, scale);
    mass.add(m, n, 1 / mass_quantum);
  }
  std::int64_t bad = mass.bad;
  for (int d = 0; d < 3; ++d) {
    sums.force[d] += force[d].sum, sums.torque[d] += torque[d].sum;
    bad |= force[d].bad | torque[d].bad;
  }
  sums.mass += mass.sum;
  if (bad) sums.invalid = true;
}

template <WallScheme scheme, class T>
void correct_links(Block<T>& block, Parity parity, const CutLinks<T>& links, const LinkRun& run,
                   const SurfaceMotion& increment, LinkSums& sums) {
  const Geometry<T> g(run.direction);
  const Motion<T> u(increment);
  const T cv = g.c[0] * u.v[0] + g.c[1] * u.v[1] + g.c[2] * u.v[2];
  T* const back = block.data() + block.arriving(opposite(run.direction), parity);
  FixedAdder mass;
  for (std::uint32_t l0 = run.begin; l0 < run.end; l0 += chunk) {
    const int n = int(std::min<std::uint32_t>(chunk, run.end - l0));
    const std::int32_t* const cell = links.cell.data() + l0;
    const Levers<scheme, T> lever(links, l0, n, g);
    T before[chunk], after[chunk];
    double m[chunk];
    for (int l = 0; l < n; ++l) before[l] = back[cell[l]];
    for (int l = 0; l < n; ++l) {
      const T cu = cv + (lever.ax[l] * u.o[0] + lever.ay[l] * u.o[1] + lever.az[l] * u.o[2]);
      after[l] = before[l] - lever.k[l] * cu;
      m[l] = double(after[l]) - double(before[l]);
    }
#pragma GCC ivdep
    for (int l = 0; l < n; ++l) back[cell[l]] = after[l];
    mass.add(m, n, 1 / mass_quantum);
  }
  sums.mass += mass.sum;
  if (mass.bad) sums.invalid = true;
}

template <WallScheme scheme, class T>
void links_stiffness(const CutLinks<T>& links, const LinkRun& run, StiffnessSums& sums) {
  const Geometry<T> g(run.direction);
  FixedAdder k1, ka[3], kaa[6];
  for (std::uint32_t l0 = run.begin; l0 < run.end; l0 += chunk) {
    const int n = int(std::min<std::uint32_t>(chunk, run.end - l0));
    const Levers<scheme, T> lever(links, l0, n, g);
    double t[10][chunk];
    for (int l = 0; l < n; ++l) {
      const double k = lever.k[l], x = lever.ax[l], y = lever.ay[l], z = lever.az[l];
      t[0][l] = k, t[1][l] = k * x, t[2][l] = k * y, t[3][l] = k * z;
      t[4][l] = k * x * x, t[5][l] = k * x * y, t[6][l] = k * x * z;
      t[7][l] = k * y * y, t[8][l] = k * y * z, t[9][l] = k * z * z;
    }
    constexpr double scale = 1 / stiffness_quantum;
    k1.add(t[0], n, scale);
    for (int d = 0; d < 3; ++d) ka[d].add(t[1 + d], n, scale);
    for (int d = 0; d < 6; ++d) kaa[d].add(t[4 + d], n, scale);
  }
  // J = [c, a]: the blocks c c^T k, c a^T k and a a^T k; c is made of integers, so no further rounding.
  const Int3 v = lbm::c[run.direction];
  int e = 0, aa = 0;
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column, ++e) {
      if (row < 3 && column < 3) sums.h[e] += k1.sum * (v[row] * v[column]);
      if (row < 3 && column >= 3) sums.h[e] += ka[column - 3].sum * v[row];
      if (row >= 3) sums.h[e] += kaa[aa++].sum;
    }
  std::int64_t bad = k1.bad;
  for (const auto& s : ka) bad |= s.bad;
  for (const auto& s : kaa) bad |= s.bad;
  if (bad) sums.invalid = true;
}

}  // namespace

template <class T>
void apply_run(Block<T>& block, Parity parity, const CutLinks<T>& links, const LinkRun& run,
               const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  with_scheme(run.scheme,
              [&](auto scheme) { apply_links<scheme()>(block, parity, links, run, motion, form, sums); });
}

template <class T>
void correct_run(Block<T>& block, Parity parity, const CutLinks<T>& links, const LinkRun& run,
                 const SurfaceMotion& increment, LinkSums& sums) {
  with_scheme(run.scheme,
              [&](auto scheme) { correct_links<scheme()>(block, parity, links, run, increment, sums); });
}

template <class T>
void stiffness_run(const CutLinks<T>& links, const LinkRun& run, StiffnessSums& sums) {
  with_scheme(run.scheme, [&](auto scheme) { links_stiffness<scheme()>(links, run, sums); });
}

#define SILT_INSTANTIATE(T)                                                                              \
  template void apply_run(Block<T>&, Parity, const CutLinks<T>&, const LinkRun&, const SurfaceMotion&,   \
                          ForceForm, LinkSums&);                                                         \
  template void correct_run(Block<T>&, Parity, const CutLinks<T>&, const LinkRun&, const SurfaceMotion&, \
                            LinkSums&);                                                                  \
  template void stiffness_run(const CutLinks<T>&, const LinkRun&, StiffnessSums&);
SILT_INSTANTIATE(float)
SILT_INSTANTIATE(double)

}  // namespace silt::lbm::SILT_ISA
