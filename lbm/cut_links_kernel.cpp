// The pass over cut links, built once an instruction set. A vector of links at a time: place, gather,
// formula, scatter, sums, all in registers (groups are padded to whole vectors).
#include <algorithm>
#include <cmath>

#include "lbm/fixed_sum.hpp"
#include "lbm/link_fetch.hpp"

namespace silt::lbm::SILT_ISA {
namespace {

template <class T>
using LinkRows = typename LinkFetch<T>::Rows;

/// The velocity of a rigid surface at an arm.
template <class T>
struct Motion {
  using V = typename Lanes<T>::Real;
  T v[3], o[3];
  explicit Motion(const SurfaceMotion& m) {
    for (int k = 0; k < 3; ++k) {
      v[k] = T(m.v[k]);
      o[k] = T(m.omega[k]);
    }
  }
  V x(const V& y, const V& z) const { return v[0] + (o[1] * z - o[2] * y); }
  V y(const V& z, const V& x) const { return v[1] + (o[2] * x - o[0] * z); }
  V z(const V& x, const V& y) const { return v[2] + (o[0] * y - o[1] * x); }
};

/// The largest |f* + f_opp| for which no term leaves its range (README.md, "Forces and sums").
double largest_exchange(const SurfaceFrame& frame, const SurfaceMotion& m) {
  double u = 0;
  for (int k = 0; k < 3; ++k) u += std::fabs(m.v[k]) + frame.reach * std::fabs(m.omega[k]);
  return 32 / ((1 + frame.reach) * (1 + u));
}

/// Where a vector of links reads: rows of slots from that of the group's corner on, and what passes beyond,
/// in the block or, by its numbers, of the block's pairs across.
template <class T>
struct Read {
  const T* data;
  LinkRows<T> rows;
  const std::uint32_t* across;  // null: in the block
  const BeyondPair<T>* pairs;

  auto operator()(int row) const { return Lanes<T>::gather(data, rows[row]); }
  BeyondPair<typename Lanes<T>::Real> beyond() const {
    if (!across) return {(*this)(away_row), (*this)(toward_row)};
    BeyondPair<typename Lanes<T>::Real> found;
    for (int l = 0; l < Lanes<T>::count; ++l)
      found.away[l] = pairs[across[l]].away, found.toward[l] = pairs[across[l]].toward;
    return found;
  }
};

/// c_i.u of the links' cells, from what left them.
template <class T>
typename Lanes<T>::Real velocity_along(const Read<T>& read, const WallFluid<T>& fluid, const Places<T>& at) {
  typename Lanes<T>::Real momentum[3];
  for (int d = 0; d < 3; ++d) momentum[d] = typename Lanes<T>::Real{} + T(-0.5) * fluid.force[d];
  for (int j = 1; j < directions; ++j) {
    const auto out = read(out_row + j);
    for (int d = 0; d < 3; ++d)
      if (lbm::c[j][d] != 0) momentum[d] += T(lbm::c[j][d]) * out;
  }
  return at.along(momentum[0], momentum[1], momentum[2]);
}

/// A vector of links sends `out` to the surface; `back` is what comes back (README.md, equations 9 and 15).
template <class T>
struct Exchange {
  typename Lanes<T>::Real out, back;
};

template <WallScheme scheme, class T, class V = typename Lanes<T>::Real>
Exchange<T> exchange(const Read<T>& read, const WallFluid<T>& fluid, const Places<T>& at, const V& q,
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
  return {out, back};
}

/// The sums of one group, kept in registers.
template <class T>
class GroupSums {
 public:
  using L = Lanes<T>;
  using V = typename L::Real;
  /// `galilean`: 1 or 0; `limit`: of |f* + f_opp|.
  GroupSums(T galilean, T limit) : galilean_(galilean * T(1 / link_quantum)), limit_(limit) {}

  void add(const Exchange<T>& e, const typename L::Mask& counted, const Places<T>& at, const V& ux,
           const V& uy, const V& uz) {
    const V in = counted ? e.out : V{}, returned = counted ? e.back : V{};
    constexpr T scale = T(1 / link_quantum), mass_scale = T(1 / mass_quantum);
    const V sum = (in + returned) * scale, difference = (in - returned) * galilean_;
    const V g[3] = {at.c[0] * sum - ux * difference, at.c[1] * sum - uy * difference,
                    at.c[2] * sum - uz * difference};
    const auto& r = at.r;
    for (int d = 0; d < 3; ++d) force_[d].add(g[d]);
    torque_[0].add(r[1] * g[2] - r[2] * g[1]);
    torque_[1].add(r[2] * g[0] - r[0] * g[2]);
    torque_[2].add(r[0] * g[1] - r[1] * g[0]);
    mass_.add(returned * mass_scale);
    mass_.subtract(in * mass_scale);
    terms_ += L::count;
    good_ &= L::magnitude(in) + L::magnitude(returned) < limit_;
  }
  void add_to(LinkSums& sums) const {
    for (int d = 0; d < 3; ++d) {
      sums.force[d] += force_[d].total(terms_);
      sums.torque[d] += torque_[d].total(terms_);
    }
    sums.mass += mass_.total(0);
    if (!L::all(good_)) sums.invalid = true;
  }

