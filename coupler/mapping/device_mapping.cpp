#include "coupler/mapping/device_mapping.hpp"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include "coupler/mapping/solid_map.hpp"
#include "lbm/passes/passes.hpp"

namespace silt::coupler {

template <class T>
void DeviceMapping<T>::add_words(std::uint64_t* to, const std::uint64_t* now, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) words_.host().push_back({to + k, now[k]});
}

/// Ends the flips of a mask, or of solid cells alone.
template <class T>
void DeviceMapping<T>::end_flips(std::uint32_t mask) {
  const FlippedBits last = flipped_.size() == 0 ? FlippedBits{} : flipped_.host().back();
  const std::uint32_t first = last.first + last.count, count = std::uint32_t(flips_.size()) - first;
  if (count > 0) flipped_.host().push_back({mask, first, count});
}

namespace {
/// Adds the indices of set bits, from `bit` on.
void add_bits(std::uint64_t bits, std::size_t bit, std::pmr::vector<std::uint32_t>& to) {
  for (; bits; bits &= bits - 1) to.push_back(std::uint32_t(bit) + std::uint32_t(std::countr_zero(bits)));
}

/// Adds the bits of a window that differ from those that the one before had in the same cells; flips these
/// cells in `solid`.
void add_flips(const BitWindow& now, const BitWindow& before, std::pmr::vector<std::uint32_t>& to,
               CellBits& solid) {
  const BitFrame &f = now.frame(), &b = before.frame();
  for (int z = f.low.z; z < f.low.z + f.size.z; ++z)
    for (int y = f.low.y; y < f.low.y + f.size.y; ++y)
      for (int x = 0; x < f.pitch; x += 64) {
        const std::uint64_t common = shared_cells(b, {f.low.x + x, y, z}) & f.row_bits();
        const std::uint64_t was = common ? before.from({f.low.x + x, y, z}) & common : 0;
        const std::uint64_t flipped = now.row(x, y, z) ^ was;
        if (!flipped) continue;
        add_bits(flipped, f.row(y, z) + std::size_t(x), to);
        solid.flip(f.low.x + x, y, z, flipped);
      }
}
}  // namespace

template <class T>
void DeviceMapping<T>::begin(const BlockMap& map, lbm::WallScheme scheme) {
  if (!has_links()) return;
  map_ = &map, scheme_ = scheme;
  wanted_.clear(), first_slab_.clear();
  clear();
  const std::vector<std::uint64_t>& now = map.solid.all();
  if (solid_.size() != now.size()) {
    solid_.resize(now.size());
    changed_ = CellBits(map.box.size);
    return add_words(solid_.data(), now.data(), now.size());
  }
  for (std::size_t k = 0; k < now.size(); ++k) changed_.all()[k] = now[k] ^ map.before.all()[k];
}

template <class T>
void DeviceMapping<T>::add_mask(SurfaceLinks<T>& surface, const BodyMask& mask, const BodyMask* before) {
  const BitFrame& frame = mask.frame();
  const std::size_t words = frame.words();
  DeviceArray<std::uint64_t>& cells = surface.device.cells;
  const bool is_known = before && cells.size() == before->frame().words() + 1;
  if (!is_known || !(before->frame() == frame)) {
    left_.push_back(std::move(cells));
    cells = DeviceArray<std::uint64_t>(words + 1, memory_of(device_));  // the word after the last may be read
    if (is_known) moved_.host().push_back({before->frame(), frame, left_.back().data(), cells.data()});
  }
  if (is_known) {
    add_flips(mask.bits, before->bits, flips_.host(), changed_);
    end_flips(std::uint32_t(masks_.size()));
  } else {
    add_words(cells.data(), mask.bits.words(), words);
  }
  const auto number = std::uint32_t(masks_.size());
  first_slab_.push_back(std::uint32_t(slabs_.size()));
  masks_.host().push_back({frame, cells.data()});
  for (int z = 1; z < frame.size.z - 1; z += SlabToMap::most_planes)
    slabs_.host().push_back(
        {number, std::int16_t(z), std::int16_t(std::min(SlabToMap::most_planes, frame.size.z - 1 - z))});
}

