// Built once an instruction set. The links of a group are taken 64 at a time: places, gather, arithmetic,
// scatter, sums, each a loop over whole vectors (groups are filled up).
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "lbm/kernels.hpp"
#include "lbm/link_lanes.hpp"

namespace silt::lbm::SILT_ISA {
namespace {

inline constexpr int chunk = 64;
static_assert(chunk % link_lanes == 0);

/// The sum of terms rounded to whole quanta: x / quantum + 3 * 2^51 has the rounded integer in its low
/// mantissa bits. |x| < 2^51 quanta. The constant's own bits are taken off once for all terms.
struct FixedSum {
  static constexpr double magic = 0x1.8p52;
  std::uint64_t bits = 0;
  void add(double x, double inverse_quantum) {
    bits += std::bit_cast<std::uint64_t>(x * inverse_quantum + magic);
  }
  std::int64_t sum(int terms) const {
    return std::int64_t(bits - std::uint64_t(terms) * std::bit_cast<std::uint64_t>(magic));
  }
};

inline constexpr DirectionCodes codes;

/// Of the links [first, first + chunk) of a group: directions, arms from the reference point, c.
template <class T>
struct Places {
  std::int32_t cell[chunk], direction[chunk];  // cell: offset within the plane from the group's corner
  T r[3][chunk], c[3][chunk];

  Places(const std::uint32_t* place, int padded, std::int32_t row, const SurfaceFrame& frame,
         const LinkGroup& group) {
    const Int3 far = group.corner - frame.cell;
    const T ox = T(frame.offset[0]), oy = T(frame.offset[1]), z = T(far.z) + T(frame.offset[2]);
    for (int l = 0; l < padded; ++l) {
      const std::int32_t x = place_x(place[l]), y = place_y(place[l]);
      cell[l] = x + row * y, direction[l] = place_direction(place[l]);
      r[0][l] = T(x + far.x) + ox, r[1][l] = T(y + far.y) + oy, r[2][l] = z;
    }
    std::int32_t code[chunk];
    look_up(codes.of, direction, padded, code);
    for (int l = 0; l < padded; ++l) {
      c[0][l] = T(DirectionCodes::x(code[l])), c[1][l] = T(DirectionCodes::y(code[l])),
      c[2][l] = T(DirectionCodes::z(code[l]));
    }
  }
  /// Where a population of each link is: its slot at the link's cell.
  void slots(const std::int32_t (&table)[32], int padded, std::int32_t* at) const {
    look_up(table, direction, padded, at);
    for (int l = 0; l < padded; ++l) at[l] += cell[l];
  }
};

/// Velocity of a rigid surface.
template <class T>
struct Motion {
  T v[3], o[3];
  explicit Motion(const SurfaceMotion& m) {
    for (int k = 0; k < 3; ++k) v[k] = T(m.v[k]), o[k] = T(m.omega[k]);
  }
  T x(T y, T z) const { return v[0] + (o[1] * z - o[2] * y); }
  T y(T z, T x) const { return v[1] + (o[2] * x - o[0] * z); }
  T z(T x, T y) const { return v[2] + (o[0] * y - o[1] * x); }
};

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
    case narrow:
      return f(std::integral_constant<WallScheme, narrow>{});
    case bounce_back:
      return f(std::integral_constant<WallScheme, bounce_back>{});
  }
}

template <class T>
T weight6_of(T cx, T cy, T cz) {
  return cx * cx + cy * cy + cz * cz > T(1) ? T(6 * w(7)) : T(6 * w(1));
}

/// Calls f(first, valid, padded) for the chunks of a group: `padded` a multiple of link_lanes.
template <class F>
void for_chunks(const LinkGroup& group, F&& f) {
  for (std::uint32_t first = 0; first < group.count; first += chunk) {
    const int n = int(std::min<std::uint32_t>(chunk, group.count - first));
    f(group.begin + first, n, (n + link_lanes - 1) & ~(link_lanes - 1));
  }
}

/// The largest |f* + f_opp| for which no term leaves its range.
double largest_exchange(const SurfaceFrame& frame, const SurfaceMotion& m) {
  double u = 0;
  for (int k = 0; k < 3; ++k) u += std::fabs(m.v[k]) + frame.reach * std::fabs(m.omega[k]);
  return 32 / ((1 + frame.reach) * (1 + u));
}

