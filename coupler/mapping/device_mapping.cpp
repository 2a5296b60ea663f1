#include "coupler/mapping/device_mapping.hpp"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include "coupler/mapping/solid_map.hpp"
#include "lbm/passes/passes.hpp"
#include "rigid/shapes/surface_parts.hpp"

namespace silt::coupler {

template <class T>
void DeviceMapping<T>::add_words(std::uint64_t* to, const std::uint64_t* now, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k)
    if (now[k]) words_.host().push_back({to + k, now[k]});
}

/// Ends the flips of a surface, or of solid cells.
template <class T>
void DeviceMapping<T>::end_flips(std::uint32_t surface) {
  const FlippedBits last = flipped_.size() == 0 ? FlippedBits{} : flipped_.host().back();
  const std::uint32_t first = last.first + last.count, count = std::uint32_t(flips_.size()) - first;
  if (count > 0) flipped_.host().push_back({surface, first, count});
}

namespace {

/// Adds the indices of set bits, from `bit` on.
void add_bits(std::uint64_t bits, std::size_t bit, std::pmr::vector<std::uint32_t>& to) {
  for (; bits; bits &= bits - 1) to.push_back(std::uint32_t(bit) + std::uint32_t(std::countr_zero(bits)));
}

void flip_cells(const BitWindow& cells, CellBits& solid) {
  const BitFrame& f = cells.frame();
  for (int z = f.low.z; z < f.low.z + f.size.z; ++z)
    for (int y = f.low.y; y < f.low.y + f.size.y; ++y)
      for (int x = 0; x < f.pitch; x += 64)
        if (const std::uint64_t row = cells.row(x, y, z)) solid.flip(f.low.x + x, y, z, row);
}

}  // namespace

template <class T>
void DeviceMapping<T>::begin(const BlockMap& map, lbm::WallScheme scheme) {
  if (!has_links()) return;
  map_ = &map;
  clear();
  const std::size_t words = map.solid.all().size();
  tells_all_ = solid_.size() != words, tells_some_ = tells_all_;
  if (tells_all_) solid_.resize(words), changed_ = map.walls;
  cells_.scheme = scheme;
  cells_.solid = {solid_.data(), map.box.size, map.solid.words()};
}

template <class T>
void DeviceMapping<T>::tell_shape(SurfaceLinks<T>& surface, const rigid::SurfaceParts<T>& parts,
                                  const rigid::SurfaceParts<double>& exact) {
  auto& copy = surface.device;
  const rigid::ShapeView<T> of = parts.shape();
  const rigid::ShapePart& last = of.parts[of.count - 1];
  const std::size_t planes = last.first_plane + last.planes;
  copy.parts.resize(std::size_t(of.count)), copy.planes.resize(planes), copy.exact_planes.resize(planes);
  copy.has_edges = parts.has_edges();
  upload(std::span(of.parts, copy.parts.size()), copy.parts.data());
  upload(std::span(of.planes, planes), copy.planes.data());
  upload(std::span(exact.shape().planes, planes), copy.exact_planes.data());
  tell_shape(surface, {{copy.parts.data(), of.count, copy.planes.data()}, copy.exact_planes.data()});
}

template <class T>
void DeviceMapping<T>::tell_shape(SurfaceLinks<T>& surface, const typename MappedSurface<T>::Shape& shape) {
  surface.device.record.resize(1);
  upload(std::span(&shape, 1), &surface.device.record.data()->shape);
}

template <class T>
SurfaceToMap<T>& DeviceMapping<T>::add(SurfaceLinks<T>& surface, const BodyMask& mask, Marking marking,
                                       const rigid::Turn& turn) {
  const auto number = std::uint32_t(surfaces_.size());
  const BitFrame& frame = mask.frame();
  DeviceArray<std::uint64_t>& cells = surface.device.cells;
  if (surface.device.record.empty()) tell_shape(surface, {});  // a mesh
  const CellsOnDevice before(cells.empty() ? nullptr : cells.data());
  if (cells.capacity() < CellsOnDevice::size(frame)) {
    left_.push_back(std::move(cells));
    cells = DeviceArray<std::uint64_t>(CellsOnDevice::size(frame), memory_of(device_));
  }
  cells.resize(CellsOnDevice::size(frame));
  const CellsOnDevice now(cells.data());
  const auto first_slab = std::uint32_t(slabs_.size());
  for (int z = 1; z < frame.size.z - 1; z += SlabToMap::most_planes)
    slabs_.host().push_back(
        {number, std::int16_t(z), std::int16_t(std::min(SlabToMap::most_planes, frame.size.z - 1 - z))});
  if (marking == Marking::told) {
    add_words(now.words(), mask.bits.words(), frame.words());
  } else {  // cells that walls or lower ids have
    for (std::size_t k = 0; k < frame.words(); ++k)
      add_bits(mask.inside.words()[k] ^ mask.bits.words()[k], 64 * k, flips_.host());
    end_flips(number);
  }
  SurfaceToMap<T> to{};
  to.surface = surface.device.record.data();
  to.frame = frame, to.cells = now, to.before = before;
  to.centre = centre_in(*map_, mask), to.marking = marking;
  to.now = to.last = turned(surface, turn);
  to.first_slab = first_slab, to.slabs = std::uint32_t(slabs_.size()) - first_slab;
  constexpr int most = EdgeSlab::most_planes;
  const bool crosses = surface.device.has_edges && lbm::follows_distance(cells_.scheme);
  for (int z = 1; crosses && z < frame.size.z - 1; z += most) {
    const SlabToMap planes{number, std::int16_t(z), std::int16_t(std::min(most, frame.size.z - 1 - z))};
    edge_slabs_.host().push_back({planes, near_count_});
    near_count_ += std::uint32_t(planes.planes * frame.size.y * near_words(frame));
  }
  surfaces_.host().push_back(to);
  return surfaces_.host().back();
}

