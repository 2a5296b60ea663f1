#pragma once
// The cut links of a block as a device applies them: all groups of the block in one list, a team a group, and
// what a step sets and sums of each surface.
#include <cstdint>
#include <span>

#include "device/mirror.hpp"
#include "lbm/walls/cut_links.hpp"

namespace silt::lbm {

/// A surface as passes find it until its links are made again: the frame, groups and arrays of CutLinks. An
/// array that is empty is a null pointer.
template <class T>
struct DeviceSurface {
  SurfaceFrame frame;
  const LinkGroup* groups;
  std::uint32_t group_count;
  const std::uint32_t *place, *across;
  const T *q, *rate;
  T *opposite_q, *opposite_u;
};
template <class T>
DeviceSurface<T> device_surface(CutLinks<T>& links, const LinkGroup* groups) {
  const auto first = [](auto& values) { return values.empty() ? nullptr : values.data(); };
  return {links.frame,
          groups,
          std::uint32_t(links.groups.size()),
          first(links.place),
          first(links.across),
          first(links.q),
          first(links.rate),
          first(links.opposite_q),
          first(links.opposite_u)};
}

/// A surface in the step under way.
template <class T>
struct SurfaceStep {
  const DeviceSurface<T>* surface;
  SurfaceMotion motion;  // of a correction: the increment
  double limit;          // of what passes along a link
  T age;
  bool open;  // the pass is for its links
};

struct GroupOfSurface {
  std::uint32_t surface, number;
};

/// A link of `single_cell_gap`, whose OppositeWall is at `place`, and the wall on its other side: a side of
/// the domain; or a surface, whose link `number` comes from there; or both, and then the wall is where the
/// side is and moves as the surface does; or none.
template <class T>
struct OppositeLink {
  std::uint32_t surface, place;
  std::int32_t other;  // surface; -1: none
  std::uint32_t number;
  Int3 cell;
  std::int8_t direction;
  bool at_side;
  T side_velocity;
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

/// Sets the OppositeWall of a link in the step under way; `surface_at` finds a SurfaceInGap.
template <class T>
struct SurfaceInGap {
  const SurfaceFrame& frame;
  const SurfaceMotion& motion;
  const T* q;
  T *opposite_q, *opposite_u;
};
template <class T, class SurfaceAt>
SILT_DEVICE void set_opposite(const OppositeLink<T>& link, Int3 along, const SurfaceAt& surface_at) {
  T q = link.at_side ? T(0.5) : T(0), velocity = link.side_velocity;
  if (link.other >= 0) {
    const SurfaceInGap<T> other = surface_at(std::uint32_t(link.other));
    if (!link.at_side) q = other.q[link.number];
    velocity = T(velocity_along(other.frame, other.motion, link.cell, along));
  }
  const SurfaceInGap<T> own = surface_at(link.surface);
  own.opposite_q[link.place] = q, own.opposite_u[link.place] = velocity;
}

template <class T>
struct LinkPass;
template <class T>
struct LinkPasses;

/// Without surfaces nothing is done.
template <class T>
class DeviceLinks {
 public:
  explicit DeviceLinks(Device device) : device_(device) {}
  Device device() const { return device_; }

  /// The links are those of surfaces added from now on, one after the other, which lie in memory_of the
  /// device and stay there.
  void clear();
  void add(const DeviceSurface<T>*, std::span<const LinkGroup>);
  void add(const OppositeLink<T>& link) { opposites_.host().push_back(link); }
  std::size_t size() const { return surfaces_.size(); }  // surfaces

  /// Begins a step: surface k moves so, no cell of its links is further than `reach` from its reference
  /// point, and its distances have this age.
  void set_motion(std::size_t k, const SurfaceMotion&, double reach, T age);
  /// Writes what the surfaces return along all links, adds to the excess of their cells, and sums force
  /// and torque.
  void apply(Block<T>&, const WallFluid<T>&, const LinkSlots&, const BeyondPair<T>* pairs_across, ForceForm);
  const LinkSums& sums(std::size_t k) const { return sums_.host()[k]; }

  /// Surface k moved faster by an increment than it was said to; none did until this is called.
  void set_increment(std::size_t k, const SurfaceMotion&);
  /// Changes what these surfaces returned.
  void correct(Block<T>&, const LinkSlots&);

 private:
  const LinkPasses<T>& passes() const;
  LinkPass<T> pass_over(Block<T>&, const LinkSlots&);
  void list_groups();

  Device device_;
  Mirror<SurfaceStep<T>> surfaces_{device_};
  Mirror<LinkSums> sums_{device_};                          // of the surfaces
  Mirror<std::uint32_t> first_group_{device_};              // of each surface, among those of all
  DeviceArray<GroupOfSurface> groups_{memory_of(device_)};  // of all surfaces
  std::uint32_t group_count_ = 0;
  bool is_listed_ = false, has_crossings_ = false;
  Mirror<OppositeLink<T>> opposites_{device_};
  Mirror<LinkSlots> slots_{device_};  // of the pass
};

}  // namespace silt::lbm
