#pragma once
// The cut links of a block as a device applies them: all groups of the block in one list, a team a group, and
// what a step sets and sums of each surface.
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "device/device.hpp"
#include "lbm/cut_links.hpp"

namespace silt::lbm {

/// A group of a surface, and its part of the arrays of CutLinks; what a group does not have is a null
/// pointer.
template <class T>
struct DeviceGroup {
  std::uint32_t surface, count;
  WallScheme scheme;
  Int3 corner;
  const std::uint32_t* place;
  const T *q, *rate, *opposite_q, *opposite_u;
  const std::uint32_t* across;
};

template <class T>
struct DeviceSurface {
  WallFluid<T> fluid;
  SurfaceFrame frame;
  // of the step under way:
  T age;
  SurfaceMotion motion;  // of a correction: the increment
  double limit;          // of what passes along a link
  bool open;             // the pass is for its links
  LinkSums sums;
  std::int64_t beyond_range;  // teams that found a term which is
};

/// A link of `single_cell_gap` is told of the velocity of the surface on its other side (SingleCellGaps).
template <class T>
struct OppositeLink {
  T* velocity;
  std::uint32_t surface;
  Int3 cell, along;  // of the link; c_i
};

/// The velocity of a rigid surface along c, at the cell of a link: along c it is the same where the link
/// meets it.
SILT_DEVICE inline double velocity_along(const SurfaceFrame& frame, const SurfaceMotion& m, Int3 cell,
                                         Int3 c) {
  const Int3 from_frame = cell - frame.cell;
  const double r[3] = {from_frame.x + frame.offset[0], from_frame.y + frame.offset[1],
                       from_frame.z + frame.offset[2]};
  double sum = 0;
  for (int d = 0; d < 3; ++d) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    sum += c[d] * (m.v[d] + (m.omega[e] * r[f] - m.omega[f] * r[e]));
  }
  return sum;
}

template <class T>
struct LinkPass;

template <class T>
class DeviceLinks {
 public:
  explicit DeviceLinks(Device device) : device_(device) {}

  /// The links are those of surfaces added from now on, one after the other, whose arrays lie in memory_of
  /// the device and stay there.
  void clear();
  void add(const CutLinks<T>&);
  /// The velocity that a link is told of is that of another surface.
  void add_opposite(T& velocity, std::uint32_t other, Int3 cell, int direction);

  void set_fluid(const WallFluid<T>& fluid) {
    for (DeviceSurface<T>& surface : surfaces_) surface.fluid = fluid;
  }
  /// Begins a step: surface k moves so, and its distances have this age.
  void set_motion(std::size_t k, const SurfaceMotion&, T age);
  /// Writes what the surfaces return along all links, and sums force, torque and mass.
  void apply(Block<T>&, const LinkSlots&, const BeyondPair<T>* pairs_across, ForceForm);
  LinkSums sums(std::size_t k) const;

  /// Surface k moved faster by an increment than it was said to; none did until this is called.
  void set_increment(std::size_t k, const SurfaceMotion&);
  /// Changes what these surfaces returned. Returns the mass that this added.
  std::int64_t correct(Block<T>&, const LinkSlots&);

 private:
  LinkPass<T> pass_over(Block<T>&, const LinkSlots&);

  Device device_;
  std::pmr::vector<DeviceGroup<T>> groups_{memory_of(device_)}, crossing_{memory_of(device_)};
  std::pmr::vector<OppositeLink<T>> opposites_{memory_of(device_)};
  std::pmr::vector<DeviceSurface<T>> surfaces_{memory_of(device_)};
  std::pmr::vector<LinkSlots> slots_{1, memory_of(device_)};  // of the pass
};

}  // namespace silt::lbm
