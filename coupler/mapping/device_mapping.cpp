#include "coupler/mapping/device_mapping.hpp"

#include "coupler/mapping/solid_map.hpp"
#include "lbm/passes/passes.hpp"

namespace silt::coupler {

/// Adds the words that changed since the device received `before`, or all words if it is null.
template <class T>
void DeviceMapping<T>::add_words(std::uint64_t* to, const std::uint64_t* now, const std::uint64_t* before,
                                 std::size_t count) {
  for (std::size_t k = 0; k < count; ++k)
    if (!before || now[k] != before[k]) words_.host().push_back({to + k, now[k]});
}

template <class T>
void DeviceMapping<T>::begin(const BlockMap& map, lbm::WallScheme scheme) {
  if (!has_links()) return;
  map_ = &map, scheme_ = scheme;
  wanted_.clear(), groups_.host().clear(), surfaces_.host().clear(), parts_.host().clear();
  planes_.host().clear(), words_.host().clear(), runs_.host().clear(), told_.host().clear();
  const std::vector<std::uint64_t>& now = map.solid.all();
  const bool is_new = solid_.size() != now.size();
  if (is_new) solid_.resize(now.size());
  add_words(solid_.data(), now.data(), is_new ? nullptr : map.before.all().data(), now.size());
}

template <class T>
SurfaceAtTime DeviceMapping<T>::listed(const rigid::SurfaceView<T>& surface, const lbm::SurfaceFrame& frame) {
  const SurfaceAtTime at{std::uint32_t(parts_.size()), std::uint32_t(planes_.size()), surface.count, frame};
  parts_.host().insert(parts_.host().end(), surface.parts, surface.parts + surface.count);
  for (const rigid::SurfacePart<T>* part = surface.parts; part < surface.parts + surface.count; ++part)
    if (const std::size_t end = at.first_plane + part->first_plane + part->planes; end > planes_.size()) {
      const rigid::Plane<T>* const from = surface.planes + (planes_.size() - at.first_plane);
      planes_.host().insert(planes_.host().end(), from, surface.planes + (end - at.first_plane));
    }
  return at;
}

template <class T>
void DeviceMapping<T>::add(SurfaceLinks<T>& surface, const BodyMask& mask, const BodyMask* before,
                           std::span<const ListedGroup> by_cells, const rigid::SurfaceView<T>& view, T arm) {
  const BitFrame& frame = mask.frame();
  const std::size_t words = frame.words();
  DeviceArray<std::uint64_t>& cells = surface.device.cells;
  const bool is_known = before && before->frame() == frame && cells.size() == words + 1;
  if (!is_known) cells.clear();
  cells.resize(words + 1);  // the word after the last may be read
  add_words(cells.data(), mask.bits.words(), is_known ? before->bits.words() : nullptr, words);
  lbm::CutLinks<T>& links = surface.links;
  for (std::uint32_t k = 0; k < links.groups.size(); ++k) {
    const lbm::LinkGroup& g = links.groups[k];
    ListedGroup listed{};
    if (!by_cells.empty() && by_cells.front().number == k)
      listed = by_cells.front(), by_cells = by_cells.subspan(1);
    groups_.host().push_back(
        {std::uint32_t(surfaces_.size()), g.begin, g.count, g.corner, g.scheme, g.crossing, listed});
  }
  const SurfaceAtTime now = this->listed(view, links.frame);
  surfaces_.host().push_back(
      {links.fluid, now, now, 0, arm, frame, cells.data(), links.place.data(), links.q.data(), nullptr});
  wanted_.push_back(&surface);
}

template <class T>
void DeviceMapping<T>::add_rates(const rigid::SurfaceView<T>& view, const lbm::SurfaceFrame& frame,
                                 double steps) {
  lbm::CutLinks<T>& links = wanted_.back()->links;
  links.rate.resize(links.q.size());
  SurfaceToMap<T>& surface = surfaces_.host().back();
  surface.last = listed(view, frame), surface.steps = steps, surface.rate = links.rate.data();
}

template <class T>
void DeviceMapping<T>::run() {
  if (!has_links()) return;
  resistance_.host().resize(surfaces_.size());
  const LinksToMap<T> pass{groups_.send(), groups_.size(),      surfaces_.send(), resistance_.clear(),
                           parts_.send(),  planes_.send(),      words_.send(),    words_.size(),
                           runs_.send(),   runs_.size(),        told_.send(),     solid_.data(),
                           map_->box.size, map_->solid.words(), scheme_};
  SILT_OFF_CPU(device_, map_links<T>)(pass);
  resistance_.fetch();
  lbm::wait(device_);
  for (std::size_t k = 0; k < wanted_.size(); ++k)
    if (surfaces_.host()[k].arm != 0) wanted_[k]->resistance = resistance_.host()[k];
}

template class DeviceMapping<float>;
template class DeviceMapping<double>;

}  // namespace silt::coupler
