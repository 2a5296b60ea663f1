#pragma once
// Builds the links of a block's bodies by passes of a device (device/for_each.hpp): marks the cells of bodies
// with convex parts from their poses, counts the links of each kind from these bits, then lists them, and
// sets wall distances, their rates, and the resistance, one team per group of links. Only poses are sent to
// the device; only the counts and the resistance come back.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coupler/mapping/bit_kernel.hpp"
#include "coupler/mapping/bit_window.hpp"
#include "coupler/mapping/block_links.hpp"
#include "coupler/mapping/cell_bits.hpp"
#include "device/mirror.hpp"
#include "lbm/walls/places_across.hpp"
#include "rigid/shapes/surface_kinds.hpp"

namespace silt::rigid {
template <class T>
class SurfaceParts;
}

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

/// The kinds of links: of the scheme itself; those for which it cannot be used, or not from memory of the
/// block, with a cell behind that is not fluid, a second cell behind that is not fluid, or a cell behind in
/// another block; those that cross an edge of the body. All but the last follow from the solid bits.
enum class LinkKind : std::uint8_t { own, single_cell, two_cells, across, crossing };
inline constexpr int link_kinds = int(LinkKind::crossing);  // that follow from the solid bits
using KindCounts = std::array<std::uint32_t, link_kinds>;

/// The cells that a surface covers, in memory of a device: words of bits, after the frame that they have.
class CellsOnDevice {
 public:
  static constexpr std::size_t before_words = sizeof(BitFrame) / sizeof(std::uint64_t);
  /// Returns the words in memory for a frame: one after the last may be read.
  static std::size_t size(const BitFrame& frame) { return before_words + frame.words() + 1; }

  CellsOnDevice() = default;
  explicit CellsOnDevice(std::uint64_t* memory) : memory_(memory) {}
  SILT_DEVICE bool exist() const { return memory_; }
  SILT_DEVICE BitFrame& frame() const { return *reinterpret_cast<BitFrame*>(memory_); }
  SILT_DEVICE std::uint64_t* words() const { return memory_ + before_words; }

 private:
  std::uint64_t* memory_ = nullptr;
};
static_assert(sizeof(BitFrame) % sizeof(std::uint64_t) == 0);

/// The planes of a surface's frame, from `z` on, that the places of one group can reach.
struct SlabToMap {
  static constexpr int most_planes = 1 << lbm::place_z_bits;
  std::uint32_t surface;
  std::int16_t z, planes;
};
/// Planes in which links may begin that cross edges of a surface, and end one plane outside. Which cells are
/// next to the surface is kept from `first_near` on, 64 cells of a row to a word.
struct EdgeSlab {
  static constexpr int most_planes = SlabToMap::most_planes - 2;
  SlabToMap planes;
  std::uint32_t first_near;
};
/// Returns the words of each row of such cells.
SILT_DEVICE inline int near_words(const BitFrame& frame) {
  return (frame.size.x + 63) / 64;
}
/// Returns the first slab of a surface, or of a later one.
SILT_DEVICE inline std::size_t first_slab_of(std::uint32_t surface, std::span<const EdgeSlab> slabs) {
  std::size_t first = 0, end = slabs.size();
  while (first < end) {
    const std::size_t middle = (first + end) / 2;
    if (slabs[middle].planes.surface < surface)
      first = middle + 1;
    else
      end = middle;
  }
  return first;
}

/// The scheme of a block and the room that links of a surface have taken in its arrays so far.
struct LinkRoom {
  lbm::WallScheme scheme;
  std::uint32_t used = 0, gaps = 0, across = 0;  // of place and q; of opposite_q; of CutLinks::across
  /// Returns the next group; a crossing link has a scheme that reads at most the cell behind, which is fluid.
  SILT_DEVICE lbm::LinkGroup group(LinkKind kind, std::uint32_t count, lbm::Int3 corner, int ready) {
    const bool in_gap = kind == LinkKind::single_cell,
               own = kind == LinkKind::own || kind == LinkKind::across;
    lbm::LinkGroup g{used, count, scheme, corner, ready, gaps};
    if (!own) g.scheme = in_gap ? lbm::WallScheme::single_cell_gap : lbm::two_cell_gap_scheme(scheme);
    g.crossing = kind == LinkKind::crossing, g.across = kind == LinkKind::across;
    used += lbm::padded(count);
    if (in_gap && lbm::knows_opposite_wall(scheme)) gaps += lbm::padded(count);
    if (g.across) g.across_begin = across, across += lbm::padded(count);
    return g;
  }
};

/// The crossing links that begin in a slab: those with both ends in the block, and others.
struct CrossingCounts {
  std::uint32_t pairs, single;
  SILT_DEVICE std::uint32_t links() const { return 2 * pairs + single; }
};

/// Where the links of a slab are listed: their first places by kind, the first indices of their pairs across.
struct SlabLists {
  std::uint32_t *place[link_kinds], *across;
};

