#pragma once
// The exchange between fluid and surface along cut links, and its sums: for a vector of links, or one
// (SILT_SCALAR). Template parameters `Read` and `Links` read the populations.
#include "lbm/blocks/excess.hpp"
#include "lbm/blocks/fixed_sum.hpp"
#include "lbm/walls/link_places.hpp"

namespace silt::lbm::SILT_BUILD {

/// The rows in which slots of a link and its cell are listed. The pair beyond is listed only if it is read
/// from the block. For `single_cell_gap` all populations that leave the cell follow out_row.
enum LinkRow { back_row, cell_row, out_row, behind_row, against_row, away_row, toward_row };

/// The slots that a link reads behind its cell, from those of its own populations.
template <class Whole>
struct SlotsBehind {
  Whole behind, against, away, toward;
  SILT_DEVICE SlotsBehind(const Whole& out, const Whole& back, const Whole& step)
      : behind(out - step), against(back - step), away(back - 2 * step), toward(out - 2 * step) {}
};

/// Writes the values of the first `count` links of a vector.
template <class T>
SILT_DEVICE void scatter(T* to, const typename Lanes<T>::Whole& slots, const typename Lanes<T>::Real& values,
                         int count) {
  if (count >= Lanes<T>::count) return Lanes<T>::scatter(to, slots, values);
  for (int k = 0; k < count; ++k) to[lane_of(slots, k)] = lane_of(values, k);
}

/// The velocity of a rigid surface at an arm r from its reference point.
template <class T>
struct Motion {
  using V = typename Lanes<T>::Real;
  T v[3], o[3];
  template <class Velocity>  // SurfaceMotion or SurfaceIncrement
  SILT_DEVICE explicit Motion(const Velocity& m) {
    for (int k = 0; k < 3; ++k) {
      v[k] = T(m.v[k]);
      o[k] = T(m.omega[k]);
    }
  }
  SILT_DEVICE V x(const V& y, const V& z) const { return v[0] + (o[1] * z - o[2] * y); }
  SILT_DEVICE V y(const V& z, const V& x) const { return v[1] + (o[2] * x - o[0] * z); }
  SILT_DEVICE V z(const V& x, const V& y) const { return v[2] + (o[0] * y - o[1] * x); }
};

/// Returns c_i.u of the cells of links, from the populations that left the cells.
template <class T, class Read>
SILT_DEVICE typename Lanes<T>::Real velocity_along(const Read& read, const WallFluid<T>& fluid,
                                                   const Places<T>& at) {
  typename Lanes<T>::Real momentum[3];
  for (int d = 0; d < 3; ++d) momentum[d] = typename Lanes<T>::Real{} + T(-0.5) * fluid.force[d];
  for_directions<D3Q19, 1>([&](auto j) __attribute__((always_inline)) {
    constexpr Int3 v = lbm::D3Q19::c[j()];
    const auto out = read(out_row + j());
    if constexpr (v.x != 0) momentum[0] += T(v.x) * out;
    if constexpr (v.y != 0) momentum[1] += T(v.y) * out;
    if constexpr (v.z != 0) momentum[2] += T(v.z) * out;
  });
  return at.along(momentum[0], momentum[1], momentum[2]);
}

/// Populations of a vector of links: `out` goes to the surface, `back` returns (method.md, equations 9 and
/// 15); `excess` is the mass given beyond the motion of the surface (9a).
template <class T>
struct Exchange {
  typename Lanes<T>::Real out, back, excess;
};

/// The excess of a vector of links in quanta: integers as wide as T.
template <class T>
using ExcessLanes = typename VectorOf<ExcessQuanta<T>, Lanes<T>::count>::type;
template <class T>
SILT_DEVICE ExcessLanes<T> excess_quanta(const typename Lanes<T>::Real& x) {
  using V = typename Lanes<T>::Real;
  if constexpr (sizeof(T) == 8) {  // in the low bits of the mantissa
    constexpr double large = 0x1.8p52 * excess_quantum<T>;
    return std::bit_cast<ExcessLanes<T>>(V(x + large)) - std::bit_cast<std::int64_t>(large);
  } else {
    constexpr T most = T(0x1p30);
    V y = x * T(1 / excess_quantum<T>);
    y += y > V{} ? V{} + T(0.5) : V{} - T(0.5);
    y = y < V{} + most ? y : V{} + most;  // not a number is clamped, too
    y = y > V{} - most ? y : V{} - most;
    return converted<ExcessLanes<T>>(y);
  }
}

template <WallScheme scheme, class T, class Read, class V = typename Lanes<T>::Real>
SILT_DEVICE Exchange<T> exchange(const Read& read, const WallFluid<T>& fluid, const Places<T>& at, const V& q,
                                 const V& cu, const OppositeWall<V>& opposite) {
  const auto s = coefficients<scheme>(q, at.weight6(), fluid);
  const auto out = read(out_row);
  auto back = s.a * out - s.k * cu;
  if constexpr (reads_behind(scheme)) {
    const auto against = read(against_row), behind = read(behind_row);
    auto others = s.b * behind + s.c * against;
    auto uneven = s.a - s.c;
    if constexpr (reads_beyond(scheme)) {
      const auto pair = read.beyond();
      others += s.d * pair.away + s.g * pair.toward;
      uneven -= T(2) * s.d + s.g;
    }
    if (fluid.has_force()) {
      const auto cf = at.c[0] * fluid.force[0] + at.c[1] * fluid.force[1] + at.c[2] * fluid.force[2];
      others += T(0.5) * (s.k - at.weight6() * uneven) * cf;
    }
    back += others;
  } else if constexpr (scheme == WallScheme::single_cell_gap) {
    const auto along = velocity_along(read, fluid, at);
    back -= (at.weight6() - s.k) * along + at.weight6() * gap_curvature(q, along, cu, opposite, fluid);
  }
  return {out, back, (back - out) + at.weight6() * cu};
}

/// Returns the population that replaces `before`, which a link returned, if the surface moves faster by `u`.
/// The added mass is that of the motion alone (method.md, equation 23).
template <class T, class V = typename Lanes<T>::Real>
SILT_DEVICE V corrected(const V& before, const Places<T>& at, const Motion<T>& u) {
  return before -
         at.weight6() * at.along(u.x(at.r[1], at.r[2]), u.y(at.r[2], at.r[0]), u.z(at.r[0], at.r[1]));
}

/// The sums of force and torque over a group, in registers.
template <class T>
class GroupSums {
 public:
  using L = Lanes<T>;
  using V = typename L::Real;
  /// `galilean` is 1 or 0 (ForceForm); `limit` bounds |f* + f_opp|.
  SILT_DEVICE GroupSums(T galilean, T limit) : galilean_(galilean * T(1 / link_quantum)), limit_(limit) {}

