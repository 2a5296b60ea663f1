// The passes of device_mapping.hpp and refill_cell.hpp, for the one file of each device that includes this
// (SILT_ISA, SILT_SCALAR).
#include <algorithm>
#include <type_traits>

#include "coupler/mapping/device_mapping.hpp"
#include "coupler/mapping/refill_cell.hpp"
#include "coupler/mapping/surface_distance.hpp"
#include "device/for_each.hpp"
#include "lbm/link_stiffness.hpp"

namespace silt::coupler::SILT_ISA {

template <class T>
SILT_DEVICE T distance_of(const std::uint32_t* place, const lbm::SILT_ISA::PlaceOrigin<T>& origin,
                          const SurfaceView<T>& surface, T past) {
  const lbm::SILT_ISA::Places<T> at(place, origin);
  if (surface.count > 1) return distance_to_any(at, surface, past);
  T found{};
  with_kind(surface.parts[0].kind, [&](auto kind) { found = distance_to_part<kind()>(at, surface, past); });
  return found;
}

template <class T>
struct MeasureGroup {
  MeasureLinks<T> all;

  SILT_DEVICE SurfaceView<T> view(const SurfaceAtTime& at) const {
    return {all.parts + at.first_part, at.parts, all.planes + at.first_plane};
  }
  SILT_DEVICE lbm::SILT_ISA::PlaceOrigin<T> origin(const GroupToMeasure<T>& group,
                                                   const SurfaceAtTime& at) const {
    return {group.corner, at.frame, all.directions.packed};
  }
  SILT_DEVICE void operator()(std::int64_t k, const Team& member) const {
    const GroupToMeasure<T>& group = all.groups[k];
    SurfaceToMeasure<T>& surface = all.surfaces[group.surface];
    if (!group.crossing) measure(group, surface, member);
    if (surface.arm != 0)
      lbm::with_scheme(group.scheme,
                       [&](auto scheme) { add_stiffness_of<scheme()>(group, surface, member); });
  }
  SILT_DEVICE void measure(const GroupToMeasure<T>& group, const SurfaceToMeasure<T>& surface,
                           const Team& member) const {
    for (int l = member.lane; l < int(group.count); l += member.size) {
      const T q = distance_of(group.place + l, origin(group, surface.now), view(surface.now), T(0));
      group.q[l] = q;
      if (surface.steps == 0) continue;
      const T last =
          distance_of(group.place + l, origin(group, surface.last), view(surface.last), T(most_change));
      group.rate[l] = rate_of(q, last, surface.steps);
    }
  }
  template <lbm::WallScheme scheme>
  SILT_DEVICE void add_stiffness_of(const GroupToMeasure<T>& group, SurfaceToMeasure<T>& surface,
                                    const Team& member) const {
    using Term = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;
    constexpr int entries = 21;
    std::int64_t h[entries] = {};
    for (int l = member.lane; l < int(group.count); l += member.size) {
      const lbm::SILT_ISA::Places<T> at(group.place + l, origin(group, surface.now));
      lbm::SILT_ISA::add_stiffness<scheme>(at, group.q[l], true, surface.fluid, surface.arm,
                                           [&](int e, T term) { h[e] += Term(term); });
    }
    for (int e = 0; e < entries; ++e) member.add(h[e], surface.stiffness.h[e]);
  }
};

template <class T>
void measure_links(std::size_t groups, const MeasureLinks<T>& all) {
  for_teams(std::int64_t(groups), MeasureGroup<T>{all});
  wait();
}

template <class T>
void refill_cells(const RefillCells<T>& cells) {
  for_each(cells.listed.count, cells);
  wait();
}

template void refill_cells(const RefillCells<float>&);
template void refill_cells(const RefillCells<double>&);
template void measure_links(std::size_t, const MeasureLinks<float>&);
template void measure_links(std::size_t, const MeasureLinks<double>&);

}  // namespace silt::coupler::SILT_ISA
