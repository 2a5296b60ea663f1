#include "coupler/mapping/crossing_links.hpp"

#include <algorithm>
#include <bit>

#include "coupler/mapping/bit_kernel.hpp"
#include "coupler/mapping/surface_distance.hpp"

namespace silt::coupler {

using lbm::Int3;

template <class T>
void CrossingLinks<T>::find_cells(const BlockMap& map, const BodyMask& mask) {
  frame_ = mask.frame();
  const Int3 n = map.box.size;
  block_ = {{}, n};
  for (BitWindow* window : {&fluid_, &own_, &others_, &beside_others_, &near_}) window->reset(frame_);
  fill_rows(fluid_, n, 1,
            [&](int x, int y, int z) { return ~map.solid.from(x, y, z) & cells_between(x, -1, n.x + 1); });
  fill_rows(own_, n, 0, [&](int x, int, int) { return cells_between(x, 0, n.x); });
  fill_rows(others_, n, CellBits::ghosts, [&](int x, int y, int z) { return map.solid.from(x, y, z); });
  for (std::size_t k = 0; k < frame_.words(); ++k) others_.words()[k] &= ~mask.bits.words()[k];
  bit_kernels().widen(frame_, others_.words(), beside_others_.words());
  bit_kernels().widen(frame_, mask.bits.words(), near_.words());
  for (std::size_t k = 0; k < frame_.words(); ++k)
    near_.words()[k] &= fluid_.words()[k] & ~beside_others_.words()[k];
}

/// Lists links between cells near the surface, in whole vectors; returns their number.
template <class T>
std::uint32_t CrossingLinks<T>::list_candidates(int z) {
  const int count = std::min(planes, frame_.size.z - 1 - z);
  std::size_t cells = 0;
  for (std::size_t k = std::size_t(z) * frame_.plane; k < std::size_t(z + count) * frame_.plane; ++k)
    cells += std::popcount(near_.words()[k]);
  if (cells == 0) return 0;
  found_.resize(cells * lbm::D3Q19::pairs + lbm::link_lanes);
  const std::uint32_t found = bit_kernels().list_crossings(frame_, {z, count, 1, frame_.size.y - 1},
                                                           near_.words(), own_.words(), found_.data());
  found_.resize(found);
  if (found > 0) found_.resize(lbm::padded(found), found_.back());
  for (std::uint32_t& place : found_) place += lbm::link_place({0, 0, 1}, 0);
  return found;
}

template <class T>
void CrossingLinks<T>::list(int z, const lbm::SurfaceFrame& frame, const rigid::SurfaceView<T>& surface) {
  const Int3 corner = frame_.low + Int3{0, 0, z - 1};
  place_.clear(), q_.clear();
  const std::uint32_t candidates = list_candidates(z);
  begin_.resize(candidates), end_.resize(candidates);
  const std::uint32_t found = SILT_CHOSEN(keep_crossings<T>)()(found_.data(), candidates, corner, frame,
                                                               surface, begin_.data(), end_.data());
  const auto inside = [&](std::uint32_t place) { return block_.contains(corner + lbm::place_cell(place)); };
  for (const bool both : {true, false})
    for (std::uint32_t k = 0; k < found; ++k) {
      const int i = lbm::place_direction(found_[k]);
      const std::uint32_t end =
          lbm::link_place(lbm::place_cell(found_[k]) + lbm::D3Q19::c[i], lbm::opposite(i));
      const bool begins = inside(found_[k]), ends = inside(end);
      if ((begins && ends) != both) continue;
      if (begins) place_.push_back(found_[k]), q_.push_back(begin_[k]);
      if (ends) place_.push_back(end), q_.push_back(end_[k]);
    }
}

template class CrossingLinks<float>;
template class CrossingLinks<double>;

}  // namespace silt::coupler
