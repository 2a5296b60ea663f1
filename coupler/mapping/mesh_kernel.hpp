#pragma once
// The kernels of meshes, built once an instruction set: corners at a pose, the triangles near lines of
// lattice points, and what these cut.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "coupler/mapping/bit_window.hpp"
#include "cpu/isa.hpp"

namespace silt::coupler {

/// One cell is so many units; the centre of cell 0 of the domain is at 0.
inline constexpr int cell_bits = 24;
inline constexpr std::int64_t cell_units = std::int64_t{1} << cell_bits;

/// A corner of a triangle: in units, whole numbers; and the lattice points that it is between along x, y and
/// z, `field` bits each: of the one before it the number, modulo 2^20, then whether the corner is at it.
struct alignas(32) Corner {
  double at[3];
  std::uint64_t between;

  static constexpr int field = 21;
  static constexpr std::uint64_t of_x = (std::uint64_t{1} << field) - 1;
  static constexpr std::uint64_t x_is_whole = std::uint64_t{1} << (field - 1),
                                 is_whole = x_is_whole | x_is_whole << field | x_is_whole << 2 * field;
  static constexpr double distinct = 1 << (field - 1);  // cells
};

/// Numbers of triangles, some by some; those that meet no plane of lattice points are left out.
struct TrianglesByPlanes {
  std::span<const std::uint32_t> in_plane[3];  // that meet planes across an axis
  std::span<const std::uint32_t> on_x_axis;    // that meet planes across y and z
};

/// Some triangles at a pose.
struct TriangleView {
  const std::uint32_t (*triangles)[3];  // of corners
  const Corner* corner;
  std::span<const TrianglesByPlanes> parts;  // a part's corners fit the near caches
};

/// Cells from which links may be cut: those set in `near`, of which `before` come before each word; a
/// distance for every direction of each.
struct LinkDistances {
  BitFrame frame;             // of both windows
  const std::uint64_t* body;  // cells that links lead to
  const std::uint64_t* near;
  const std::uint32_t* before;
  std::uint32_t* least;  // in units

  static constexpr std::uint32_t none = ~std::uint32_t{0};
};

/// The functions that each build for an instruction set has.
struct MeshKernels {
  /// Places corners, of three numbers each: position + turn corner; turn: rows.
  void (*place_corners)(const double* from, std::size_t count, const double* turn, const double* position,
                        Corner*);
  /// Changes the bit of the first cell beyond wherever a row of cells along x meets a triangle; `low`: of the
  /// frame's bit 0. All cells but two at either end of the frame.
  void (*mark_changes)(const TriangleView&, const BitFrame&, lbm::Int3 low, std::uint64_t* words);
  /// Finds the least distances along all links; `low` likewise.
  void (*cut_links)(const TriangleView&, lbm::Int3 low, const LinkDistances&);
  /// Sets the distances of links at places that count from a cell of the frame, in units.
  void (*look_up)(const LinkDistances&, lbm::Int3 corner, const std::uint32_t* place, std::size_t count,
                  std::uint32_t* distance);
};
SILT_BUILDS(MeshKernels mesh_kernels();)
/// Returns the functions of the build that runs here.
inline const MeshKernels& mesh_kernels() {
  static const MeshKernels kernels = SILT_CHOSEN(mesh_kernels)();
  return kernels;
}

}  // namespace silt::coupler