  SILT_DEVICE void add(const Exchange<T>& e, const typename L::Mask& counted, const Places<T>& at,
                       const V& ux, const V& uy, const V& uz) {
    const V in = counted ? e.out : V{}, returned = counted ? e.back : V{};
    constexpr T scale = T(1 / link_quantum);
    const V sum = (in + returned) * scale, difference = (in - returned) * galilean_;
    const V g[3] = {at.c[0] * sum - ux * difference, at.c[1] * sum - uy * difference,
                    at.c[2] * sum - uz * difference};
    const auto& r = at.r;
    for (int d = 0; d < 3; ++d) force_[d].add(g[d]);
    torque_[0].add(r[1] * g[2] - r[2] * g[1]);
    torque_[1].add(r[2] * g[0] - r[0] * g[2]);
    torque_[2].add(r[0] * g[1] - r[1] * g[0]);
    terms_ += L::count;
    good_ &= L::magnitude(in) + L::magnitude(returned) < limit_;
  }
  /// Calls add(term, sum) for force and torque. The terms are valid if in_range().
  template <class Sums, class Add>
  SILT_DEVICE void add_to(Sums& sums, const Add& add) const {
    for (int d = 0; d < 3; ++d) {
      add(force_[d].total(terms_), sums.force[d]);
      add(torque_[d].total(terms_), sums.torque[d]);
    }
  }
  SILT_DEVICE bool in_range() const { return L::all(good_); }

 private:
  T galilean_, limit_;
  FixedSum<T> force_[3], torque_[3];
  std::uint64_t terms_ = 0;
  typename L::Mask good_ = V{} == V{};
};

/// The constants of a group's links in a step (surface motion, fluid, mass by each link), and their sums.
template <class T>
struct GroupStep {
  Motion<T> u;
  const WallFluid<T>& fluid;
  ExcessLanes<T> besides;
  GroupSums<T> sums;
  SILT_DEVICE GroupStep(const SurfaceMotion& m, const WallFluid<T>& fluid, bool galilean, double limit)
      : u(m),
        fluid(fluid),
        besides(ExcessLanes<T>{} + ExcessQuanta<T>(m.mass_by_link)),
        sums(galilean ? T(1) : T(0), T(limit)) {}

  /// Returns the populations that links return; adds to the excess of their cells and to the sums.
  template <WallScheme scheme, class Links>
  [[gnu::always_inline]] SILT_DEVICE typename Lanes<T>::Real apply(const Links& links,
                                                                   const typename Lanes<T>::Mask& counted) {
    const Places<T>& at = links.at;
    const auto ux = u.x(at.r[1], at.r[2]), uy = u.y(at.r[2], at.r[0]), uz = u.z(at.r[0], at.r[1]);
    const Exchange<T> e = exchange<scheme>(links, fluid, at, links.q, at.along(ux, uy, uz), links.opposite());
    const ExcessLanes<T> own = excess_quanta<T>(e.excess) - besides;
    links.give(counted ? own : ExcessLanes<T>{});
    sums.add(e, counted, at, ux, uy, uz);
    return e.back;
  }
};

}  // namespace silt::lbm::SILT_BUILD
