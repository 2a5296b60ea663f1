#include "lbm/device_links.hpp"

#include "lbm/device_passes.hpp"
#include "lbm/link_passes.hpp"

namespace silt::lbm {

template <class T>
void DeviceLinks<T>::clear() {
  groups_.clear(), crossing_.clear(), opposites_.clear(), surfaces_.clear();
}

template <class T>
void DeviceLinks<T>::add(const CutLinks<T>& links) {
  const auto part = [](const auto& values, std::uint32_t first) {
    return values.empty() ? nullptr : values.data() + first;
  };
  for (const LinkGroup& g : links.groups) {
    auto& groups = g.crossing ? crossing_ : groups_;
    groups.push_back({std::uint32_t(surfaces_.size()), g.count, g.scheme, g.corner,
                      part(links.place, g.begin), part(links.q, g.begin), part(links.rate, g.begin),
                      part(links.opposite_q, g.opposite), part(links.opposite_u, g.opposite),
                      g.across ? part(links.across, g.across_begin) : nullptr});
    to_device(groups.back());
  }
  surfaces_.push_back({links.fluid, links.frame, T(0), {}, 0, false, {}, 0});
  to_device(surfaces_.back(), links.opposite_q, links.opposite_u);
}

template <class T>
void DeviceLinks<T>::add_opposite(T& velocity, std::uint32_t other, Int3 cell, int direction) {
  opposites_.push_back({&velocity, other, cell, c[direction]});
  to_device(opposites_.back());
}

template <class T>
void DeviceLinks<T>::set_motion(std::size_t k, const SurfaceMotion& motion, T age) {
  DeviceSurface<T>& surface = surfaces_[k];
  surface.motion = motion, surface.age = age, surface.limit = largest_exchange(surface.frame, motion);
  surface.sums = {}, surface.beyond_range = 0, surface.open = false;
  to_device(motion, age, surface.limit, surface.sums, surface.beyond_range, surface.open);
}

template <class T>
void DeviceLinks<T>::set_increment(std::size_t k, const SurfaceMotion& increment) {
  surfaces_[k].motion = increment, surfaces_[k].open = true;
  to_device(increment, surfaces_[k].open);
}

template <class T>
LinkSums DeviceLinks<T>::sums(std::size_t k) const {
  LinkSums sums = surfaces_[k].sums;
  sums.invalid = surfaces_[k].beyond_range != 0;
  from_device(sums, surfaces_[k].beyond_range);
  return sums;
}

template <class T>
LinkPass<T> DeviceLinks<T>::pass_over(Block<T>& block, const LinkSlots& slots) {
  slots_[0] = slots;
  to_device(slots);
  return {block.data() + block.middle(),
          std::int32_t(block.row_stride()),
          std::int32_t(block.plane_stride()),
          slots_.data(),
          surfaces_.data(),
          nullptr,
          false};
}

template <class T>
void DeviceLinks<T>::apply(Block<T>& block, const LinkSlots& slots, const BeyondPair<T>* pairs_across,
                           ForceForm form) {
  LinkPass<T> pass = pass_over(block, slots);
  pass.pairs_across = pairs_across, pass.galilean = form == ForceForm::galilean;
  const LinkPasses<T>& passes = SILT_ON(device_, link_passes<T>)();
  passes.set_opposites(opposites_, surfaces_.data());
  passes.apply(groups_, pass);
  passes.apply_crossing(crossing_, pass);  // after all others, for these read what crossing links write
  wait(device_);
}

template <class T>
std::int64_t DeviceLinks<T>::correct(Block<T>& block, const LinkSlots& slots) {
  const LinkPass<T> pass = pass_over(block, slots);
  const auto mass = [&] {
    std::int64_t sum = 0;
    for (const DeviceSurface<T>& surface : surfaces_) sum += surface.sums.mass, from_device(sum);
    return sum;
  };
  const std::int64_t before = mass();
  const LinkPasses<T>& passes = SILT_ON(device_, link_passes<T>)();
  passes.correct(groups_, pass);
  passes.correct(crossing_, pass);
  wait(device_);
  return mass() - before;
}

template class DeviceLinks<float>;
template class DeviceLinks<double>;

}  // namespace silt::lbm
