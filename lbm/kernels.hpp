#pragma once
// The kernels that are built once an instruction set: the same declarations in a namespace each.
#include "lbm/block.hpp"
#include "lbm/collision.hpp"
#include "lbm/cut_links.hpp"
#include "lbm/stream_collide.hpp"

#define SILT_KERNELS(isa)                                                                                   \
  namespace silt::lbm::isa {                                                                                \
  template <class T>                                                                                        \
  void stream_collide_rows(Block<T>&, Parity, const CollisionRates<T>&, RowRange);                          \
  template <class T>                                                                                        \
  void apply_group(Block<T>&, const LinkSlots&, const CutLinks<T>&, const LinkGroup&, const SurfaceMotion&, \
                   ForceForm, LinkSums&, const NextGroup<T>&);                                              \
  template <class T>                                                                                        \
  void correct_group(Block<T>&, const LinkSlots&, const CutLinks<T>&, const LinkGroup&,                     \
                     const SurfaceMotion&, LinkSums&, const NextGroup<T>&);                                 \
  template <class T>                                                                                        \
  void surface_stiffness(const CutLinks<T>&, int exponent, StiffnessSums&);                                 \
  }

SILT_KERNELS(portable)
SILT_KERNELS(avx2)
SILT_KERNELS(avx512)
