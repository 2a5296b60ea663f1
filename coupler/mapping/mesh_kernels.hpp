#pragma once
// The kernels of meshes, built once an instruction set: corners at a pose, the triangles near lines of
// lattice points, and what these cut.
#include <cstddef>
#include <cstdint>

#include "coupler/mapping/bit_window.hpp"
#include "coupler/mapping/mesh_lines.hpp"
#include "cpu/isa.hpp"

namespace silt::coupler {

/// Some triangles at a pose.
struct TriangleView {
  const std::uint32_t (*triangles)[3];  // of corners
  const std::uint32_t* wanted;          // numbers of triangles
  std::size_t count;                    // of those wanted
  const Whole3* corner;                 // in units
  const float* rough;                   // the same in cells, three numbers each, from `base` on
  std::int64_t base[3];                 // whole cells
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

/// What each build offers.
struct MeshKernels {
  /// Places corners, of three numbers each: position + turn corner; turn: rows. `base` is taken off in
  /// `rough`.
  void (*place_corners)(const double* from, std::size_t count, const double* turn, const double* position,
                        const std::int64_t* base, Whole3* corner, float* rough);
  /// Changes the bit of the first cell beyond wherever a row of cells along x meets a triangle; `low`: of the
  /// frame's bit 0. All cells but two at either end of the frame.
  void (*mark_changes)(const TriangleView&, const BitFrame&, lbm::Int3 low, std::uint64_t* words);
  /// Finds the least distances along all links; `low` likewise.
  void (*cut_links)(const TriangleView&, lbm::Int3 low, const LinkDistances&);
  /// Sets the distances of links at places that count from a cell of the frame, in units.
  void (*look_up)(const LinkDistances&, lbm::Int3 corner, const std::uint32_t* place, std::size_t count,
                  std::uint32_t* distance);
};
namespace portable {
MeshKernels mesh_kernels();
}
namespace avx2 {
MeshKernels mesh_kernels();
}
namespace avx512 {
MeshKernels mesh_kernels();
}
/// What the build that runs here offers.
inline const MeshKernels& mesh_kernels() {
  static const MeshKernels kernels =
      chosen(portable::mesh_kernels, avx2::mesh_kernels, avx512::mesh_kernels)();
  return kernels;
}

}  // namespace silt::coupler