template <class T>
void DeviceMapping<T>::count() {
  if (!has_links()) return;
  for (std::size_t k = 0; k < changed_.all().size(); ++k) add_bits(changed_.all()[k], 64 * k, flips_.host());
  end_flips(FlippedBits::solid_alone);
  first_slab_.push_back(std::uint32_t(slabs_.size()));
  counts_.host().resize(slabs_.size());
  bits_ = {words_.send(),       words_.size(), moved_.send(),  moved_.size(),       flipped_.send(),
           flipped_.size(),     flips_.send(), masks_.send(),  slabs_.send(),       slabs_.size(),
           counts_.make_room(), solid_.data(), map_->box.size, map_->solid.words(), scheme_};
  SILT_OFF_CPU(device_, count_links)(bits_);
  counts_.fetch();
  lbm::wait(device_);
}

/// Lists an orientation unless it is the last one, as of bodies that have not turned.
template <class T>
TurnedSurface DeviceMapping<T>::turned(const rigid::Turn& turn, int parts) {
  std::pmr::vector<rigid::Turn>& all = turns_.host();
  if (all.empty() || (parts > 0 && !(all.back() == turn))) all.push_back(turn);
  const TurnedSurface found{std::uint32_t(all.size() - 1), part_count_};
  part_count_ += std::uint32_t(parts);
  return found;
}

template <class T>
void DeviceMapping<T>::add(SurfaceLinks<T>& surface, std::size_t n, const rigid::ShapeView<T>& shape,
                           const rigid::Turn& turn, T arm) {
  const lbm::CutLinks<T>& links = surface.links;
  surface.device.record.resize(1);
  const TurnedSurface now = turned(turn, shape.count);
  surfaces_.host().push_back({surface.device.record.data(),
                              links.frame,
                              {},
                              0,
                              arm,
                              now,
                              now,
                              first_slab_[n],
                              first_slab_[n + 1] - first_slab_[n],
                              group_count_,
                              std::uint32_t(links.groups.size())});
  group_count_ += std::uint32_t(links.groups.size());
  wanted_.push_back(&surface);
}

template <class T>
void DeviceMapping<T>::add_rates(const rigid::Turn& turn, const lbm::SurfaceFrame& frame, double steps) {
  lbm::CutLinks<T>& links = wanted_.back()->links;
  links.rate.resize(links.q.size());
  SurfaceToMap<T>& surface = surfaces_.host().back();
  surface.last = turned(turn, int(part_count_ - surface.now.first_part)), surface.steps = steps;
  std::ranges::copy(frame.offset, surface.last_offset);
}

/// Sends the shape of a surface once, and its record if arrays have moved. The device sets the frame and the
/// number of groups of links that it lists itself.
template <class T>
void DeviceMapping<T>::tell(SurfaceLinks<T>& surface, const rigid::ShapeView<T>& shape, bool lists) {
  auto& copy = surface.device;
  copy.record.resize(1);
  if (lists && copy.parts.size() != std::size_t(shape.count)) {
    const rigid::ShapePart& last = shape.parts[shape.count - 1];
    copy.parts.resize(std::size_t(shape.count)), copy.planes.resize(last.first_plane + last.planes);
    upload(std::span(shape.parts, copy.parts.size()), copy.parts.data());
    upload(std::span(shape.planes, copy.planes.size()), copy.planes.data());
  }
  MappedSurface<T> now{lbm::device_surface(surface.links, copy.groups.data()),
                       {copy.parts.data(), shape.count, copy.planes.data()}};
  if (lists) now.links.frame = {}, now.links.group_count = 0;
  if (now == copy.told) return;
  copy.told = now;
  upload(std::span<const MappedSurface<T>>(&now, 1), copy.record.data());
}

template <class T>
void DeviceMapping<T>::run() {
  if (!has_links()) return;
  resistance_.host().resize(surfaces_.size());
  lists_.clear(), lists_.resize(slabs_.size());
  groups_.clear(), groups_.resize(group_count_);
  turned_.clear(), turned_.resize(part_count_);
  const LinksToMap<T> pass{bits_,
                           lists_.data(),
                           lbm::PlacesAcross<lbm::D3Q19>(map_->box.size),
                           groups_.data(),
                           groups_.size(),
                           surfaces_.send(),
                           surfaces_.size(),
                           resistance_.clear(),
                           turns_.send(),
                           turned_.data(),
                           runs_.send(),
                           runs_.size(),
                           told_.send()};
  SILT_OFF_CPU(device_, map_links<T>)(pass);
  resistance_.fetch();
  lbm::wait(device_);
  for (std::size_t k = 0; k < wanted_.size(); ++k)
    if (surfaces_.host()[k].arm != 0) wanted_[k]->resistance = resistance_.host()[k];
}

template class DeviceMapping<float>;
template class DeviceMapping<double>;

}  // namespace silt::coupler
