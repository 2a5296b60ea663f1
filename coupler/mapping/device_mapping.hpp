#pragma once
// Builds the links of a block's bodies by passes of a device (device/for_each.hpp): counts the links of each
// kind from the bits of bodies, then lists them, and sets wall distances, their rates, and the resistance of
// bodies with convex parts, one team per group of links. Only changed bits and poses are sent to the device;
// only the counts and the resistance come back.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "coupler/mapping/bit_window.hpp"
#include "coupler/mapping/block_links.hpp"
#include "coupler/mapping/cell_bits.hpp"
#include "device/mirror.hpp"
#include "lbm/walls/places_across.hpp"
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

/// The kinds of links that follow from the solid bits: the scheme's own; in gaps of one and of two cells;
/// with the cell behind in another block.
enum class LinkKind : std::uint8_t { own, single_cell, two_cells, across, count };
inline constexpr int link_kinds = int(LinkKind::count);
using KindCounts = std::array<std::uint32_t, link_kinds>;

/// The bits of a surface on a device: the cells that it covers.
struct MaskToMap {
  BitFrame frame;
  std::uint64_t* cells;
};

/// The planes of a mask, from `z` on, that the places of one group can reach.
struct SlabToMap {
  static constexpr int most_planes = 1 << lbm::place_z_bits;
  std::uint32_t mask;
  std::int16_t z, planes;
};

/// The scheme of a block and the room that links of a surface have taken in its arrays so far.
struct LinkRoom {
  lbm::WallScheme scheme;
  std::uint32_t used = 0, gaps = 0, across = 0;  // of place and q; of opposite_q; of CutLinks::across
  SILT_DEVICE lbm::LinkGroup group(std::uint32_t count, lbm::WallScheme of, lbm::Int3 corner, int ready) {
    const lbm::LinkGroup g{used, count, of, corner, ready, gaps};
    used += lbm::padded(count);
    if (of == lbm::WallScheme::single_cell_gap && lbm::knows_opposite_wall(scheme))
      gaps += lbm::padded(count);
    return g;
  }
  SILT_DEVICE lbm::LinkGroup group_across(std::uint32_t count, lbm::Int3 corner, int ready) {
    lbm::LinkGroup g = group(count, scheme, corner, ready);
    g.across = true, g.across_begin = across;
    across += lbm::padded(count);
    return g;
  }
  /// Returns the group of links that a device counts from a corner on.
  SILT_DEVICE lbm::LinkGroup group(LinkKind kind, std::uint32_t count, lbm::Int3 corner) {
    if (kind == LinkKind::across) return group_across(count, corner, -1);
    return group(count,
                 kind == LinkKind::own           ? scheme
                 : kind == LinkKind::single_cell ? lbm::WallScheme::single_cell_gap
                                                 : lbm::two_cell_gap_scheme(scheme),
                 corner, -1);
  }
};

/// Where the links of a slab are listed: their first places by kind, the first indices of their pairs across.
struct SlabLists {
  std::uint32_t *place[link_kinds], *across;
};

/// The orientation of a surface at one time, and the first of its turned parts.
struct TurnedSurface {
  std::uint32_t turn, first_part;
};

template <class T>
struct SurfaceToMap {
  MappedSurface<T>* surface;  // its groups: of its slabs, then those of crossing links, which are given
  lbm::SurfaceFrame frame;    // at the middle of the mapping's steps
  double last_offset[3];      // of the frame in the last of them
  double steps;               // from the middle to the last; 0: distances have no rates
  T arm;                      // 2^-exponent of the resistance; 0: not needed
  TurnedSurface now, last;
  std::uint32_t first_slab, slabs;
  std::uint32_t first_group, group_count;  // among all groups
};

struct GroupToMap {
  std::uint32_t surface, number;
};

/// A word of bits and its address.
struct NewWord {
  std::uint64_t *at, bits;
};
/// The cells of a mask some of which change, and with it the solid cells of the block; or the latter alone.
/// `flips` from `first` on are indices of their bits.
struct FlippedBits {
  static constexpr std::uint32_t solid_alone = ~0u;
  std::uint32_t mask, first, count;
};
/// The cells of a surface move to another frame, with those that lie in both.
struct MovedFrame {
  BitFrame from, to;
  const std::uint64_t* old;
  std::uint64_t* cells;
};

/// A run of 32-bit words that the host has listed, to be copied to a device array.
struct HostCopy {
  std::uint32_t* to;
  std::uint32_t first, count;
};

