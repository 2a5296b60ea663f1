#include "lbm/walls/device_links.hpp"

#include <algorithm>

#include "lbm/passes/passes.hpp"

namespace silt::lbm {

template <class T>
void DeviceLinks<T>::clear() {
  surfaces_.host().clear(), steps_.host().clear();
  gaps_.host().clear(), walls_.host().clear(), side_velocities_.host().clear();
  group_count_ = 0, is_listed_ = has_crossings_ = false;
}

template <class T>
void DeviceLinks<T>::add(const DeviceSurface<T>* surface, std::span<const LinkGroup> groups, bool same_body) {
  if (!same_body) steps_.host().emplace_back();
  surfaces_.host().push_back({surface, group_count_, std::uint32_t(steps_.size() - 1)});
  group_count_ += std::uint32_t(groups.size());
  for (const LinkGroup& group : groups) has_crossings_ |= group.crossing;
}

template <class T>
void DeviceLinks<T>::add(const OppositeLink<T>& link) {
  std::uint32_t number = link.number;
  if (link.other < 0) {
    std::pmr::vector<T>& all = side_velocities_.host();
    const auto found = std::find(all.begin(), all.end(), link.side_velocity);
    number = std::uint32_t(found - all.begin());
    if (found == all.end()) all.push_back(link.side_velocity);
  }
  walls_.host().push_back({link.other, number, link.at_side});
}

template <class T>
const LinkPasses<T>& DeviceLinks<T>::passes() const {
  return SILT_OFF_CPU(device_, link_passes<T>)();
}

template <class T>
LinkPass<T> DeviceLinks<T>::pass_over(Block<T>& block) {
  return {block.data() + block.middle(),
          std::int32_t(block.row_stride()),
          std::int32_t(block.plane_stride()),
          block.excess(),
          slots_.device() + slots_in_use_,
          {},
          surfaces_.device(),
          steps_.device(),
          increments_.device(),
          sums_.device(),
          nullptr,
          false};
}

/// Lists the groups of all surfaces, and sends the walls behind links, if either has changed.
template <class T>
void DeviceLinks<T>::list_groups() {
  if (is_listed_) return;
  is_listed_ = true;
  gaps_.send(), walls_.send(), side_velocities_.send(), surfaces_.send();
  groups_.clear(), groups_.resize(group_count_);
  passes().list_groups({surfaces_.device(), surfaces_.size()}, groups_.data());
}

/// Sends the slots unless the device has them from an earlier step.
template <class T>
void DeviceLinks<T>::take_slots(const LinkSlots& slots) {
  std::pmr::vector<LinkSlots>& known = slots_.host();
  slots_in_use_ = std::size_t(std::ranges::find(known, slots) - known.begin());
  if (slots_in_use_ < known.size()) return;
  if (known.size() == 2) known.clear(), slots_in_use_ = 0;
  known.push_back(slots), slots_.send();
}

template <class T>
void DeviceLinks<T>::apply(Block<T>& block, const WallFluid<T>& fluid, const LinkSlots& slots,
                           const BeyondPair<T>* pairs_across, ForceForm form) {
  if (size() == 0) return;
  sums_.host().resize(bodies());
  sums_.clear(), steps_.send(), take_slots(slots);
  list_groups();
  LinkPass<T> pass = pass_over(block);
  pass.fluid = fluid, pass.pairs_across = pairs_across;
  pass.galilean = form == ForceForm::galilean;
  passes().set_opposites({gaps_.device(), gaps_.size(), walls_.device(), side_velocities_.device()}, pass);
  passes().apply(groups_, pass);
  // last, since other links read what crossing links write
  if (has_crossings_) passes().apply_crossing(groups_, pass);
  sums_.fetch();
  wait(device_);
}

template <class T>
void DeviceLinks<T>::correct(Block<T>& block, std::span<const SurfaceIncrement> increments) {
  if (std::ranges::all_of(increments, [](const SurfaceIncrement& i) { return i == SurfaceIncrement{}; }))
    return;
  increments_.host().assign(increments.begin(), increments.end()), increments_.send();
  passes().correct(groups_, pass_over(block));
  wait(device_);
}

template class DeviceLinks<float>;
template class DeviceLinks<double>;

}  // namespace silt::lbm