/// c_i.u of the links' cells, from what left them.
template <class T>
void velocity_along(const T* data, const LinkSlots& slots, const WallFluid<T>& fluid, const Places<T>& at,
                    int padded, T* cu) {
  T momentum[3][chunk], out[chunk];
  std::int32_t slot[chunk];
  for (int d = 0; d < 3; ++d) std::fill_n(momentum[d], padded, T(-0.5) * fluid.force[d]);
  for (int j = 1; j < directions; ++j) {
    for (int l = 0; l < padded; ++l) slot[l] = at.cell[l] + slots.out[j];
    gather(data, slot, padded, out);
    for (int d = 0; d < 3; ++d)
      if (lbm::c[j][d] != 0)
        for (int l = 0; l < padded; ++l) momentum[d][l] += T(lbm::c[j][d]) * out[l];
  }
  for (int l = 0; l < padded; ++l)
    cu[l] = at.c[0][l] * momentum[0][l] + at.c[1][l] * momentum[1][l] + at.c[2][l] * momentum[2][l];
}

template <WallScheme scheme, class T>
void apply(Block<T>& block, const LinkSlots& slots, const CutLinks<T>& links, const LinkGroup& group,
           const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  const SurfaceFrame& frame = links.surfaces[group.surface];
  const Motion<T> u(motion);
  const T limit = T(largest_exchange(frame, motion));
  const T* const push = links.fluid.force;
  const T galilean = form == ForceForm::galilean ? T(1) : T(0);
  T* const data = block.data() + block.middle() + block.cell(group.corner);
  std::int64_t force[3] = {}, torque[3] = {}, mass = 0;
  int bad = 0;

  for_chunks(group, [&](std::uint32_t first, int n, int padded) {
    const Places<T> at(links.place.data() + first, padded, std::int32_t(block.row_stride()), frame, group);
    const T* const q = links.q.data() + first;
    std::int32_t slot[chunk];
    T o[chunk], f[chunk], b[chunk], r[chunk];
    at.slots(slots.out, padded, slot), gather(data, slot, padded, o);
    if constexpr (reads_behind(scheme)) {
      at.slots(slots.behind, padded, slot), gather(data, slot, padded, f);
      at.slots(slots.against, padded, slot), gather(data, slot, padded, b);
    }
    if constexpr (scheme == WallScheme::narrow) {
      at.slots(slots.against, padded, slot), gather(data, slot, padded, b);
      velocity_along(data, slots, links.fluid, at, padded, f);
    }
    T ux[chunk], uy[chunk], uz[chunk];
    for (int l = 0; l < padded; ++l) {
      const T x = at.r[0][l], y = at.r[1][l], z = at.r[2][l], cx = at.c[0][l], cy = at.c[1][l],
              cz = at.c[2][l];
      ux[l] = u.x(y, z), uy[l] = u.y(z, x), uz[l] = u.z(x, y);
      const T weight6 = weight6_of(cx, cy, cz);
      const auto s = coefficients<scheme>(q[l], weight6, links.fluid);
      const T cu = cx * ux[l] + cy * uy[l] + cz * uz[l];
      r[l] = s.a * o[l] - s.k * cu;
      if constexpr (reads_behind(scheme)) {
        const T cf = cx * push[0] + cy * push[1] + cz * push[2];
        r[l] += s.b * f[l] + s.c * b[l] + T(0.5) * (s.k - weight6 * (s.a - s.c)) * cf;
      } else if constexpr (scheme == WallScheme::narrow) {
        const T cf = cx * push[0] + cy * push[1] + cz * push[2];
        r[l] += s.c * (b[l] + T(0.5) * weight6 * cf) - (weight6 * s.a - s.k) * f[l];
      }
    }
    at.slots(slots.back, padded, slot), scatter(data, slot, padded, r);

    FixedSum fx, fy, fz, tx, ty, tz, m;
    for (int l = 0; l < padded; ++l) {
      const T x = at.r[0][l], y = at.r[1][l], z = at.r[2][l];
      const T in = l < n ? o[l] : T(0), returned = l < n ? r[l] : T(0);
      const T sum = in + returned, difference = (in - returned) * galilean;
      const T gx = at.c[0][l] * sum - ux[l] * difference;
      const T gy = at.c[1][l] * sum - uy[l] * difference;
      const T gz = at.c[2][l] * sum - uz[l] * difference;
      constexpr double scale = 1 / link_quantum;
      fx.add(gx, scale), fy.add(gy, scale), fz.add(gz, scale);
      tx.add(y * gz - z * gy, scale), ty.add(z * gx - x * gz, scale), tz.add(x * gy - y * gx, scale);
      m.add(double(returned) - double(in), 1 / mass_quantum);
      bad |= !(std::fabs(in) + std::fabs(returned) < limit);
    }
    force[0] += fx.sum(padded), force[1] += fy.sum(padded), force[2] += fz.sum(padded);
    torque[0] += tx.sum(padded), torque[1] += ty.sum(padded), torque[2] += tz.sum(padded);
    mass += m.sum(padded);
  });
  for (int k = 0; k < 3; ++k) sums.force[k] += force[k], sums.torque[k] += torque[k];
  sums.mass += mass;
  if (bad) sums.invalid = true;
}