/// The bits of a block and the slabs of its surfaces whose links are counted and listed.
struct BitsToMap {
  const NewWord* words;
  std::size_t word_count;
  const MovedFrame* moved;
  std::size_t moved_count;
  const FlippedBits* flipped;
  std::size_t flipped_count;
  const std::uint32_t* flips;
  const MaskToMap* masks;
  const SlabToMap* slabs;
  std::size_t slab_count;
  KindCounts* counts;    // per slab
  std::uint64_t* solid;  // CellBits of the block
  lbm::Int3 size;
  int solid_words;  // per row
  lbm::WallScheme scheme;
  lbm::Components directions = lbm::components<lbm::D3Q19>;
};

/// The arrays of the passes that list and measure links.
template <class T>
struct LinksToMap {
  BitsToMap bits;
  SlabLists* lists;  // per slab
  lbm::PlacesAcross<lbm::D3Q19> pairs;
  GroupToMap* groups;
  std::size_t group_count;
  const SurfaceToMap<T>* surfaces;
  std::size_t surface_count;
  lbm::ResistanceSums* resistance;  // per surface
  const rigid::Turn* turns;
  rigid::SurfacePart<T>* turned;
  const HostCopy* runs;
  std::size_t run_count;
  const std::uint32_t* told;
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
  /// Queues a surface whose links shall be counted. `before` is the mask of its last links, if any.
  void add_mask(SurfaceLinks<T>&, const BodyMask&, const BodyMask* before);
  /// Counts the links of all these surfaces.
  void count();
  /// Calls visit(z, counts) for the slabs of the n-th of them; z is the first plane in its frame.
  template <class Visit>
  void for_slabs(std::size_t n, Visit&& visit) const {
    for (std::uint32_t k = first_slab_[n]; k < first_slab_[n + 1]; ++k)
      visit(slabs_.host()[k].z, counts_.host()[k]);
  }
  /// Queues the n-th of them, with groups for the counts of its slabs: lists its links, sets wall distances,
  /// and the resistance. `arm` is SurfaceToMap::arm.
  void add(SurfaceLinks<T>&, std::size_t n, const rigid::ShapeView<T>&, const rigid::Turn&, T arm);
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
  /// Queues the rates of the surface added last, from its orientation and its frame after `steps` steps.
  void add_rates(const rigid::Turn&, const lbm::SurfaceFrame&, double steps);
  /// Queues what the device has yet to know of a surface, whose links it lists or not.
  void tell(SurfaceLinks<T>&, const rigid::ShapeView<T>&, bool lists);
  /// Runs all that was queued. The surfaces must not have moved in memory.
  void run();

 private:
  TurnedSurface turned(const rigid::Turn&, int parts);
  void clear() {
    const auto all = [](auto&... lists) { (lists.host().clear(), ...); };
    all(masks_, slabs_, counts_, surfaces_, turns_, words_, moved_, flipped_, flips_, runs_, told_);
    left_.clear(), group_count_ = part_count_ = 0;
  }
  void add_words(std::uint64_t* to, const std::uint64_t* now, std::size_t count);
  void end_flips(std::uint32_t mask);

  Device device_;
  const BlockMap* map_ = nullptr;
  lbm::WallScheme scheme_{};
  DeviceArray<std::uint64_t> solid_{memory_of(device_)};
  BitsToMap bits_{};
  Mirror<MaskToMap> masks_{device_};
  Mirror<SlabToMap> slabs_{device_};
  std::vector<std::uint32_t> first_slab_;  // per mask, and the end of the last
  Mirror<KindCounts> counts_{device_};
  DeviceArray<SlabLists> lists_{memory_of(device_)};
  DeviceArray<GroupToMap> groups_{memory_of(device_)};
  std::uint32_t group_count_ = 0;
  std::vector<SurfaceLinks<T>*> wanted_;
  Mirror<SurfaceToMap<T>> surfaces_{device_};
  Mirror<lbm::ResistanceSums> resistance_{device_};
  Mirror<rigid::Turn> turns_{device_};
  DeviceArray<rigid::SurfacePart<T>> turned_{memory_of(device_)};
  std::uint32_t part_count_ = 0;
  Mirror<NewWord> words_{device_};
  Mirror<MovedFrame> moved_{device_};
  Mirror<FlippedBits> flipped_{device_};
  Mirror<std::uint32_t> flips_{device_};
  CellBits changed_;                              // solid cells that no mask's flips tell
  std::vector<DeviceArray<std::uint64_t>> left_;  // cells in frames of before
  Mirror<HostCopy> runs_{device_};
  Mirror<std::uint32_t> told_{device_};
};

SILT_DEVICES(void count_links(const BitsToMap&); template <class T> void map_links(const LinksToMap<T>&);)

}  // namespace silt::coupler
