#pragma once
// Marks the cells whose centres are inside a surface: for kernels of each instruction set and for passes of
// devices (SILT_BUILD), whose threads share the planes of a frame.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "coupler/mapping/bit_kernel.hpp"
#include "device/for_each.hpp"
#include "rigid/shapes/surface_kinds.hpp"

namespace silt::coupler::SILT_BUILD {

/// Sets cells first..last of a row that starts at a bit, except the outer two cells at either end of the
/// frame, which lie outside the block and its ghost layers.
SILT_DEVICE inline void set_cells(const BitFrame& frame, std::size_t row, double first, double last,
                                  std::uint64_t* words) {
  first = std::max(first, 2.0), last = std::min(last, frame.size.x - 3.0);
  if (!(first <= last)) return;
  const std::size_t from = row + std::size_t(first), to = row + std::size_t(last);
  for (std::size_t w = from >> 6; w <= to >> 6; ++w) {
    const std::size_t low = w * 64 < from ? from - w * 64 : 0, high = std::min<std::size_t>(to - w * 64, 63);
    set_bits(words[w], ~std::uint64_t{0} >> (63 - (high - low)) << low);
  }
}

/// Marks the cells inside a ball; row by row in closed form.
SILT_DEVICE inline void mark_sphere(const BitFrame& frame, const PointInFrame& ball, double radius,
                                    std::uint64_t* words, const Team& member) {
  constexpr int most = Lanes<double>::count == 1 ? 1 : 64;  // rows per batch
  double first[most], last[most];
  for (int z = 2 + member.lane; z < frame.size.z - 2; z += member.size) {
    const double rz = (ball.low.z + z + 0.5) - ball.z;
    for (int y0 = 2; y0 < frame.size.y - 2; y0 += most) {
      const int n = std::min(most, frame.size.y - 2 - y0);
      for (int k = 0; k < n; ++k) {
        const double ry = (ball.low.y + (y0 + k) + 0.5) - ball.y;
        const double h2 = radius * radius - ry * ry - rz * rz;
        const double half = std::sqrt(h2 < 0 ? 0 : h2), centre = ball.x - 0.5;
        first[k] = h2 < 0 ? 1 : std::ceil(centre - half) - ball.low.x;
        last[k] = h2 < 0 ? 0 : std::floor(centre + half) - ball.low.x;
      }
      for (int k = 0; k < n; ++k) {
        const std::size_t row = std::size_t(z) * frame.plane * 64 + std::size_t(y0 + k) * frame.pitch;
        set_cells(frame, row, first[k], last[k], words);
      }
    }
  }
}

/// The rows of a frame, without the outer two at either end, that the bounding box of a part overlaps.
struct RowsOf {
  static constexpr double rounding = 1e-6;  // cells
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  int y0 = 2, y1, z0 = 2, z1;

  SILT_DEVICE RowsOf(const BitFrame& frame, const PointInFrame& body, const rigid::SurfacePart<double>& part)
      : y1(frame.size.y - 2), z1(frame.size.z - 2) {
    if (part.kind == rigid::SurfaceKind::tube || !(part.extent[0] < infinity)) return;
    const auto bound = [&](int d, double from, double low, int& first, int& end) {
      double middle = from - (low + 0.5), half = rounding;
      for (int k = 0; k < 3; ++k) {  // the axes of an ellipsoid are no unit vectors
        const double* const axis = part.axes[k];
        const double along = axis[d] / (axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
        middle += along * part.centre[k], half += std::abs(along) * part.extent[k];
      }
      first = std::max(first, int(std::ceil(std::max(middle - half, 0.0))));
      end = std::min(end, int(std::floor(std::min(middle + half, double(end)))) + 1);
    };
    bound(1, body.y, body.low.y, y0, y1);
    bound(2, body.z, body.low.z, z0, z1);
  }
};

/// Sets the cells inside a part of any kind, one row per lane; for a tube the cells outside its hole.
template <rigid::SurfaceKind kind>
SILT_DEVICE void mark_part(const BitFrame& frame, const PointInFrame& centre,
                           const rigid::SurfacePart<double>& part, const rigid::Plane<double>* planes,
                           std::uint64_t* words, const Team& member) {
  using Lines = rigid::SILT_BUILD::LineLanes<double, kind>;
  using V = typename Lines::V;
  constexpr int lanes = Lines::L::count;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double x = centre.x - 0.5;
  double ramp[lanes];
  for (int l = 0; l < lanes; ++l) ramp[l] = l;
  const V lane = load<V>(ramp);
  const RowsOf rows(frame, centre, part);
  for (int z = rows.z0 + member.lane; z < rows.z1; z += member.size) {
    const V rz = V{} + ((centre.low.z + z + 0.5) - centre.z);
    for (int y = rows.y0; y < rows.y1; y += lanes) {
      const V ry = ((centre.low.y + y + 0.5) + lane) - centre.y;
      const auto in = Lines(part, {V{}, ry, rz}, {V{} + 1.0, V{}, V{}}).inside(part, planes);
      for (int l = 0; l < std::min(lanes, rows.y1 - y); ++l) {
        const std::size_t row = std::size_t(z) * frame.plane * 64 + std::size_t(y + l) * frame.pitch;
        const double enter = x + lane_of(in.enter, l), leave = x + lane_of(in.leave, l);
        if constexpr (kind == rigid::SurfaceKind::tube) {
          set_cells(frame, row, -infinity, std::floor(enter) - centre.low.x, words);
          set_cells(frame, row, std::ceil(leave) - centre.low.x, infinity, words);
        } else if (enter <= leave) {
          set_cells(frame, row, std::ceil(enter) - centre.low.x, std::floor(leave) - centre.low.x, words);
        }
      }
    }
  }
}

}  // namespace silt::coupler::SILT_BUILD
