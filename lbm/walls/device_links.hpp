#pragma once
// The cut links of a block for a device: all groups of the block in one list, one team of threads per group.
// The input of a step and its sums are one for each body, whose periodic images are surfaces. On the device
// `cpu` only gaps of a single cell are handled here: kernels apply and correct the links (cut_links.hpp).
#include <array>
#include <cstdint>
#include <span>

#include "device/mirror.hpp"
#include "lbm/blocks/domain.hpp"
#include "lbm/walls/cut_links.hpp"

namespace silt::lbm {

/// A surface until its links are built again: frame, groups and arrays of CutLinks (null if empty), and the
/// time in steps at which q was measured.
template <class T>
struct DeviceSurface {
  SurfaceFrame frame;
  LinkGroup* groups;
  std::uint32_t group_count;
  std::uint32_t *place, *across;
  T *q, *rate, *opposite_q, *opposite_u;
  double measured;
  bool operator==(const DeviceSurface&) const = default;
};
template <class T>
DeviceSurface<T> device_surface(CutLinks<T>& links, LinkGroup* groups, double measured) {
  const auto first = [](auto& values) { return values.empty() ? nullptr : values.data(); };
  return {links.frame,
          groups,
          std::uint32_t(links.groups.size()),
          first(links.place),
          first(links.across),
          first(links.q),
          first(links.rate),
          first(links.opposite_q),
          first(links.opposite_u),
          measured};
}

/// A surface of the block. Those of one body, with one number `body`, follow one another.
template <class T>
struct ListedSurface {
  static constexpr std::uint32_t no_body = ~0u;  // of a surface without links
  const DeviceSurface<T>* record;
  std::uint32_t first_group, body;  // the former among the groups of all surfaces
};

/// The increment of a body's velocity in a correction.
struct SurfaceIncrement {
  double v[3] = {}, omega[3] = {};
  std::uint32_t body = 0;
};

struct GroupOfSurface {
  std::uint32_t surface, number;
};

/// Returns a key, not 0, common to the links along c_i and against it from a cell, which may lie outside the
/// block, and unique in blocks below 2^18 cells per edge.
SILT_DEVICE inline std::uint64_t key_of_line(Int3 cell, int direction) {
  const auto part = [](int x) {
    const int shifted = x + (1 << 18);
    return std::uint64_t(shifted);
  };
  const int pair = (direction - 1) / 2;  // opposites are neighbours
  return ((part(cell.z) << 19 | part(cell.y)) << 19 | part(cell.x)) << 4 | std::uint64_t(pair);
}
/// Returns where to look for a key in a table of 2^log_size entries: there, or in the next ones, cyclically.
SILT_DEVICE inline std::size_t first_place(std::uint64_t key, int log_size) {
  constexpr std::uint64_t golden = 0x9e3779b97f4a7c15;
  return key * golden >> (64 - log_size);
}

/// The links of `single_cell_gap` along one line through a cell, the first of which has an odd direction:
/// their surfaces, plus 1, or 0 if there is none, and their indices in q.
struct LineInGap {
  std::uint64_t key;  // 0: no line
  std::uint32_t surface[2], number[2];
};
struct LinesInGaps {
  LineInGap* lines;  // a hash table
  int log_size;
};
/// A link in a gap: the index of its OppositeWall, and the link of another surface that points the other way.
struct OppositeLink {
  std::uint32_t surface, place;  // the surface plus 1; 0: no link
  std::uint32_t other, number;   // the surface plus 1, or 0, and the index in its q
  Int3 cell;
  std::int32_t direction;
};
/// A list of such links, in any order.
struct OppositeLinks {
  OppositeLink* links;
  unsigned* count;
};
/// What a pass needs to set the OppositeWall of links: the links, and the sides of the domain.
struct OppositesToSet {
  std::span<const OppositeLink> links;
  std::array<SideCondition, 6> sides;
  Int3 cells, lower;  // of the domain; the first cell of the block
};

template <class T>
struct LinkPass;
template <class T>
struct LinkPasses;

/// The links of a block in gaps of one cell that know the wall on the other side.
template <class T>
class LinksInGaps {
 public:
  explicit LinksInGaps(Device device) : device_(device) {}
  void clear() { most_ = 0; }
  void add(std::size_t most) { most_ += most; }
  bool empty() const { return most_ == 0; }
  /// Lists them, and the lines through them.
  void list(std::span<const GroupOfSurface>, const LinkPass<T>&);
  /// Sets their OppositeWall; `lower` is the first cell of the block.
  void set_opposites(const LinkPass<T>&, const Domain&, Int3 lower) const;

