#pragma once
// The links of bodies of a block that are mapped again, as passes of a device (device/for_each.hpp): their
// lists by the cells that bodies cover, then wall distances, their rates and the resistance of bodies of
// convex parts, a team a group of links. Of the cells the device is told those that have changed.
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

/// A distance changes by at most this in half of the steps that a body is mapped for: a line that grazes the
/// surface may meet it at one time only.
inline constexpr double most_change = 0.25;

/// The rate of a distance which is `middle` in the middle of these steps, and `last` so many steps later.
/// Wall formulas amplify where a surface has come past a cell, q < 0: for a few steps they may.
template <class T>
SILT_DEVICE inline T rate_of(T middle, T last, double steps) {
  constexpr double few = 4;
  const T least = steps > few ? T(0) : T(-0.1), per_step = T(1 / steps);
  const T largest = T(most_change), most = std::min(largest, middle - least);
  return std::clamp(last - middle, -most, most) * per_step;
}

/// A group whose links are all of a kind that the cells around them tell: those of the open cells of rows
/// [y0, y1) of some planes of a mask's frame.
struct ListedGroup {
  std::uint32_t number;  // of the surface's groups
  std::uint16_t y0, y1;
  std::uint8_t planes;
  bool rim;
};

/// A surface at a time: where its parts and planes begin, and its frame.
struct SurfaceAtTime {
  std::uint32_t first_part, first_plane;
  int parts;
  lbm::SurfaceFrame frame;
};

template <class T>
struct SurfaceToMap {
  lbm::WallFluid<T> fluid;
  SurfaceAtTime now, last;  // in the middle of the steps that it is mapped for, and in the last of them
  double steps;             // between; 0: distances have no rates
  T arm;                    // of the resistance (resistance_exponent); 0: nobody asks for it
  BitFrame frame;
  const std::uint64_t* cells;  // of the surface, in its frame
  std::uint32_t* place;
  T *q, *rate;
};

struct GroupToMap {
  std::uint32_t surface, begin, count;
  lbm::Int3 corner;
  lbm::WallScheme scheme;
  bool crossing;       // whose distances are known
  ListedGroup listed;  // of no planes: its links are
};

/// A word of bits that has changed.
struct ChangedWord {
  std::uint64_t *at, bits;
};

/// What the processor has listed goes to an array, in words of 32 bits.
struct HostCopy {
  std::uint32_t* to;
  std::uint32_t first, count;
};

/// The passes read and write these arrays.
template <class T>
struct LinksToMap {
  const GroupToMap* groups;
  std::size_t group_count;
  const SurfaceToMap<T>* surfaces;
  lbm::ResistanceSums* resistance;  // of the surfaces
  const rigid::SurfacePart<T>* parts;
  const rigid::Plane<T>* planes;
  const ChangedWord* words;
  std::size_t word_count;
  const HostCopy* runs;
  std::size_t run_count;
  const std::uint32_t* told;
  const std::uint64_t* solid;  // CellBits of the block
  lbm::Int3 size;
  int solid_words;  // of a row
  lbm::WallScheme scheme;
  lbm::Components directions = lbm::components<lbm::D3Q19>;
};

/// The mapping of one block on its device, which is to have the block's links unless it is `cpu`.
template <class T>
class DeviceMapping {
 public:
  explicit DeviceMapping(Device device) : device_(device) {}
  Device device() const { return device_; }
  bool has_links() const { return device_ != Device::cpu; }

  /// Begins with the cells of the block.
  void begin(const BlockMap&, lbm::WallScheme);
  /// The links of the surface are wanted: the lists of some groups, and all distances. `before` is the mask
  /// of which it had links, if it had any; `arm` that of SurfaceToMap.
  void add(SurfaceLinks<T>&, const BodyMask&, const BodyMask* before, std::span<const ListedGroup>,
           const rigid::SurfaceView<T>&, T arm);
  /// These values go to an array in memory_of the device.
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
  /// The rates of the surface added last are wanted as well, from how it will be after so many steps.
  void add_rates(const rigid::SurfaceView<T>&, const lbm::SurfaceFrame&, double steps);
  /// Sets all that is wanted. The surfaces have stayed where they were.
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