/// The orientation of a surface at one time, and the first of its turned parts.
struct TurnedSurface {
  std::uint32_t turn, first_part;
};

/// How a device marks the cells of a surface: as those of a ball, or of any parts; or the processor does.
enum class Marking : std::uint8_t { ball, parts, told };

/// A surface that a device maps: its pose, from which the device finds its cells, its links and their
/// distances.
template <class T>
struct SurfaceToMap {
  MappedSurface<T>* surface;    // its groups: of its slabs, then those of crossing links
  BitFrame frame;               // of its cells now
  CellsOnDevice cells, before;  // those of the last mapping, if any, may have the same memory
  PointInFrame centre;          // at the middle of the mapping's steps
  double velocity[3];
  double middle, steps;  // of the mapping's steps; from there to the last; 0: distances have no rates
  T arm;                 // 2^-exponent of the resistance; 0: not needed
  Marking marking;
  TurnedSurface now, last;
  std::uint32_t first_slab, slabs;
};

/// A surface with links, by its number, and the first of its groups among those of all.
struct ListedToMap {
  std::uint32_t surface, first_group;
};
struct GroupToMap {
  std::uint32_t listed, number;
};

/// A word of bits and its address.
struct NewWord {
  std::uint64_t *at, bits;
};
/// Cells that change, of a surface or, if it is none, the solid cells of the block: `flips` from `first` on
/// are indices of their bits.
struct FlippedBits {
  static constexpr std::uint32_t no_surface = ~0u;
  std::uint32_t surface, first, count;
};

/// A run of 32-bit words that the host has listed, to be copied to a device array.
struct HostCopy {
  std::uint32_t* to;
  std::uint32_t first, count;
};

struct HostCopies {
  std::span<const HostCopy> runs;
  const std::uint32_t* values;
};

/// CellBits of a block.
struct SolidBits {
  std::uint64_t* words;
  lbm::Int3 size;
  int words_a_row;
  /// Returns 64 cells of a row from a cell on.
  SILT_DEVICE std::uint64_t from(lbm::Int3 x) const {
    return CellBits::from(words + CellBits::row(size, x.y, x.z, words_a_row), x.x);
  }
};

/// The surfaces of a block that are mapped: their cells are marked, and the links of their slabs counted.
template <class T>
struct CellsToMap {
  HostCopies told;
  std::span<const SurfaceToMap<T>> surfaces;
  std::span<const CellsOnDevice> gone;  // of surfaces that the device no longer maps
  std::span<const NewWord> words;
  std::span<const FlippedBits> flipped;
  const std::uint32_t* flips;
  const rigid::Turn* turns;
  std::span<const SlabToMap> slabs;
  KindCounts* counts;                    // per slab
  std::span<const EdgeSlab> edge_slabs;  // in the order of surfaces
  CrossingCounts* crossings;             // per slab of these
  std::uint64_t* near;                   // of all of these slabs
  rigid::SurfacePart<T>* turned;
  SolidBits solid;
  lbm::WallScheme scheme;
  lbm::Components directions = lbm::components<lbm::D3Q19>;
};

/// The arrays of the passes that list and measure links.
template <class T>
struct LinksToMap {
  CellsToMap<T> cells;
  HostCopies told;
  SlabLists* lists;  // per slab
  lbm::PlacesAcross<lbm::D3Q19> pairs;
  std::span<const ListedToMap> listed;
  std::span<GroupToMap> groups;
  lbm::ResistanceSums* resistance;  // per listed surface
  std::uint32_t** edge_places;      // the first place of the links of each edge slab
};

/// The mapping of one block by its device; does nothing for `cpu`.
template <class T>
class DeviceMapping {
 public:
  explicit DeviceMapping(Device device) : device_(device) {}
  Device device() const { return device_; }
  bool has_links() const { return device_ != Device::cpu; }

  /// Call first.
  void begin(const BlockMap&, lbm::WallScheme);
  /// Tells the device the parts of a surface, before it is first mapped.
  void tell_shape(SurfaceLinks<T>&, const rigid::SurfaceParts<T>&, const rigid::SurfaceParts<double>&);
  /// Queues a surface, whose cells shall be marked and its links counted; the caller sets what depends on its
  /// motion. The device turns the parts at `turn`.
  SurfaceToMap<T>& add(SurfaceLinks<T>&, const BodyMask&, Marking, const rigid::Turn&);
  /// Sets an orientation of the surface added last.
  TurnedSurface turned(const SurfaceLinks<T>&, const rigid::Turn&);
  /// Queues the changes of a surface whose links the processor lists, or which is none any more (`now` null).
  void change(SurfaceLinks<T>&, const BodyMask* now, const BodyMask* before);
  /// Marks the cells of all these surfaces, and counts their links.
  void count();
  /// Calls visit(z, counts) for the slabs of the n-th surface; z is the first plane in its frame.
  template <class Visit>
  void for_slabs(std::size_t n, Visit&& visit) const {
    const SurfaceToMap<T>& surface = surfaces_.host()[n];
    for (std::uint32_t k = surface.first_slab; k < surface.first_slab + surface.slabs; ++k)
      visit(slabs_.host()[k].z, counts_.host()[k]);
  }
  /// Calls visit(z, number of links) for its slabs of crossing links.
  template <class Visit>
  void for_edge_slabs(std::uint32_t n, Visit&& visit) const {
    const std::pmr::vector<EdgeSlab>& slabs = edge_slabs_.host();
    for (std::size_t k = first_slab_of(n, slabs); k < slabs.size() && slabs[k].planes.surface == n; ++k)
      visit(slabs[k].planes.z, crossings_.host()[k].links());
  }
  /// Queues the n-th surface, which has groups for the counts of its slabs: lists its links, sets wall
  /// distances, their rates and the resistance.
  void list(SurfaceLinks<T>&, std::uint32_t n);
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
  /// Queues what the device has yet to know of the links of a surface: measured by the processor at some
  /// time, or found by the device.
  void tell(SurfaceLinks<T>&, std::optional<double> measured);
  /// Runs all that was queued. The surfaces must not have moved in memory.
  void run();

