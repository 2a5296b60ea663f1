// Built once an instruction set. The links of a run are taken 64 at a time: places, gather, arithmetic,
// scatter, sums, each a loop that vectorises by itself, over whole vectors (runs are filled up).
//
// Of one direction, the lever arm r x c has two degrees of freedom: with d an axis along which c is zero, and
// p, q the other two in cyclic order,
//   r x c = alpha e1 + beta e2,  alpha = r_d, e1 = c_p e_q - c_q e_p,  beta = r_p c_q - r_q c_p, e2 = e_d.
#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>

#include "lbm/kernels.hpp"

namespace silt::lbm::SILT_ISA {
namespace {

inline constexpr int chunk = 64;
static_assert(chunk % link_lanes == 0);

/// The sum of terms rounded to whole quanta: x / quantum + 3 * 2^51 has the rounded integer in its low
/// mantissa bits. |x| < 2^51 quanta.
inline constexpr double fixed_magic = 0x1.8p52;
inline std::int64_t fixed(double x, double inverse_quantum) {
  return std::bit_cast<std::int64_t>(x * inverse_quantum + fixed_magic) -
         std::bit_cast<std::int64_t>(fixed_magic);
}

struct Direction {
  int c[3], p, q, d;
  explicit Direction(int i) : c{lbm::c[i].x, lbm::c[i].y, lbm::c[i].z} {
    d = c[2] == 0 ? 2 : c[1] == 0 ? 1 : 0;
    p = (d + 1) % 3, q = (d + 2) % 3;
  }
};

/// Cells, arms from the reference point and lever coordinates of the links [first, first + chunk) of a run.
template <class T>
struct Places {
  std::int32_t cell[chunk];
  T r[3][chunk], beta[chunk];

