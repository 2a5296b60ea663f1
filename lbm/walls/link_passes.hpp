#pragma once
// The passes over the links of a block (DeviceLinks), as built for each device.
#include <span>

#include "lbm/walls/device_links.hpp"

namespace silt::lbm {

/// The data of a pass over groups.
template <class T>
struct LinkPass {
  T* data;  // cell 0 of the block at Block::middle()
  std::int32_t row, plane;
  ExcessQuanta<T>* excess;  // of cell 0 of the block
  const LinkSlots* slots;
  WallFluid<T> fluid;
  const DeviceSurface<T>* const* surfaces;
  const SurfaceStep<T>* steps;         // this and the following: of the surfaces
  const SurfaceIncrement* increments;  // of a correction
  LinkSums* sums;
  const BeyondPair<T>* pairs_across;
  bool galilean;
};

template <class T>
struct LinkPasses {
  void (*list_groups)(std::span<const DeviceSurface<T>* const>, const std::uint32_t* first, GroupOfSurface*);
  void (*set_opposites)(const OppositesToSet<T>&, const LinkPass<T>&);
  void (*apply)(std::span<const GroupOfSurface>, const LinkPass<T>&);
  void (*apply_crossing)(std::span<const GroupOfSurface>, const LinkPass<T>&);
  void (*correct)(std::span<const GroupOfSurface>, const LinkPass<T>&);
};
SILT_DEVICES(template <class T> const LinkPasses<T>& link_passes();)

}  // namespace silt::lbm
