// Built once per instruction set.
#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>

#include "coupler/mapping/mesh_slices.hpp"
#include "lbm/walls/cut_links.hpp"

namespace silt::coupler::SILT_BUILD {

namespace {

using lbm::Int3;

void place_corners(const double* from, std::size_t count, const double* turn, const double* position,
                   Corner* corner) {
  using Four = VectorOf<double, 4>::type;
  using WholeFour = VectorOf<std::uint64_t, 4>::type;
  const Four columns[] = {
      {turn[0], turn[3], turn[6]}, {turn[1], turn[4], turn[7]}, {turn[2], turn[5], turn[8]}};
  const Four at{position[0], position[1], position[2]};
  for (std::size_t k = 0; k < count; ++k) {
    const double* const x = from + 3 * k;
    const Four y = at + (columns[0] * x[0] + columns[1] * x[1] + columns[2] * x[2]) - 0.5;
    const Four sum = y * one_cell + rounder,
               whole = sum - rounder;  // low bits of the sum: those of the number
    std::memcpy(&corner[k], &whole, sizeof whole);
    WholeFour bits;
    std::memcpy(&bits, &sum, sizeof bits);
    const WholeFour is_whole = ((bits << (64 - cell_bits)) == 0) & Corner::x_is_whole;
    const WholeFour field = ((bits >> cell_bits) & (Corner::x_is_whole - 1)) | is_whole;
    corner[k].between = field[0] | field[1] << Corner::field | field[2] << 2 * Corner::field;
  }
}

std::size_t bit_of(const BitFrame& frame, Int3 x) {
  return std::size_t(x.z) * std::size_t(frame.plane) * 64 + std::size_t(x.y) * std::size_t(frame.pitch) +
         std::size_t(x.x);
}

void mark_changes(const TriangleView& view, const BitFrame& frame, Int3 low, std::uint64_t* words) {
  constexpr Direction<0> along_x;
  const Int3 first = low + Int3{2, 2, 2}, last = low + frame.size - Int3{3, 3, 3};
  const auto change = [&](auto, Int3 line, std::int64_t w) {
    const int x = int(std::max<std::int64_t>((w + cell_units - 1) >> cell_bits, first.x));
    if (x > last.x) return;
    const std::size_t bit = bit_of(frame, Int3{x, line.y, line.z} - low);
    words[bit >> 6] ^= std::uint64_t{1} << (bit & 63);
  };
  for (const TrianglesByPlanes& part : view.parts)
    for (std::size_t n = 0; n < part.on_x_axis.size(); n += double_lanes)
      SlicedTriangles<along_x.plane>(view, part.on_x_axis.subspan(n))
          .slice(one_cell * first.z, one_cell * last.z,
                 [&](const Segments& segments) { meet_lines(segments, along_x, first, last, change); });
}

bool test(const std::uint64_t* words, std::size_t bit) {
  return words[bit >> 6] >> (bit & 63) & 1;
}
/// Returns the least distance found so far for a cell of `near`.
std::uint32_t& least_of(const LinkDistances& links, std::size_t bit, int direction) {
  const std::uint64_t lower = links.near[bit >> 6] & ((std::uint64_t{1} << (bit & 63)) - 1);
  return links.least[(links.before[bit >> 6] + std::size_t(std::popcount(lower))) * lbm::D3Q19::directions +
                     std::size_t(direction)];
}

bool within(const BitFrame& frame, Int3 x) {
  return unsigned(x.x) < unsigned(frame.size.x) && unsigned(x.y) < unsigned(frame.size.y) &&
         unsigned(x.z) < unsigned(frame.size.z);
}

void cut_links(const TriangleView& view, Int3 low, const LinkDistances& links) {
  constexpr std::int64_t rounding = 4;  // units: closer crossings are at the lattice point
  const Int3 last = low + links.frame.size - Int3{1, 1, 1};
  const auto cut = [&](auto direction, Int3 line, std::int64_t w) {
    for (std::int64_t k = (w - rounding) >> cell_bits; k <= (w + rounding) >> cell_bits; ++k) {
      Int3 from = line - low;
      from[direction.along] += int(k), from[direction.across] += direction.slope * int(k);
      const Int3 to = from + direction.c;
      if (!within(links.frame, from) || !within(links.frame, to)) continue;
      const std::size_t bit_from = bit_of(links.frame, from), bit_to = bit_of(links.frame, to);
      const bool from_body = test(links.body, bit_from);
      if (from_body == test(links.body, bit_to)) continue;
      const std::size_t fluid = from_body ? bit_to : bit_from;
      if (!test(links.near, fluid)) continue;
      const std::int64_t along = std::clamp<std::int64_t>(w - k * cell_units, 0, cell_units);
      std::uint32_t& least = least_of(links, fluid, from_body ? direction.backward : direction.forward);
      least = std::min(least, std::uint32_t(from_body ? cell_units - along : along));
    }
  };
  const auto in_planes = [&]<int axis>(std::integral_constant<int, axis>,
                                       std::span<const std::uint32_t> list) {
    for (std::size_t n = 0; n < list.size(); n += double_lanes)
      SlicedTriangles<axis>(view, list.subspan(n))
          .slice(one_cell * low[axis], one_cell * last[axis], [&](const Segments& segments) {
            for_directions_in_plane<axis>(
                [&](auto direction) { meet_lines(segments, direction, low, last, cut); });
          });
  };
  for (const TrianglesByPlanes& part : view.parts) {
    in_planes(std::integral_constant<int, 0>(), part.in_plane[0]);
    in_planes(std::integral_constant<int, 1>(), part.in_plane[1]);
    in_planes(std::integral_constant<int, 2>(), part.in_plane[2]);
  }
}

void look_up(const LinkDistances& links, Int3 corner, const std::uint32_t* place, std::size_t count,
             std::uint32_t* distance) {
  for (std::size_t k = 0; k < count; ++k) {
    const Int3 x = corner + lbm::place_cell(place[k]) - links.frame.low;
    distance[k] = least_of(links, bit_of(links.frame, x), lbm::place_direction(place[k]));
  }
}

}  // namespace

MeshKernels mesh_kernels() {
  return {place_corners, mark_changes, cut_links, look_up};
}

}  // namespace silt::coupler::SILT_BUILD