 private:
  Device device_;
  std::size_t most_ = 0;
  DeviceArray<LineInGap> lines_{memory_of(device_)};
  DeviceArray<OppositeLink> opposites_{memory_of(device_)};
  Mirror<unsigned> count_{device_};
};

/// The surfaces and links of a block on a device. Without surfaces its functions do nothing.
template <class T>
class DeviceLinks {
 public:
  explicit DeviceLinks(Device device) : device_(device) {}
  Device device() const { return device_; }

  /// Removes all surfaces. Those added next must stay in memory_of the device.
  void clear();
  /// Adds a surface of the same body as the one before, or of another one; only bodies with links have a
  /// number.
  void add(const DeviceSurface<T>*, const CutLinks<T>&, bool same_body);
  std::size_t size() const { return surfaces_.size(); }  // number of surfaces
  std::size_t bodies() const { return motions_.size(); }
  std::uint32_t body(std::size_t surface) const { return surfaces_.host()[surface].body; }

  /// Sets the motion of a body in the next step.
  void set_motion(std::uint32_t body, const SurfaceMotion& motion) { motions_.host()[body] = motion; }
  /// Begins a step at a time in steps: sets the OppositeWall of links of a block whose first cell is `lower`.
  /// Call once the motions are set.
  void begin_step(double time, const LinkSlots&, const Domain&, Int3 lower);
  /// Writes the populations that links return, adds to their cells' excess, sums force and torque.
  void apply(Block<T>&, const WallFluid<T>&, const BeyondPair<T>* pairs_across, ForceForm);
  const LinkSums& sums(std::uint32_t body) const { return sums_.host()[body]; }

  /// Corrects the populations that surfaces of some bodies, in order, returned for an increment of their
  /// velocity; after apply().
  void correct(Block<T>&, std::span<const SurfaceIncrement>);

 private:
  const LinkPasses<T>& passes() const;
  LinkPass<T> pass();
  LinkPass<T> pass_over(Block<T>&);
  void list_groups();
  void take_slots(const LinkSlots&);

  Device device_;
  Mirror<ListedSurface<T>> surfaces_{device_};
  double time_ = 0;
  Mirror<SurfaceMotion> motions_{device_};  // this and the next two: per body
  Mirror<SurfaceIncrement> increments_{device_};
  Mirror<LinkSums> sums_{device_};
  DeviceArray<GroupOfSurface> groups_{memory_of(device_)};  // of all surfaces
  std::uint32_t group_count_ = 0, body_ = 0;                // of all surfaces; of the one added last
  bool is_listed_ = false, has_crossings_ = false;
  LinksInGaps<T> gaps_{device_};
  Mirror<LinkSlots> slots_{device_};  // of either parity, as they occur
  std::size_t slots_in_use_ = 0;
};

/// The data of a pass over groups of links.
template <class T>
struct LinkPass {
  T* data;  // cell 0 of the block at Block::middle()
  std::int32_t row, plane;
  ExcessQuanta<T>* excess;  // of cell 0 of the block
  const LinkSlots* slots;
  WallFluid<T> fluid;
  const ListedSurface<T>* surfaces;
  double time;
  const SurfaceMotion* motions;                  // this and the following: of the bodies
  std::span<const SurfaceIncrement> increments;  // of a correction
  LinkSums* sums;
  const BeyondPair<T>* pairs_across;
  bool galilean;
};

/// The passes over the links of a block, as built for each device (link_passes_build.hpp).
template <class T>
struct LinkPasses {
  void (*list_groups)(std::span<const ListedSurface<T>>, GroupOfSurface*);
  void (*pair_gaps)(std::span<const GroupOfSurface>, const LinkPass<T>&, const LinesInGaps&);
  void (*list_opposites)(std::span<const GroupOfSurface>, const LinkPass<T>&, const LinesInGaps&,
                         const OppositeLinks&);
  void (*set_opposites)(const LinkPass<T>&, const OppositesToSet&);
  void (*apply)(std::span<const GroupOfSurface>, const LinkPass<T>&);
  void (*apply_crossing)(std::span<const GroupOfSurface>, const LinkPass<T>&);
  void (*correct)(std::span<const GroupOfSurface>, const LinkPass<T>&);
};
SILT_DEVICES(template <class T> const LinkPasses<T>& link_passes();)

}  // namespace silt::lbm
