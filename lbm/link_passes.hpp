#pragma once
// The passes over the links of a block on a device (DeviceLinks), as each device's build has them.
#include <span>

#include "lbm/device_links.hpp"

namespace silt::lbm {

/// The passes over groups read and write these. Places count from the corner of a group.
template <class T>
struct LinkPass {
  T* data;  // the block's cell 0 at Block::middle()
  std::int32_t row, plane;
  const LinkSlots* slots;
  DeviceSurface<T>* surfaces;
  const BeyondPair<T>* pairs_across;
  bool galilean;
};

#define SILT_LINK_PASSES                                                          \
  template <class T>                                                              \
  void set_opposites(std::span<const OppositeLink<T>>, const DeviceSurface<T>*);  \
  template <class T>                                                              \
  void apply_links(std::span<const DeviceGroup<T>>, const LinkPass<T>&);          \
  template <class T>                                                              \
  void apply_crossing_links(std::span<const DeviceGroup<T>>, const LinkPass<T>&); \
  template <class T>                                                              \
  void correct_links(std::span<const DeviceGroup<T>>, const LinkPass<T>&);
namespace host {
SILT_LINK_PASSES
}
namespace gpu {
SILT_LINK_PASSES
}
#undef SILT_LINK_PASSES

}  // namespace silt::lbm
