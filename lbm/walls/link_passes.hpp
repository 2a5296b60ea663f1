#pragma once
// The passes over the links of a block on a device (DeviceLinks), as each device's build has them.
#include <span>

#include "lbm/walls/device_links.hpp"

namespace silt::lbm {

/// The passes over groups read and write these. Places count from the corner of a group.
template <class T>
struct LinkPass {
  T* data;  // the block's cell 0 at Block::middle()
  std::int32_t row, plane;
  ExcessQuanta<T>* excess;  // of the block's cell 0
  const LinkSlots* slots;
  WallFluid<T> fluid;
  const SurfaceStep<T>* surfaces;
  LinkSums* sums;  // of the surfaces
  const BeyondPair<T>* pairs_across;
  bool galilean;
};

template <class T>
struct LinkPasses {
  void (*list_groups)(std::span<const SurfaceStep<T>>, const std::uint32_t* first, GroupOfSurface*);
  void (*set_opposites)(std::span<const OppositeLink<T>>, const LinkPass<T>&);
  void (*apply)(std::span<const GroupOfSurface>, const LinkPass<T>&);
  void (*apply_crossing)(std::span<const GroupOfSurface>, const LinkPass<T>&);
  void (*correct)(std::span<const GroupOfSurface>, const LinkPass<T>&);
};
SILT_DEVICES(template <class T> const LinkPasses<T>& link_passes();)

}  // namespace silt::lbm
