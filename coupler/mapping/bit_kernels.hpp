#pragma once
// The kernels of object mapping, built once an instruction set: bits of bodies, bits of cut links and their
// lists.
#include <cstdint>

#include "coupler/mapping/bit_window.hpp"
#include "coupler/mapping/surface_kernels.hpp"

namespace silt::coupler {

/// The reference point of a body seen from a frame.
struct PointInFrame {
  double x, y, z;  // canonical: the same for every frame, to the bit, once whole cells are taken off
  lbm::Int3 low;   // cell of the frame's bit 0, in the coordinates of the point
};

/// What the links of one surface are made of; streams of one frame.
struct LinkBits {
  const std::uint64_t* body;   // with margins
  const std::uint64_t* solid;  // with margins
  const std::uint64_t* open;   // fluid cells whose links are wanted
  bool reads_behind;           // links whose cell behind is solid are narrow
};

/// Links listed: those whose cell behind is no matter, and the narrow ones.
struct LinkCounts {
  std::uint32_t clear, narrow;
};

}  // namespace silt::coupler

#define SILT_BIT_KERNELS(isa)                                                                              \
  namespace silt::coupler::isa {                                                                           \
  void mark_sphere(const BitFrame&, const PointInFrame&, double radius, std::uint64_t* words);             \
  void mark_parts(const BitFrame&, const PointInFrame&, const SurfaceView<double>&, std::uint64_t* words); \
  LinkCounts list_links(const BitFrame&, int z, int planes, int y0, int y1, const LinkBits&,               \
                        std::uint32_t* place, std::uint32_t* narrow);                                      \
  }

SILT_BIT_KERNELS(portable)
SILT_BIT_KERNELS(avx2)
SILT_BIT_KERNELS(avx512)
