#pragma once
// The kernels of meshes, built once per instruction set: corners at a pose, and the intersections of
// triangles with lines of lattice points.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "coupler/mapping/bit_window.hpp"
#include "cpu/isa.hpp"

namespace silt::coupler {

/// Lengths are in units of 2^-24 cell; the centre of cell 0 of the domain is at 0.
inline constexpr int cell_bits = 24;
inline constexpr std::int64_t cell_units = std::int64_t{1} << cell_bits;

/// A corner of a triangle in whole units, and its lattice intervals along x, y and z, `field` bits each: the
/// index of the lattice point before it, modulo 2^20, and whether the corner is at a lattice point.
struct alignas(32) Corner {
  double at[3];
  std::uint64_t between;

  static constexpr int field = 21;
  static constexpr std::uint64_t of_x = (std::uint64_t{1} << field) - 1;
  static constexpr std::uint64_t x_is_whole = std::uint64_t{1} << (field - 1),
                                 is_whole = x_is_whole | x_is_whole << field | x_is_whole << 2 * field;
  static constexpr double distinct = 1 << (field - 1);  // cells
};

/// Indices of triangles in groups, without those that meet no plane of lattice points.
struct TrianglesByPlanes {
  std::span<const std::uint32_t> in_plane[3];  // meet planes across an axis
  std::span<const std::uint32_t> on_x_axis;    // meet planes across y and z
};

/// Triangles at a pose.
struct TriangleView {
  const std::uint32_t (*triangles)[3];  // corners of each
  const Corner* corner;
  std::span<const TrianglesByPlanes> parts;  // the corners of a part fit the near caches
};

/// Distances per direction for the cells in `near`; `before` is the number of such cells before each word.
struct LinkDistances {
  BitFrame frame;             // of both streams
  const std::uint64_t* body;  // cells at which links end
  const std::uint64_t* near;
  const std::uint32_t* before;
  std::uint32_t* least;  // in units

  static constexpr std::uint32_t none = ~std::uint32_t{0};
};

/// The functions built for each instruction set.
struct MeshKernels {
  /// Places corners, three coordinates each, at position + turn * corner; `turn` is stored by rows.
  void (*place_corners)(const double* from, std::size_t count, const double* turn, const double* position,
                        Corner*);
  /// Flips the bit of the first cell after each intersection of a row of cells along x with a triangle,
  /// without the outer two cells at either end of the frame; `low` is the cell of its bit 0.
  void (*mark_changes)(const TriangleView&, const BitFrame&, lbm::Int3 low, std::uint64_t* words);
  /// Finds the least distances along all links; `low` as above.
  void (*cut_links)(const TriangleView&, lbm::Int3 low, const LinkDistances&);
  /// Sets the distances of links, in units; places count from `corner`.
  void (*look_up)(const LinkDistances&, lbm::Int3 corner, const std::uint32_t* place, std::size_t count,
                  std::uint32_t* distance);
};
SILT_BUILDS(MeshKernels mesh_kernels();)
/// Returns the kernels for this CPU.
inline const MeshKernels& mesh_kernels() {
  static const MeshKernels kernels = SILT_CHOSEN(mesh_kernels)();
  return kernels;
}

}  // namespace silt::coupler