template <WallScheme scheme, class T>
void correct(Block<T>& block, const LinkSlots& slots, const CutLinks<T>& links, const LinkGroup& group,
             const SurfaceMotion& increment, LinkSums& sums) {
  const Motion<T> u(increment);
  T* const data = block.data() + block.middle() + block.cell(group.corner);
  std::int64_t mass = 0;
  for_chunks(group, [&](std::uint32_t first, int n, int padded) {
    const Places<T> at(links.place.data() + first, padded, std::int32_t(block.row_stride()),
                       links.surfaces[group.surface], group);
    const T* const q = links.q.data() + first;
    std::int32_t slot[chunk];
    T before[chunk], after[chunk];
    at.slots(slots.back, padded, slot), gather(data, slot, padded, before);
    FixedSum m;
    for (int l = 0; l < padded; ++l) {
      const T x = at.r[0][l], y = at.r[1][l], z = at.r[2][l], cx = at.c[0][l], cy = at.c[1][l],
              cz = at.c[2][l];
      const T cu = cx * u.x(y, z) + cy * u.y(z, x) + cz * u.z(x, y);
      after[l] = before[l] - coefficients<scheme>(q[l], weight6_of(cx, cy, cz), links.fluid).k * cu;
      m.add(l < n ? double(after[l]) - double(before[l]) : 0.0, 1 / mass_quantum);
    }
    scatter(data, slot, padded, after);
    mass += m.sum(padded);
  });
  sums.mass += mass;
}

/// 21 sums: the upper triangle of k J J^T. In single precision of 32-bit terms.
template <WallScheme scheme, class T>
void stiffness(const CutLinks<T>& links, const LinkGroup& group, int exponent, StiffnessSums& sums) {
  const T unit = T(1 / stiffness_quantum<T>), arm = T(std::ldexp(1.0, -exponent));
  for_chunks(group, [&](std::uint32_t first, int n, int padded) {
    const Places<T> at(links.place.data() + first, padded, 0, links.surfaces[group.surface], group);
    const T* const q = links.q.data() + first;
    T j[6][chunk], kj[6][chunk];
    for (int l = 0; l < padded; ++l) {
      const T cx = at.c[0][l], cy = at.c[1][l], cz = at.c[2][l];
      const T x = at.r[0][l] * arm, y = at.r[1][l] * arm, z = at.r[2][l] * arm;
      const T k = l < n ? coefficients<scheme>(q[l], weight6_of(cx, cy, cz), links.fluid).k * unit : T(0);
      j[0][l] = cx, j[1][l] = cy, j[2][l] = cz;
      j[3][l] = y * cz - z * cy, j[4][l] = z * cx - x * cz, j[5][l] = x * cy - y * cx;
      for (int d = 0; d < 6; ++d) kj[d][l] = k * j[d][l];
    }
    int e = 0;
    for (int row = 0; row < 6; ++row)
      for (int column = row; column < 6; ++column, ++e) {
        std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t> sum = 0;
        for (int l = 0; l < padded; ++l) sum += decltype(sum)(kj[row][l] * j[column][l]);
        sums.h[e] += sum;
      }
  });
}

}  // namespace

template <class T>
void apply_group(Block<T>& block, const LinkSlots& slots, const CutLinks<T>& links, const LinkGroup& group,
                 const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  with_scheme(group.scheme,
              [&](auto scheme) { apply<scheme()>(block, slots, links, group, motion, form, sums); });
}

template <class T>
void correct_group(Block<T>& block, const LinkSlots& slots, const CutLinks<T>& links, const LinkGroup& group,
                   const SurfaceMotion& increment, LinkSums& sums) {
  with_scheme(group.scheme,
              [&](auto scheme) { correct<scheme()>(block, slots, links, group, increment, sums); });
}

template <class T>
void group_stiffness(const CutLinks<T>& links, const LinkGroup& group, int exponent, StiffnessSums& sums) {
  with_scheme(group.scheme, [&](auto scheme) { stiffness<scheme()>(links, group, exponent, sums); });
}

#define SILT_INSTANTIATE(T)                                                                      \
  template void apply_group(Block<T>&, const LinkSlots&, const CutLinks<T>&, const LinkGroup&,   \
                            const SurfaceMotion&, ForceForm, LinkSums&);                         \
  template void correct_group(Block<T>&, const LinkSlots&, const CutLinks<T>&, const LinkGroup&, \
                              const SurfaceMotion&, LinkSums&);                                  \
  template void group_stiffness(const CutLinks<T>&, const LinkGroup&, int exponent, StiffnessSums&);
SILT_INSTANTIATE(float)
SILT_INSTANTIATE(double)

}  // namespace silt::lbm::SILT_ISA
