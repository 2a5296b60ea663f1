// Built once an instruction set.
#include "coupler/line_lanes.hpp"
#include "lbm/link_places.hpp"

namespace silt::coupler::SILT_ISA {

namespace {

/// Where lines whose points at 0 are outside enter, within [0, 1]; 1 where they do not. A line that has a
/// convex part behind it, or leaves it just now, has the middle of its way through it behind.
template <class T>
auto first_inside(const IntervalLanes<T>& i) {
  using V = typename IntervalLanes<T>::V;
  const V t = (i.enter <= i.leave) & (i.enter + i.leave > T(0)) ? i.enter : V{} + T(1);
  return V(t < T(0) ? V{} : t > T(1) ? V{} + T(1) : t);
}

/// Where lines from the hollow of a tube leave it, within [0, 1].
template <class T>
auto last_inside(const IntervalLanes<T>& i) {
  using V = typename IntervalLanes<T>::V;
  return V(i.leave > T(0) ? i.leave > T(1) ? V{} + T(1) : i.leave : V{});
}

}  // namespace

/// Of each link, in units of it: to the first part of the surface that it enters.
template <class Real, class T>
void surface_distances(const std::uint32_t* place, int padded, const lbm::SurfaceFrame& frame,
                       lbm::Int3 corner, const SurfaceView<Real>& surface, T* q) {
  using L = lbm::SILT_ISA::Lanes<Real>;
  using V = typename L::Real;
  using Stored = typename lbm::SILT_ISA::VectorOf<T, L::count>::type;
  const lbm::SILT_ISA::PlaceOrigin<Real> origin(corner, frame);
  for (int l = 0; l < padded; l += L::count) {
    const lbm::SILT_ISA::Places<Real> at(place + l, origin);
    V nearest = V{} + Real(1);
    for (int k = 0; k < surface.count; ++k) {
      const SurfacePart<Real>& part = surface.parts[k];
      const LineLanes<Real> lines(part, at.r, at.c);
      if (surface.count > 1 && lines.all_beyond(part)) continue;
      const auto inside = lines.inside(part, surface.planes);
      const V found = part.kind == SurfacePart<Real>::Kind::hollow ? last_inside(inside) : first_inside(inside);
      nearest = IntervalLanes<Real>::smaller(found, nearest);
    }
    const Stored stored = __builtin_convertvector(nearest, Stored);
    __builtin_memcpy(q + l, &stored, sizeof stored);
  }
}

template void surface_distances(const std::uint32_t*, int, const lbm::SurfaceFrame&, lbm::Int3,
                                const SurfaceView<float>&, float*);
template void surface_distances(const std::uint32_t*, int, const lbm::SurfaceFrame&, lbm::Int3,
                                const SurfaceView<double>&, float*);
template void surface_distances(const std::uint32_t*, int, const lbm::SurfaceFrame&, lbm::Int3,
                                const SurfaceView<double>&, double*);

}  // namespace silt::coupler::SILT_ISA
