#pragma once
// What crosses a border between levels (level_border.hpp), as lists of patches: rectangles of coarse cells
// that have the same leaves of the tree of cuts around them. The passes over them are in cross_border.hpp.
#include <array>
#include <cstdint>
#include <memory_resource>
#include <span>

#include "cpu/device_code.hpp"
#include "cpu/isa.hpp"

namespace silt::lbm {

template <class T>
struct BorderLists;

template <class T>
struct BorderPatches {
  /// The coarse cells of a patch: rows of `length` cells. Values that a border keeps for a patch lie row
  /// after row.
  struct Extent {
    std::uint32_t length, rows;
    SILT_DEVICE std::uint32_t cells() const { return length * rows; }
  };
  /// Elements of an array of a table, one per coarse cell of a patch, `step` apart in a row, `pitch` from row
  /// to row. The table of a fluid has arrays of the populations that left, one per block and direction (block
  /// * directions + i), then of those that arrive, then those fetched from other ranks.
  struct Patch {
    std::uint32_t array = 0;
    std::int32_t first = 0, step = 0, pitch = 0;
  };
  /// The packets that leave a patch of coarse cells along one direction, stored in `carried` patch after
  /// patch.
  struct Carried {
    Extent size;
    std::uint32_t first;  // index in carried
    Patch value;
    std::array<Patch, 3> above,
        below;                // neighbours along each axis; the cells themselves where none is coarse
    std::array<T, 3> slope;   // times above - below: change from the centre to a packet
    std::array<T, 2> change;  // by sub-step: what a packet has of the change by the last collision, over it
    Patch before;             // of arrivals before it; in lists that are used, elements of coarse_before
    SILT_DEVICE bool in_time() const { return change[0] != 0; }
  };
  static constexpr int carried_values =
      5;  // of a cell: in the first and in the second step; changes along x, y and z
  /// Moves coarse populations of one direction that left a patch of cells into fine cells.
  struct Explosion {
    Extent size;
    std::uint32_t carried;    // index in carried
    std::uint32_t first[2];   // packet, by sub-step
    std::uint8_t packets[2];  // number of packets
  };
  struct Packet {
    Patch to;
    T addend;             // from walls on the way, and the force
    std::uint8_t corner;  // bit d for the upper half along axis d
    bool paired = false;  // the next element receives the other corner along x
  };
  /// Sums the packets that arrive along one direction in a patch of coarse cells.
  struct Coalescence {
    Extent size;
    Patch to;
    std::uint32_t sum;  // index in sums, kept between sub-steps
    T addend;
    std::uint32_t first[2], first_taken;  // source, by sub-step
    std::uint8_t from_coarse;             // number of the eight packets that come from the coarse cell
    std::uint8_t sources[2], taken;       // numbers of them
  };
  struct Source {  // fine cells
    Patch from;
    bool paired = false;  // the next element is a source, too
  };
  /// The difference between packets that entered fine cells and the value at the centre of their coarse cell.
  struct Taken {
    Patch above, below;
    T factor;
  };
  /// A packet that passes between two fine cells, through a coarse one.
  struct Passing {
    Extent size;
    Patch from, to;
    std::uint32_t kept;  // index in sums
    T addend;
  };

  /// The tables of both fluids, and the arrays of this border.
  T *const *fine_left, *const *fine_arriving, *const *coarse_left, *const *coarse_arriving;
  const T* coarse_before;
  T *carried, *sums;
  int sub_step;
  /// The lists to which entries refer.
  const Packet* packets;
  const Source* sources;
  const Taken* taken;
  void refer_to(const BorderLists<T>& lists) {
    packets = lists.packets[sub_step].data(), sources = lists.sources[sub_step].data();
    taken = lists.taken.data();
  }
};

/// The lists of a border, in memory that a device reaches; the packets of an explosion are consecutive.
template <class T>
struct BorderLists {
  template <class Entry>
  using Of = std::pmr::vector<Entry>;
  using Patches = BorderPatches<T>;
  Of<typename Patches::Explosion> explosions;
  Of<typename Patches::Packet> packets[2];  // by sub-step
  Of<typename Patches::Coalescence> coalescences;
  Of<typename Patches::Source> sources[2];
  Of<typename Patches::Taken> taken;

  explicit BorderLists(std::pmr::memory_resource* m = std::pmr::new_delete_resource())
      : explosions(m),
        packets{Of<typename Patches::Packet>(m), Of<typename Patches::Packet>(m)},
        coalescences(m),
        sources{Of<typename Patches::Source>(m), Of<typename Patches::Source>(m)},
        taken(m) {}
};

template <class T>
struct BorderKernels {
  void (*carry_packets)(const BorderPatches<T>&, std::span<const typename BorderPatches<T>::Carried>);
  void (*cross_border)(const BorderPatches<T>&, const BorderLists<T>&,
                       std::span<const typename BorderPatches<T>::Passing>);
};
SILT_BUILDS(template <class T> BorderKernels<T> border_kernels();)

}  // namespace silt::lbm
