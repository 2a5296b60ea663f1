#pragma once
// Builds the links of a block's bodies by passes of a device (device/for_each.hpp): lists links from the bits
// of bodies, then sets wall distances, their rates, and the resistance of bodies with convex parts, one team
// per group of links. Only bits that changed are sent to the device.
#include <cstdint>
#include <span>
#include <vector>

#include "coupler/mapping/bit_window.hpp"
#include "coupler/mapping/block_links.hpp"
#include "coupler/mapping/cell_bits.hpp"
#include "device/mirror.hpp"
#include "rigid/shapes/surface_kinds.hpp"

namespace silt::coupler {

struct BlockMap;
struct BodyMask;

/// The largest change of a distance in half of the steps of a mapping: a line that grazes the surface may
/// meet it only at one of the two times.
inline constexpr double most_change = 0.25;

/// Returns the rate of a distance that is `middle` at the middle of a mapping and `last` after `steps` more.
/// Wall formulas amplify if the surface passes the cell (q < 0): allowed for a few steps only.
template <class T, class V>
SILT_DEVICE inline V rate_of(const V& middle, const V& last, double steps) {
  constexpr double few = 4;
  const T least = steps > few ? T(0) : T(-0.1), per_step = T(1 / steps);
  const V room = middle - least, largest = V{} + T(most_change), most = room < largest ? room : largest;
  const V change = last - middle, lowest = -most, limited = change < lowest ? lowest : change;
  return (most < limited ? most : limited) * per_step;
}

/// A group whose links follow from the solid bits alone: of open cells in rows [y0, y1) of a mask.
struct ListedGroup {
  std::uint32_t number;  // index in the surface's groups
  std::uint16_t y0, y1;
  std::uint8_t planes;
  bool rim;
};

/// A surface at one time: the ranges of its parts and planes, and its frame.
struct SurfaceAtTime {
  std::uint32_t first_part, first_plane;
  int parts;
  lbm::SurfaceFrame frame;
};

template <class T>
struct SurfaceToMap {
  lbm::WallFluid<T> fluid;
  SurfaceAtTime now, last;  // at the middle of the mapping's steps, and in the last of them
  double steps;             // from now to last; 0: distances have no rates
  T arm;                    // 2^-exponent of the resistance; 0: not needed
  BitFrame frame;
  const std::uint64_t* cells;  // bits of the surface in `frame`
  std::uint32_t* place;
  T *q, *rate;
};

struct GroupToMap {
  std::uint32_t surface, begin, count;
  lbm::Int3 corner;
  lbm::WallScheme scheme;
  bool crossing;       // its distances are given
  ListedGroup listed;  // no planes: its links are given
};

/// A changed word of bits and its address.
struct ChangedWord {
  std::uint64_t *at, bits;
};

/// A run of 32-bit words that the host has listed, to be copied to a device array.
struct HostCopy {
  std::uint32_t* to;
  std::uint32_t first, count;
};

/// The arrays of the passes.
template <class T>
struct LinksToMap {
  const GroupToMap* groups;
  std::size_t group_count;
  const SurfaceToMap<T>* surfaces;
  lbm::ResistanceSums* resistance;  // per surface
  const rigid::SurfacePart<T>* parts;
  const rigid::Plane<T>* planes;
  const ChangedWord* words;
  std::size_t word_count;
  const HostCopy* runs;
  std::size_t run_count;
  const std::uint32_t* told;
  const std::uint64_t* solid;  // CellBits of the block
  lbm::Int3 size;
  int solid_words;  // per row
  lbm::WallScheme scheme;
  lbm::Components directions = lbm::components<lbm::D3Q19>;
};

/// The mapping of one block by its device; does nothing for `cpu`.
template <class T>
class DeviceMapping {
 public:
  explicit DeviceMapping(Device device) : device_(device) {}
  Device device() const { return device_; }
  bool has_links() const { return device_ != Device::cpu; }

  /// Copies the block's solid bits to the device. Call first.
  void begin(const BlockMap&, lbm::WallScheme);
  /// Queues a surface: the link lists of the given groups, and all wall distances. `before` is the mask of
  /// its last links, if any; `arm` is SurfaceToMap::arm.
  void add(SurfaceLinks<T>&, const BodyMask&, const BodyMask* before, std::span<const ListedGroup>,
           const rigid::SurfaceView<T>&, T arm);
  /// Queues a copy of values to an array in memory_of the device.
  template <class Value>
  void upload(std::span<const Value> values, Value* to) {
    static_assert(sizeof(Value) % sizeof(std::uint32_t) == 0);
    const auto* const words = reinterpret_cast<const std::uint32_t*>(values.data());
    const std::size_t count = values.size_bytes() / sizeof *words;
    std::pmr::vector<std::uint32_t>& all = told_.host();
    runs_.host().push_back(
        {reinterpret_cast<std::uint32_t*>(to), std::uint32_t(all.size()), std::uint32_t(count)});
    all.insert(all.end(), words, words + count);
  }
  /// Queues the rates of the surface added last, from the surface and its frame after `steps` steps.
  void add_rates(const rigid::SurfaceView<T>&, const lbm::SurfaceFrame&, double steps);
  /// Runs all that was queued. The surfaces must not have moved in memory.
  void run();

 private:
  SurfaceAtTime listed(const rigid::SurfaceView<T>&, const lbm::SurfaceFrame&);
  void add_words(std::uint64_t* to, const std::uint64_t* now, const std::uint64_t* before, std::size_t count);

  Device device_;
  const BlockMap* map_ = nullptr;
  lbm::WallScheme scheme_{};
  DeviceArray<std::uint64_t> solid_{memory_of(device_)};
  std::vector<SurfaceLinks<T>*> wanted_;
  Mirror<GroupToMap> groups_{device_};
  Mirror<SurfaceToMap<T>> surfaces_{device_};
  Mirror<lbm::ResistanceSums> resistance_{device_};
  Mirror<rigid::SurfacePart<T>> parts_{device_};
  Mirror<rigid::Plane<T>> planes_{device_};
  Mirror<ChangedWord> words_{device_};
  Mirror<HostCopy> runs_{device_};
  Mirror<std::uint32_t> told_{device_};
};

SILT_DEVICES(template <class T> void map_links(const LinksToMap<T>&);)

}  // namespace silt::coupler
