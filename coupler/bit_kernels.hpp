#pragma once
// The kernels of object mapping, built once an instruction set: bits of spheres, bits of cut links and their
// lists, wall distances of spheres.
#include <cstdint>

#include "coupler/bit_window.hpp"
#include "lbm/cut_links.hpp"
#include "lbm/isa.hpp"

namespace silt::coupler {

using lbm::chosen_isa;
using lbm::Isa;

/// A sphere seen from a frame: `centre` from the centre of the frame's first cell.
struct SphereInFrame {
  double x, y, z;  // canonical: the same for every frame, to the bit, once whole cells are taken off
  double radius;
  lbm::Int3 low;  // cell of the frame's bit 0, in the coordinates of the centre
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

#define SILT_BIT_KERNELS(isa)                                                                               \
  namespace silt::coupler::isa {                                                                            \
  void mark_sphere(const BitFrame&, const SphereInFrame&, std::uint64_t* words);                            \
  LinkCounts list_links(const BitFrame&, int z, int planes, int y0, int y1, const LinkBits&,                \
                        std::uint32_t* place, std::uint32_t* narrow);                                       \
  template <class T>                                                                                        \
  void sphere_distances(const std::uint32_t* place, int padded, const lbm::SurfaceFrame&, lbm::Int3 corner, \
                        double radius, T* q);                                                               \
  }

SILT_BIT_KERNELS(portable)
SILT_BIT_KERNELS(avx2)
SILT_BIT_KERNELS(avx512)
