#include "lbm/walls/device_links.hpp"

#include <algorithm>
#include <bit>

#include "lbm/passes/passes.hpp"

namespace silt::lbm {

template <class T>
void LinksInGaps<T>::list(std::span<const GroupOfSurface> groups, const LinkPass<T>& pass) {
  lines_.clear(), lines_.resize(empty() ? 0 : std::bit_ceil(2 * most_));
  if (empty()) return;
  clear_in_turn(device_, lines_.data(), lines_.size() * sizeof lines_[0]);
  renew(opposites_, most_);
  clear_in_turn(device_, opposites_.data(), opposites_.size() * sizeof opposites_[0]);
  count_.host().resize(1);
  const LinesInGaps table{lines_.data(), int(std::bit_width(lines_.size())) - 1};
  const LinkPasses<T>& passes = SILT_ON(device_, link_passes<T>)();
  passes.pair_gaps(groups, pass, table);
  passes.list_opposites(groups, pass, table, {opposites_.data(), count_.clear()});
}

template <class T>
void LinksInGaps<T>::set_opposites(const LinkPass<T>& pass, const Domain& domain, Int3 lower) const {
  if (empty()) return;
  SILT_ON(device_, link_passes<T>)().set_opposites(pass, {opposites_, domain.sides(), domain.cells(), lower});
}

template <class T>
void DeviceLinks<T>::clear() {
  surfaces_.host().clear(), motions_.host().clear();
  group_count_ = 0, gaps_.clear(), is_listed_ = has_crossings_ = false;
}

template <class T>
void DeviceLinks<T>::add(const DeviceSurface<T>* surface, const CutLinks<T>& links, bool same_body) {
  constexpr std::uint32_t no_body = ListedSurface<T>::no_body;
  if (!same_body) body_ = no_body;
  if (body_ == no_body && !links.groups.empty())
    body_ = std::uint32_t(motions_.size()), motions_.host().emplace_back();
  surfaces_.host().push_back({surface, group_count_, links.groups.empty() ? no_body : body_});
  group_count_ += std::uint32_t(links.groups.size()), gaps_.add(links.opposite_q.size());
  for (const LinkGroup& group : links.groups) has_crossings_ |= group.crossing;
}

template <class T>
const LinkPasses<T>& DeviceLinks<T>::passes() const {
  return SILT_ON(device_, link_passes<T>)();
}

template <class T>
LinkPass<T> DeviceLinks<T>::pass() {
  LinkPass<T> pass{};
  pass.slots = slots_.device() + slots_in_use_;
  pass.surfaces = surfaces_.device(), pass.motions = motions_.device();
  pass.time = time_;
  return pass;
}

template <class T>
LinkPass<T> DeviceLinks<T>::pass_over(Block<T>& block) {
  LinkPass<T> over = pass();
  over.data = block.data() + block.middle(), over.excess = block.excess();
  over.row = std::int32_t(block.row_stride()), over.plane = std::int32_t(block.plane_stride());
  over.increments = {increments_.device(), increments_.size()};
  over.sums = sums_.device();
  return over;
}

/// Lists the groups of all surfaces, and the lines in gaps, if surfaces have changed.
template <class T>
void DeviceLinks<T>::list_groups() {
  if (is_listed_) return;
  is_listed_ = true;
  surfaces_.send();
  renew(groups_, group_count_);
  passes().list_groups({surfaces_.device(), surfaces_.size()}, groups_.data());
  gaps_.list(groups_, pass());
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
void DeviceLinks<T>::begin_step(double time, const LinkSlots& slots, const Domain& domain, Int3 lower) {
  time_ = time;
  if (device_ == Device::cpu ? gaps_.empty() : size() == 0) return;
  motions_.send(), take_slots(slots);
  list_groups();
  gaps_.set_opposites(pass(), domain, lower);
}

template <class T>
void DeviceLinks<T>::apply(Block<T>& block, const WallFluid<T>& fluid, const BeyondPair<T>* pairs_across,
                           ForceForm form) {
  if (size() == 0) return;
  sums_.host().resize(bodies());
  sums_.clear();
  LinkPass<T> pass = pass_over(block);
  pass.fluid = fluid, pass.pairs_across = pairs_across;
  pass.galilean = form == ForceForm::galilean;
  passes().apply(groups_, pass);
  // last, since other links read what crossing links write
  if (has_crossings_) passes().apply_crossing(groups_, pass);
  sums_.fetch();
  wait(device_);
}

template <class T>
void DeviceLinks<T>::correct(Block<T>& block, std::span<const SurfaceIncrement> increments) {
  if (increments.empty()) return;
  increments_.host().assign(increments.begin(), increments.end()), increments_.send();
  passes().correct(groups_, pass_over(block));
  wait(device_);
}

template class DeviceLinks<float>;
template class DeviceLinks<double>;

}  // namespace silt::lbm