 private:
  T galilean_, limit_;
  FixedSum<T> force_[3], torque_[3], mass_;
  std::uint64_t terms_ = 0;
  typename L::Mask good_ = V{} == V{};
};

template <WallScheme scheme, class T>
void apply(const GroupInBlock<T>& here, const SurfaceMotion& motion, ForceForm form, LinkSums& sums,
           LinkFetch<T>& fetch) {
  using L = Lanes<T>;
  const auto& [block, slots, links, group, next, pairs, listed, far] = here;
  const SurfaceFrame& frame = links.frame;
  const Motion<T> u(motion);
  const PlaceOrigin<T> origin(block, group.corner, frame);
  const std::uint32_t* const place = links.place.data() + group.begin;
  const WallDistances<T> distance(links, group);
  const int count = int(group.count);
  T* const data = block.data() + block.middle() + block.cell(group.corner);
  GroupSums<T> total(form == ForceForm::galilean ? T(1) : T(0), T(largest_exchange(frame, motion)));
  int l = 0;
  for (; l < count; l += L::count) {
    const LinkRows<T> rows = fetch.at(l);
    const Places<T> at(place + l, origin);
    const auto q = distance.at(l);
    const auto ux = u.x(at.r[1], at.r[2]), uy = u.y(at.r[2], at.r[0]), uz = u.z(at.r[0], at.r[1]);
    OppositeWall<typename L::Real> opposite;
    if constexpr (scheme == WallScheme::single_cell_gap) {
      if (!links.opposite_q.empty()) {
        opposite.q = load<typename L::Real>(links.opposite_q.data() + group.opposite + l);
        opposite.u = load<typename L::Real>(links.opposite_u.data() + group.opposite + l);
      }
    }
    const std::uint32_t* const across = group.across ? links.across.data() + group.across_begin + l : nullptr;
    const Exchange<T> e = exchange<scheme>(Read<T>{data, rows, across, pairs}, links.fluid, at, q,
                                           at.along(ux, uy, uz), opposite);
    L::scatter(data, rows[back_row], e.back);
    total.add(e, L::below(count - l), at, ux, uy, uz);
  }
  fetch.finish(l);
  total.add_to(sums);
}

template <WallScheme scheme, class T>
void correct(const GroupInBlock<T>& here, const SurfaceMotion& increment, LinkSums& sums,
             LinkFetch<T>& fetch) {
  using L = Lanes<T>;
  const auto& [block, slots, links, group, next, pairs, listed, far] = here;
  using V = typename L::Real;
  const SurfaceFrame& frame = links.frame;
  const Motion<T> u(increment);
  const PlaceOrigin<T> origin(block, group.corner, frame);
  const std::uint32_t* const place = links.place.data() + group.begin;
  const WallDistances<T> distance(links, group);
  const int count = int(group.count);
  T* const data = block.data() + block.middle() + block.cell(group.corner);
  FixedSum<T> mass;
  int l = 0;
  for (; l < count; l += L::count) {
    const LinkRows<T> rows = fetch.at(l);
    const Places<T> at(place + l, origin);
    const V q = distance.at(l);
    const V cu = at.along(u.x(at.r[1], at.r[2]), u.y(at.r[2], at.r[0]), u.z(at.r[0], at.r[1]));
    const std::int32_t* const slot = rows[back_row];
    const V before = L::gather(data, slot);
    const V after = before - coefficients<scheme>(q, at.weight6(), links.fluid).k * cu;
    L::scatter(data, slot, after);
    const auto counted = L::below(count - l);
    constexpr T scale = T(1 / mass_quantum);
    mass.add(counted ? V(after * scale) : V{});
    mass.subtract(counted ? V(before * scale) : V{});
  }
  fetch.finish(l);
  sums.mass += mass.total(0);
}

template <class T>
void apply_group(const GroupInBlock<T>& here, const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  ListedLinks own;
  LinkFetch<T> fetch(here, Wanted::all, here.listed ? *here.listed : own);
  with_scheme(here.group.scheme, [&](auto scheme) { apply<scheme()>(here, motion, form, sums, fetch); });
}

template <class T>
void correct_group(const GroupInBlock<T>& here, const SurfaceMotion& increment, LinkSums& sums) {
  ListedLinks own;
  LinkFetch<T> fetch(here, Wanted::returned, here.listed ? *here.listed : own);
  with_scheme(here.group.scheme, [&](auto scheme) { correct<scheme()>(here, increment, sums, fetch); });
}

}  // namespace

template <class T>
LinkKernels<T> link_kernels() {
  return {apply_group<T>, correct_group<T>};
}
template LinkKernels<float> link_kernels();
template LinkKernels<double> link_kernels();

}  // namespace silt::lbm::SILT_ISA
