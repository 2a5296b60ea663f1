#include "coupler/mapping/device_mapping.hpp"

namespace silt::coupler {

template <class T>
SurfaceAtTime DeviceMeasure<T>::listed(const SurfaceView<T>& surface, const lbm::SurfaceFrame& frame) {
  const SurfaceAtTime at{std::uint32_t(parts_.size()), std::uint32_t(planes_.size()), surface.count, frame};
  parts_.insert(parts_.end(), surface.parts, surface.parts + surface.count);
  for (const SurfacePart<T>* part = surface.parts; part < surface.parts + surface.count; ++part)
    if (const std::size_t end = at.first_plane + part->first_plane + part->planes; end > planes_.size()) {
      const Plane<T>* const from = surface.planes + (planes_.size() - at.first_plane);
      planes_.insert(planes_.end(), from, surface.planes + (end - at.first_plane));
    }
  return at;
}

template <class T>
void DeviceMeasure<T>::add(SurfaceLinks<T>& surface, const SurfaceView<T>& view, T arm) {
  lbm::CutLinks<T>& links = surface.links;
  for (const lbm::LinkGroup& g : links.groups)
    groups_.push_back({std::uint32_t(surfaces_.size()), g.count, g.scheme, g.crossing, g.corner,
                       links.place.data() + g.begin, links.q.data() + g.begin, nullptr});
  const SurfaceAtTime now = listed(view, links.frame);
  surfaces_.push_back({links.fluid, now, now, 0, arm, {}});
  wanted_.push_back(&surface);
}

template <class T>
void DeviceMeasure<T>::add_rates(const SurfaceView<T>& view, const lbm::SurfaceFrame& frame, double steps) {
  lbm::CutLinks<T>& links = wanted_.back()->links;
  links.rate.assign(links.q.size(), T(0));
  surfaces_.back().last = listed(view, frame), surfaces_.back().steps = steps;
  const std::size_t first = groups_.size() - links.groups.size();
  for (std::size_t g = 0; g < links.groups.size(); ++g)
    groups_[first + g].rate = links.rate.data() + links.groups[g].begin;
}

template <class T>
void DeviceMeasure<T>::run() {
  SILT_ON(device_, measure_links<T>)
  (groups_.size(), {groups_.data(), surfaces_.data(), parts_.data(), planes_.data()});
  to_device(groups_, surfaces_, parts_, planes_);
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    if (surfaces_[k].arm == 0) continue;
    wanted_[k]->stiffness = surfaces_[k].stiffness;
    from_device(surfaces_[k].stiffness);
  }
}

template class DeviceMeasure<float>;
template class DeviceMeasure<double>;

}  // namespace silt::coupler
