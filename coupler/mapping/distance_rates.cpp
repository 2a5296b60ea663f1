#include "coupler/mapping/distance_rates.hpp"

#include <algorithm>

#include "coupler/mapping/surface_kernels.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

namespace {

/// Of a distance in half of the steps: a line that grazes the surface may meet it at one time only.
template <class T>
constexpr T most_change = T(0.25);

/// Turns distances so many steps after the middle into rates. Where a surface comes past a cell, q < 0, wall
/// formulas amplify: for a few steps they may.
template <class T>
void change_a_step(const T* middle, int links, double steps, T* last) {
  constexpr double few = 4;
  const T least = steps > few ? T(0) : T(-0.1), per_step = T(1 / steps);
  for (int l = 0; l < links; ++l) {
    const T most = std::min(most_change<T>, middle[l] - least);
    last[l] = std::clamp(last[l] - middle[l], -most, most) * per_step;
  }
}

}  // namespace

template <class T>
void set_distance_rates(lbm::CutLinks<T>& links, const rigid::Shape& shape, const MappedMotion& mapped,
                        SurfaceParts<T>& surface) {
  links.rate.clear();
  const double steps = static_cast<double>(mapped.end - 1) - mapped.middle();
  if (mapped.is_at_rest() || links.q.empty() || !(steps > 0)) return;
  surface.reset(shape, mapped.pose_after(steps).orientation);
  lbm::SurfaceFrame frame = links.frame;
  for (int d = 0; d < 3; ++d) frame.offset[d] -= steps * mapped.velocity[d];
  links.rate.assign(links.q.size(), T(0));
  for (const lbm::LinkGroup& group : links.groups) {
    if (group.crossing) continue;
    const int padded = int(lbm::padded(group.count));
    T* const last = links.rate.data() + group.begin;
    distance_kernel<T, T>()(links.place.data() + group.begin, padded, frame, group.corner, surface.view(),
                            most_change<T>, last);
    change_a_step(links.q.data() + group.begin, padded, steps, last);
  }
}

template void set_distance_rates(lbm::CutLinks<float>&, const rigid::Shape&, const MappedMotion&,
                                 SurfaceParts<float>&);
template void set_distance_rates(lbm::CutLinks<double>&, const rigid::Shape&, const MappedMotion&,
                                 SurfaceParts<double>&);

}  // namespace silt::coupler