  Places(const std::uint32_t* place, int padded, const Block<T>* block, const CutLinks<T>& links,
         const LinkGroup& group, const Direction& g) {
    const SurfaceFrame& frame = links.surfaces[group.surface];
    const Int3 far = group.corner - frame.cell;
    const T ox = T(frame.offset[0]), oy = T(frame.offset[1]), oz = T(frame.offset[2]);
    constexpr std::uint32_t low = (1u << place_bits) - 1;
    const std::int32_t corner = block ? std::int32_t(block->cell(group.corner)) : 0;
    const std::int32_t row = block ? std::int32_t(block->row_stride()) : 0;
    const std::int32_t plane = block ? std::int32_t(block->plane_stride()) : 0;
    for (int l = 0; l < padded; ++l) {
      const std::int32_t x = place[l] & low, y = place[l] >> place_bits & low,
                         z = place[l] >> (2 * place_bits);
      cell[l] = corner + x + row * y + plane * z;
      r[0][l] = T(x + far.x) + ox, r[1][l] = T(y + far.y) + oy, r[2][l] = T(z + far.z) + oz;
    }
    const T cq = T(g.c[g.q]), cp = T(g.c[g.p]);
    const T *rp = r[g.p], *rq = r[g.q];
    for (int l = 0; l < padded; ++l) beta[l] = rp[l] * cq - rq[l] * cp;
  }
};

/// Velocity along c of a surface at a link: along + alpha turn1 + beta turn2.
template <class T>
struct Motion {
  T v[3], o[3], along, turn1, turn2;
  Motion(const SurfaceMotion& m, const Direction& g) {
    for (int k = 0; k < 3; ++k) v[k] = T(m.v[k]), o[k] = T(m.omega[k]);
    along = T(g.c[0]) * v[0] + T(g.c[1]) * v[1] + T(g.c[2]) * v[2];
    turn1 = T(g.c[g.p]) * o[g.q] - T(g.c[g.q]) * o[g.p], turn2 = o[g.d];
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
    case parabolic:
      return f(std::integral_constant<WallScheme, parabolic>{});
    case narrow:
      return f(std::integral_constant<WallScheme, narrow>{});
  }
}

/// Calls f(first, valid, padded) for the chunks of a run: `padded` a multiple of link_lanes.
template <class F>
void for_chunks(const LinkRun& run, F&& f) {
  for (std::uint32_t first = 0; first < run.count; first += chunk) {
    const int n = int(std::min<std::uint32_t>(chunk, run.count - first));
    f(run.begin + first, n, (n + link_lanes - 1) & ~(link_lanes - 1));
  }
}

/// The largest |f* + f_opp| for which no term leaves its range.
double largest_exchange(const SurfaceFrame& frame, const SurfaceMotion& m) {
  double u = 0;
  for (int k = 0; k < 3; ++k) u += std::fabs(m.v[k]) + frame.reach * std::fabs(m.omega[k]);
  return 32 / ((1 + frame.reach) * (1 + u));
}

/// c_i.u of cells, from what left them.
template <class T>
void velocity_along(const Block<T>& block, Parity parity, const WallFluid<T>& fluid, int i,
                    const std::int32_t* cell, int n, T* cu) {
  const Int3 v = lbm::c[i];
  const T force = T(v.x) * fluid.force[0] + T(v.y) * fluid.force[1] + T(v.z) * fluid.force[2];
  std::fill_n(cu, n, T(-0.5) * force);
  for (int j = 1; j < directions; ++j) {
    const int along = v.x * lbm::c[j].x + v.y * lbm::c[j].y + v.z * lbm::c[j].z;
    if (along == 0) continue;
    const T* const out = block.data() + block.leaving(j, parity);
    for (int l = 0; l < n; ++l) cu[l] += T(along) * out[cell[l]];
  }
}

template <WallScheme scheme, class T>
void apply_run(Block<T>& block, Parity parity, const CutLinks<T>& links, const LinkGroup& group,
               const LinkRun& run, const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  const int i = run.direction, j = opposite(i);
  const Direction g(i);
  const Motion<T> u(motion, g);
  const T weight6 = T(6 * w(i)), cx = T(g.c[0]), cy = T(g.c[1]), cz = T(g.c[2]);
  const T limit = T(largest_exchange(links.surfaces[group.surface], motion));
  const T* const push = links.fluid.force;
  const T cf = cx * push[0] + cy * push[1] + cz * push[2];
  const T galilean = form == ForceForm::galilean ? T(1) : T(0);
  T* const data = block.data();
  const T* const out = data + block.leaving(i, parity);      // f*_i(x)
  const T* const behind = data + block.arriving(i, parity);  // f*_i(x - c_i)
  const T* const against = data + block.leaving(j, parity);  // f*_opp(x)
  T* const back = data + block.arriving(j, parity);          // f_opp(x, t+1)
  std::int64_t force[3] = {}, torque[3] = {}, mass = 0;
  int bad = 0;

  for_chunks(run, [&](std::uint32_t first, int n, int padded) {
    const Places<T> at(links.place.data() + first, padded, &block, links, group, g);
    const T* const q = links.q.data() + first;
    const T* const alpha = at.r[g.d];
    T o[chunk], f[chunk], b[chunk], r[chunk];
    for (int l = 0; l < padded; ++l) o[l] = out[at.cell[l]];
    if constexpr (reads_behind(scheme)) {
      for (int l = 0; l < padded; ++l) f[l] = behind[at.cell[l]];
      for (int l = 0; l < padded; ++l) b[l] = against[at.cell[l]];
    }
    if constexpr (scheme == WallScheme::narrow) {
      for (int l = 0; l < padded; ++l) b[l] = against[at.cell[l]];
      velocity_along(block, parity, links.fluid, i, at.cell, padded, f);
    }
    for (int l = 0; l < padded; ++l) {
      const auto s = coefficients<scheme>(q[l], weight6, links.fluid);
      const T cu = u.along + (alpha[l] * u.turn1 + at.beta[l] * u.turn2);
      r[l] = s.a * o[l] - s.k * cu;
      if constexpr (reads_behind(scheme))
        r[l] += s.b * f[l] + s.c * b[l] + T(0.5) * (s.k - weight6 * (s.a - s.c)) * cf;
      else if constexpr (scheme == WallScheme::narrow)
        r[l] += s.c * (b[l] + T(0.5) * weight6 * cf) - (weight6 * s.a - s.k) * f[l];
    }
#pragma GCC ivdep
    for (int l = 0; l < padded; ++l) back[at.cell[l]] = r[l];

    std::int64_t fx = 0, fy = 0, fz = 0, tx = 0, ty = 0, tz = 0, m = 0;
    for (int l = 0; l < padded; ++l) {
      const T x = at.r[0][l], y = at.r[1][l], z = at.r[2][l];
      const T in = l < n ? o[l] : T(0), returned = l < n ? r[l] : T(0);
      const T sum = in + returned, difference = (in - returned) * galilean;
      const T gx = cx * sum - (u.v[0] + (u.o[1] * z - u.o[2] * y)) * difference;
      const T gy = cy * sum - (u.v[1] + (u.o[2] * x - u.o[0] * z)) * difference;
      const T gz = cz * sum - (u.v[2] + (u.o[0] * y - u.o[1] * x)) * difference;
      constexpr double scale = 1 / link_quantum;
      fx += fixed(gx, scale), fy += fixed(gy, scale), fz += fixed(gz, scale);
      tx += fixed(y * gz - z * gy, scale), ty += fixed(z * gx - x * gz, scale),
          tz += fixed(x * gy - y * gx, scale);
      m += fixed(double(returned) - double(in), 1 / mass_quantum);
      bad |= !(std::fabs(in) + std::fabs(returned) < limit);
    }
    force[0] += fx, force[1] += fy, force[2] += fz, torque[0] += tx, torque[1] += ty, torque[2] += tz;
    mass += m;
  });
  for (int k = 0; k < 3; ++k) sums.force[k] += force[k], sums.torque[k] += torque[k];
  sums.mass += mass;
  if (bad) sums.invalid = true;
}

template <WallScheme scheme, class T>
void correct_run(Block<T>& block, Parity parity, const CutLinks<T>& links, const LinkGroup& group,
                 const LinkRun& run, const SurfaceMotion& increment, LinkSums& sums) {
  const Direction g(run.direction);
  const Motion<T> u(increment, g);
  const T weight6 = T(6 * w(run.direction));
  T* const back = block.data() + block.arriving(opposite(run.direction), parity);
  std::int64_t mass = 0;
  for_chunks(run, [&](std::uint32_t first, int n, int padded) {
    const Places<T> at(links.place.data() + first, padded, &block, links, group, g);
    const T* const q = links.q.data() + first;
    const T* const alpha = at.r[g.d];
    T before[chunk], after[chunk];
    for (int l = 0; l < padded; ++l) before[l] = back[at.cell[l]];
    std::int64_t m = 0;
    for (int l = 0; l < padded; ++l) {
      const T cu = u.along + (alpha[l] * u.turn1 + at.beta[l] * u.turn2);
      after[l] = before[l] - coefficients<scheme>(q[l], weight6, links.fluid).k * cu;
      m += fixed(l < n ? double(after[l]) - double(before[l]) : 0.0, 1 / mass_quantum);
    }
#pragma GCC ivdep
    for (int l = 0; l < padded; ++l) back[at.cell[l]] = after[l];
    mass += m;
  });
  sums.mass += mass;
}

struct LeverSums {  // of k, k alpha, k beta, k alpha^2, k alpha beta, k beta^2
  std::int64_t k = 0, a = 0, b = 0, aa = 0, ab = 0, bb = 0;
};

/// J = [c, alpha e1 + beta e2]; c, e1, e2 are made of integers, so no further rounding.
void add_stiffness(const Direction& g, const LeverSums& s, StiffnessSums& sums) {
  int e1[3] = {}, e2[3] = {};
  e1[g.q] = g.c[g.p], e1[g.p] = -g.c[g.q], e2[g.d] = 1;
  int e = 0;
  for (int row = 0; row < 6; ++row)
    for (int column = row; column < 6; ++column, ++e) {
      const int m = row % 3, n = column % 3;
      if (column < 3)
        sums.h[e] += s.k * (g.c[m] * g.c[n]);
      else if (row < 3)
        sums.h[e] += g.c[m] * (s.a * e1[n] + s.b * e2[n]);
      else
        sums.h[e] += s.aa * (e1[m] * e1[n]) + s.ab * (e1[m] * e2[n] + e2[m] * e1[n]) + s.bb * (e2[m] * e2[n]);
    }
}

template <WallScheme scheme, class T>
void run_stiffness(const CutLinks<T>& links, const LinkGroup& group, const LinkRun& run,
                   StiffnessSums& sums) {
  const Direction g(run.direction);
  const T weight6 = T(6 * w(run.direction));
  LeverSums all;
  for_chunks(run, [&](std::uint32_t first, int n, int padded) {
    const Places<T> at(links.place.data() + first, padded, nullptr, links, group, g);
    const T* const q = links.q.data() + first;
    const T* const alpha = at.r[g.d];
    LeverSums s;
    constexpr double scale = 1 / stiffness_quantum;
    for (int l = 0; l < padded; ++l) {
      const T k = l < n ? coefficients<scheme>(q[l], weight6, links.fluid).k : T(0), a = alpha[l],
              b = at.beta[l];
      s.k += fixed(k, scale), s.a += fixed(k * a, scale), s.b += fixed(k * b, scale);
      s.aa += fixed(k * a * a, scale), s.ab += fixed(k * a * b, scale), s.bb += fixed(k * b * b, scale);
    }
    all.k += s.k, all.a += s.a, all.b += s.b, all.aa += s.aa, all.ab += s.ab, all.bb += s.bb;
  });
  add_stiffness(g, all, sums);
}

}  // namespace

template <class T>
void apply_group(Block<T>& block, Parity parity, const CutLinks<T>& links, const LinkGroup& group,
                 const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  for (std::uint32_t k = group.first_run; k < group.end_run; ++k)
    with_scheme(links.runs[k].scheme, [&](auto scheme) {
      apply_run<scheme()>(block, parity, links, group, links.runs[k], motion, form, sums);
    });
}

template <class T>
void correct_group(Block<T>& block, Parity parity, const CutLinks<T>& links, const LinkGroup& group,
                   const SurfaceMotion& increment, LinkSums& sums) {
  for (std::uint32_t k = group.first_run; k < group.end_run; ++k)
    with_scheme(links.runs[k].scheme, [&](auto scheme) {
      correct_run<scheme()>(block, parity, links, group, links.runs[k], increment, sums);
    });
}

template <class T>
void group_stiffness(const CutLinks<T>& links, const LinkGroup& group, StiffnessSums& sums) {
  for (std::uint32_t k = group.first_run; k < group.end_run; ++k)
    with_scheme(links.runs[k].scheme,
                [&](auto scheme) { run_stiffness<scheme()>(links, group, links.runs[k], sums); });
}

#define SILT_INSTANTIATE(T)                                                                                  \
  template void apply_group(Block<T>&, Parity, const CutLinks<T>&, const LinkGroup&, const SurfaceMotion&,   \
                            ForceForm, LinkSums&);                                                           \
  template void correct_group(Block<T>&, Parity, const CutLinks<T>&, const LinkGroup&, const SurfaceMotion&, \
                              LinkSums&);                                                                    \
  template void group_stiffness(const CutLinks<T>&, const LinkGroup&, StiffnessSums&);
SILT_INSTANTIATE(float)
SILT_INSTANTIATE(double)

}  // namespace silt::lbm::SILT_ISA