/// Lists an orientation unless it is the last one, as of bodies that have not turned.
template <class T>
TurnedSurface DeviceMapping<T>::turned(const SurfaceLinks<T>& surface, const rigid::Turn& turn) {
  std::pmr::vector<rigid::Turn>& all = turns_.host();
  const auto parts = std::uint32_t(surface.device.parts.size());
  if (all.empty() || (parts > 0 && !(all.back() == turn))) all.push_back(turn);
  const TurnedSurface found{std::uint32_t(all.size() - 1), part_count_};
  part_count_ += parts;
  return found;
}

template <class T>
void DeviceMapping<T>::change(SurfaceLinks<T>& surface, const BodyMask* now, const BodyMask* before) {
  if (!has_links()) return;
  DeviceArray<std::uint64_t>& cells = surface.device.cells;
  if (!cells.empty()) {
    gone_.host().emplace_back(cells.data());
    left_.push_back(std::move(cells)), cells.clear();
    before = nullptr;
  }
  for (const BodyMask* mask : {now, before})
    if (mask && mask->any) flip_cells(mask->bits, changed_), tells_some_ = true;
}

template <class T>
void DeviceMapping<T>::count() {
  if (!has_links()) return;
  std::vector<std::uint64_t>& changed = changed_.all();
  if (tells_all_) {
    clear_in_turn(device_, solid_.data(), solid_.size() * sizeof solid_[0]);
    add_words(solid_.data(), changed.data(), changed.size());
  } else if (tells_some_) {
    for (std::size_t k = 0; k < changed.size(); ++k) add_bits(changed[k], 64 * k, flips_.host());
    end_flips(FlippedBits::no_surface);
  }
  if (tells_some_) std::ranges::fill(changed, 0);
  counts_.host().resize(slabs_.size()), crossings_.host().resize(edge_slabs_.size());
  renew(near_, near_count_), renew(turned_, part_count_);
  cells_.told = send_told();
  cells_.surfaces = {surfaces_.send(), surfaces_.size()}, cells_.gone = {gone_.send(), gone_.size()};
  cells_.words = {words_.send(), words_.size()}, cells_.flipped = {flipped_.send(), flipped_.size()};
  cells_.flips = flips_.send(), cells_.turns = turns_.send();
  cells_.slabs = {slabs_.send(), slabs_.size()}, cells_.counts = counts_.make_room();
  cells_.edge_slabs = {edge_slabs_.send(), edge_slabs_.size()}, cells_.crossings = crossings_.make_room();
  cells_.near = near_.data(), cells_.turned = turned_.data();
  SILT_OFF_CPU(device_, count_links<T>)(cells_);
  counts_.fetch(), crossings_.fetch();
  lbm::wait(device_);
  runs_.host().clear(), told_.host().clear();
}

template <class T>
void DeviceMapping<T>::list(SurfaceLinks<T>& surface, std::uint32_t n) {
  lbm::CutLinks<T>& links = surface.links;
  renew(links.rate, surfaces_.host()[n].steps > 0 ? links.q.size() : 0);
  listed_.host().push_back({n, group_count_});
  group_count_ += std::uint32_t(links.groups.size());
  wanted_.push_back(&surface);
  tell(surface, std::nullopt);
}

/// Sends the record of the links if arrays have moved; the device sets the frame, the number of groups and
/// the time of links that it lists itself.
template <class T>
void DeviceMapping<T>::tell(SurfaceLinks<T>& surface, std::optional<double> measured) {
  auto& copy = surface.device;
  copy.record.resize(1);
  lbm::DeviceSurface<T> now = lbm::device_surface(surface.links, copy.groups.data(), measured.value_or(0));
  if (!measured) now.frame = {}, now.group_count = 0;
  if (now == copy.told) return;
  copy.told = now;
  upload(std::span<const lbm::DeviceSurface<T>>(&now, 1), &copy.record.data()->links);
}

template <class T>
void DeviceMapping<T>::run() {
  if (!has_links()) return;
  resistance_.host().resize(listed_.size());
  renew(lists_, slabs_.size()), renew(groups_, group_count_);
  renew(edge_places_, edge_slabs_.size());
  SILT_OFF_CPU(device_, map_links<T>)
  ({cells_,
    send_told(),
    lists_.data(),
    lbm::PlacesAcross<lbm::D3Q19>(map_->box.size),
    {listed_.send(), listed_.size()},
    groups_,
    resistance_.clear(),
    edge_places_.data()});
  resistance_.fetch();
  lbm::wait(device_);
  for (std::size_t k = 0; k < wanted_.size(); ++k)
    if (surfaces_.host()[listed_.host()[k].surface].arm != 0) wanted_[k]->resistance = resistance_.host()[k];
}

template class DeviceMapping<float>;
template class DeviceMapping<double>;

}  // namespace silt::coupler