 private:
  void clear() {
    const auto all = [](auto&... lists) { (lists.host().clear(), ...); };
    all(surfaces_, gone_, turns_, slabs_, counts_, words_, flipped_, flips_, runs_, told_, listed_);
    all(edge_slabs_, crossings_);
    left_.clear(), wanted_.clear(), group_count_ = part_count_ = near_count_ = 0;
  }
  void tell_shape(SurfaceLinks<T>&, const typename MappedSurface<T>::Shape&);
  void add_words(std::uint64_t* to, const std::uint64_t* now, std::size_t count);
  void end_flips(std::uint32_t surface);
  HostCopies send_told() { return {{runs_.send(), runs_.size()}, told_.send()}; }

  Device device_;
  const BlockMap* map_ = nullptr;
  DeviceArray<std::uint64_t> solid_{memory_of(device_)};
  CellBits changed_;  // solid cells that the processor tells
  bool tells_all_ = false, tells_some_ = false;
  CellsToMap<T> cells_{};
  Mirror<SurfaceToMap<T>> surfaces_{device_};
  Mirror<CellsOnDevice> gone_{device_};
  std::vector<DeviceArray<std::uint64_t>> left_;  // of cells before
  Mirror<rigid::Turn> turns_{device_};
  DeviceArray<rigid::SurfacePart<T>> turned_{memory_of(device_)};
  Mirror<SlabToMap> slabs_{device_};
  Mirror<KindCounts> counts_{device_};
  DeviceArray<SlabLists> lists_{memory_of(device_)};
  DeviceArray<GroupToMap> groups_{memory_of(device_)};
  Mirror<EdgeSlab> edge_slabs_{device_};
  Mirror<CrossingCounts> crossings_{device_};
  DeviceArray<std::uint64_t> near_{memory_of(device_)};
  DeviceArray<std::uint32_t*> edge_places_{memory_of(device_)};
  std::uint32_t group_count_ = 0, part_count_ = 0, near_count_ = 0;
  std::vector<SurfaceLinks<T>*> wanted_;  // as listed_
  Mirror<ListedToMap> listed_{device_};
  Mirror<lbm::ResistanceSums> resistance_{device_};
  Mirror<NewWord> words_{device_};
  Mirror<FlippedBits> flipped_{device_};
  Mirror<std::uint32_t> flips_{device_};
  Mirror<HostCopy> runs_{device_};
  Mirror<std::uint32_t> told_{device_};
};

/// Returns the frame some steps later, of a surface that moves on.
SILT_DEVICE inline lbm::SurfaceFrame frame_after(lbm::SurfaceFrame frame, const double (&velocity)[3],
                                                 double steps) {
  for (int d = 0; d < 3; ++d) frame.offset[d] -= steps * velocity[d];
  return frame;
}

/// Returns the frame of a surface's reference point from the cells that it covers; in all blocks its offset
/// is the same. `whole` is not set.
SILT_DEVICE inline lbm::SurfaceFrame surface_frame(const BitFrame& cells, const PointInFrame& centre) {
  lbm::SurfaceFrame frame{};
  const double at[3] = {centre.x, centre.y, centre.z};
  double square = 0;
  for (int d = 0; d < 3; ++d) {
    const int cell = int(std::floor(at[d])), low = cells.low[d], high = low + cells.size[d];
    frame.cell[d] = cell + low - centre.low[d];
    frame.offset[d] = (cell + 0.5) - at[d];
    const double far = std::max(std::abs(low - frame.cell[d]), std::abs(high - frame.cell[d])) + 1;
    square += far * far;
  }
  frame.reach = std::sqrt(square);
  return frame;
}

SILT_DEVICES(template <class T> void count_links(const CellsToMap<T>&);
             template <class T> void map_links(const LinksToMap<T>&);)

}  // namespace silt::coupler
