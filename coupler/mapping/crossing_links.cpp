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

template <class T>
void CrossingLinks<T>::list_candidates(int z) {
  const int count = std::min(planes, frame_.size.z - 1 - z);
  std::size_t cells = 0;
  for (std::size_t k = std::size_t(z) * frame_.plane; k < std::size_t(z + count) * frame_.plane; ++k)
    cells += std::popcount(near_.words()[k]);
  begin_.place.resize(cells * lbm::D3Q19::pairs + lbm::link_lanes);
  const std::uint32_t found =
      cells == 0 ? 0
                 : bit_kernels().list_crossings(frame_, {z, count, 1, frame_.size.y - 1}, near_.words(),
                                                own_.words(), begin_.place.data());
  begin_.place.resize(found);
  for (std::uint32_t& place : begin_.place) place += lbm::link_place({0, 0, 1}, 0);
}

/// Sets the distances at which lines meet the surface; 1 for lines that do not.
template <class T>
void CrossingLinks<T>::measure(Ends& ends, Int3 corner, const lbm::SurfaceFrame& frame,
                               const rigid::SurfaceView<T>& surface) const {
  const std::size_t n = ends.place.size(), filled = lbm::padded(std::uint32_t(n));
  if (n == 0) return ends.q.clear();
  ends.place.resize(filled, ends.place.back()), ends.q.resize(filled);
  distance_kernel<T, T>()({ends.place.data(), int(filled), corner}, frame, surface, T(0), ends.q.data());
  ends.place.resize(n), ends.q.resize(n);
}

template <class T>
void CrossingLinks<T>::list(int z, const lbm::SurfaceFrame& frame, const rigid::SurfaceView<T>& surface) {
  const Int3 corner = frame_.low + Int3{0, 0, z - 1};
  place_.clear(), q_.clear();
  list_candidates(z);
  measure(begin_, corner, frame, surface);
  std::size_t left = 0;
  for (std::size_t k = 0; k < begin_.place.size(); ++k)
    if (begin_.q[k] < 1) begin_.place[left] = begin_.place[k], begin_.q[left++] = begin_.q[k];
  begin_.place.resize(left), begin_.q.resize(left);
  for (Ends* ends : {&end_, &before_, &after_}) ends->place.clear();
  for (const std::uint32_t place : begin_.place) {
    const Int3 x = lbm::place_cell(place);
    const int i = lbm::place_direction(place), back = lbm::opposite(i);
    end_.place.push_back(lbm::link_place(x + lbm::D3Q19::c[i], back));
    before_.place.push_back(lbm::link_place(x, back));
    after_.place.push_back(lbm::link_place(x + lbm::D3Q19::c[i], i));
  }
  for (Ends* ends : {&end_, &before_, &after_}) measure(*ends, corner, frame, surface);
  const auto crosses = [&](std::size_t k) { return end_.q[k] < 1 && before_.q[k] == 1 && after_.q[k] == 1; };
  const auto inside = [&](std::uint32_t place) { return block_.contains(corner + lbm::place_cell(place)); };
  const auto add = [&](const Ends& ends, std::size_t k) {
    place_.push_back(ends.place[k]), q_.push_back(ends.q[k]);
  };
  for (const bool both : {true, false})
    for (std::size_t k = 0; k < left; ++k) {
      const bool begins = inside(begin_.place[k]), ends = inside(end_.place[k]);
      if (!crosses(k) || (begins && ends) != both) continue;
      if (begins) add(begin_, k);
      if (ends) add(end_, k);
    }
}

template class CrossingLinks<float>;
template class CrossingLinks<double>;

}  // namespace silt::coupler
