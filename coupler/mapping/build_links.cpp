#include "coupler/mapping/build_links.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/bit_kernels.hpp"
#include "coupler/mapping/crossing_links.hpp"
#include "coupler/mapping/distance_rates.hpp"
#include "coupler/mapping/surface_parts.hpp"
#include "coupler/mapping/window_rows.hpp"
#include "lbm/pass_order.hpp"
#include "lbm/places_across.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

namespace {

/// Planes [z, z + count) of a frame.
struct Planes {
  int z, count;
};

/// Whether some fluid cell next to the body may lie within `rim` cells of the block's faces, or in another
/// block.
bool touches_rim(const BitFrame& f, Int3 block, int rim) {
  for (int d = 0; d < 3; ++d)
    if (f.low[d] < rim - 1 || f.low[d] + f.size[d] > block[d] - (rim - 1)) return true;
  return false;
}

/// What is done with each body's mask, and what is kept for the next one: no allocation once grown.
template <class T>
class LinkWriter {
 public:
  LinkWriter(const BlockMap& map, const lbm::PassOrder& sweep, WallScheme scheme, MeshDistances& meshes)
      : map_(map),
        sweep_(sweep),
        scheme_(scheme),
        reach_(lbm::link_reach(scheme)),
        places_across_(map.box.size),
        mesh_(meshes) {
    for (auto& kinds : deferred_) {
      kinds[single_cell].scheme = WallScheme::single_cell_gap;
      kinds[two_cells].scheme = lbm::two_cell_gap_scheme(scheme);
      kinds[across].scheme = scheme;
    }
  }

  /// The links' frame is set already.
  void body(const BodyMask& mask, const rigid::Shape& shape, const MappedMotion& mapped,
            lbm::CutLinks<T>& links) {
    mask_ = &mask, links_ = &links;
    links.groups.clear(), links.across.clear(), used_ = 0;
    if (mask.any) write(shape);
    links.place.assign(place_.begin(), place_.begin() + used_);
    links.q.assign(q_.begin(), q_.begin() + used_);
    set_distance_rates(links, shape, mapped, surface_);
  }

 private:
  void write(const rigid::Shape& shape) {
    const BitFrame& frame = mask_->frame();
    if (frame.pitch > 1 << lbm::place_x_bits || frame.size.y > 1 << lbm::place_y_bits)
      throw std::invalid_argument(
          "a body or wall of more than 4096 cells across a block; use smaller domain.blocks");
    if (scheme_ != WallScheme::bounce_back) prepare_surface(shape);
    const Int3 n = map_.box.size;
    solid_.reset(frame);
    fill_rows(solid_, n, 1, [&](int x, int y, int z) { return map_.solid.from(x, y, z); });
    const bool at_rim = touches_rim(frame, n, reach_);
    find_open(at_rim);
    constexpr int words_a_group = 16;  // of small bodies: enough links to be worth a group
    const int step = std::clamp(words_a_group / frame.plane, 1, 1 << lbm::place_z_bits);
    for (int z = 1; z < frame.size.z - 1; z += step) {
      const Planes planes{z, std::min(step, frame.size.z - 1 - z)};
      const std::size_t most = bits_in(z - 1, z + planes.count + 1);
      if (most == 0) continue;
      inner_groups(planes, most);
      if (at_rim) group(planes, 1, frame.size.y - 1, rim_, most, -1);
    }
    for (auto& kinds : deferred_)
      for (Deferred& deferred : kinds) end_group(deferred);
    if (scheme_ != WallScheme::bounce_back && !is_tube_ && !is_mesh_ && surface_.has_edges())
      crossing_groups();
  }

  /// Each from both ends, with schemes that read no further than the cell behind, which is fluid.
  void crossing_groups() {
    const BitFrame& frame = mask_->frame();
    crossings_.find_cells(map_, *mask_);
    for (int z = 1; z < frame.size.z - 1; z += CrossingLinks<T>::planes) {
      crossings_.list(z, links_->frame, surface_.view());
      const std::size_t n = crossings_.place().size();
      if (n == 0) continue;
      make_room(n);
      std::copy_n(crossings_.place().data(), n, place_.begin() + used_);
      std::copy_n(crossings_.q().data(), n, q_.begin() + used_);
      end_group(std::uint32_t(n), frame.low + Int3{0, 0, z - 1}, lbm::two_cell_gap_scheme(scheme_), -1);
      links_->groups.back().crossing = true;
    }
  }

  /// Fluid cells inside the block, those at its rim apart: within a link's reach of ghost cells. Cells of
  /// other blocks are in neither.
  void find_open(bool at_rim) {
    const BitFrame& frame = mask_->frame();
    const Int3 n = map_.box.size;
    const int r = reach_;
    inner_.reset(frame);
    if (!at_rim) {
      for (std::size_t k = 0; k < frame.words(); ++k) inner_.words()[k] = ~solid_.words()[k];
      return;
    }
    rim_.reset(frame);
    fill_rows(inner_, n, 1, [&](int x, int y, int z) {
      if (y < r || z < r || y >= n.y - r || z >= n.z - r) return std::uint64_t{0};
      return ~map_.solid.from(x, y, z) & cells_between(x, r, n.x - r);
    });
    fill_rows(rim_, n, 1, [&](int x, int y, int z) {
      if (y < 0 || z < 0 || y >= n.y || z >= n.z) return std::uint64_t{0};
      const bool side = y < r || z < r || y >= n.y - r || z >= n.z - r;
      const std::uint64_t all = cells_between(x, 0, n.x), inner = cells_between(x, r, n.x - r);
      return ~map_.solid.from(x, y, z) & (side ? all : all & ~inner);
    });
  }

  /// A group for each strip of the dense pass.
  void inner_groups(Planes planes, std::size_t most) {
    const BitFrame& frame = mask_->frame();
    const int last = std::min(frame.low.z + planes.z + planes.count, map_.box.size.z - reach_) - 1;
    if (last < reach_) return;
    const int first = std::max(frame.low.y + 1, reach_),
              end = std::min(frame.low.y + frame.size.y - 1, map_.box.size.y - reach_);
    for (int y = first; y < end;) {
      const int next = std::min(sweep_.next_row(y, reach_), end);
      group(planes, y - frame.low.y, next - frame.low.y, inner_, most, sweep_.ready(y, last, reach_));
      y = next;
    }
  }

  /// The links of the open cells in rows [y0, y1) of some planes; `most`: of one direction.
  void group(Planes planes, int y0, int y1, const BitWindow& open, std::size_t most, int ready) {
    const BitFrame& frame = mask_->frame();
    const Int3 corner = frame.low + Int3{0, 0, planes.z};
    auto& kinds = deferred_[ready < 0];
    for (Deferred& deferred : kinds)  // whose places cannot count so many planes
      if (corner.z + planes.count - deferred.corner.z > 1 << lbm::place_z_bits) end_group(deferred);
    const std::size_t room = lbm::directions * most + 3 * lbm::link_lanes;
    if (single_cell_.size() < room) single_cell_.resize(room);
    make_room(lbm::directions * most);
    std::uint32_t* const place = place_.data() + used_;
    const LinkBits bits{mask_->bits.words(), solid_.words(), open.words(), lbm::reads_behind(scheme_)};
    const LinkCounts found =
        bit_kernels().list_links(frame, {planes.z, planes.count, y0, y1}, bits, place, single_cell_.data());
    const std::uint32_t n = found.clear + found.single_cell, end = lbm::padded(n);
    if (n == 0) return;
    std::copy_n(single_cell_.data(), found.single_cell, place + found.clear);
    std::fill(place + n, place + end, place[n - 1]);
    T* const q = q_.data() + used_;
    set_distances(corner, place, n, q);
    for (std::uint32_t k = found.clear; k < n; ++k) kinds[single_cell].add(corner, place[k], q[k], ready);
    std::uint32_t clear = found.clear;
    if (lbm::reads_beyond(scheme_)) clear = defer_gaps_and_pairs(clear, corner, ready);
    end_group(clear, corner, scheme_, ready);
  }

  /// Of the first n links at `used_`, whose cell behind is fluid, defers those that must not read beyond
  /// it or cannot do so in the block's memory. Returns how many stay.
  std::uint32_t defer_gaps_and_pairs(std::uint32_t n, Int3 corner, int ready) {
    auto& kinds = deferred_[ready < 0];
    std::uint32_t* const place = place_.data() + used_;
    T* const q = q_.data() + used_;
    beyond_.resize(std::max<std::size_t>(beyond_.size(), n));
    std::uint32_t left = n;
    for (std::uint32_t m = bit_kernels().list_beyond(place, n, corner, map_.solid, beyond_.data());
         m-- > 0;) {
      const std::uint32_t k = beyond_[m];
      const Int3 cell = corner + lbm::place_cell(place[k]);
      const int i = lbm::place_direction(place[k]);
      if (map_.solid.test(cell - lbm::c[i] - lbm::c[i])) {
        kinds[two_cells].add(corner, place[k], q[k], ready);
      } else {
        kinds[across].add(corner, place[k], q[k], ready);
        kinds[across].pair.push_back(places_across_(cell, i));
      }
      --left;
      place[k] = place[left], q[k] = q[left];
    }
    return left;
  }

  /// Some links are few: those of planes that follow one another share a group.
  struct Deferred {
    WallScheme scheme;
    std::vector<std::uint32_t> place, pair;  // pair: of CutLinks::across
    std::vector<T> q;
    Int3 corner;
    int ready = -1;

    /// The place counts from a corner that is no lower than that of the links before.
    void add(Int3 from, std::uint32_t link, T distance, int part) {
      if (place.empty()) corner = from;
      place.push_back(link + lbm::link_place({0, 0, from.z - corner.z}, 0));
      q.push_back(distance);
      ready = std::max(ready, part);
    }
  };
  enum Kind { single_cell, two_cells, across, deferred_kinds };

  void end_group(Deferred& deferred) {
    const std::uint32_t n = std::uint32_t(deferred.place.size());
    if (n == 0) return;
    make_room(n);
    std::copy(deferred.place.begin(), deferred.place.end(), place_.begin() + used_);
    std::copy(deferred.q.begin(), deferred.q.end(), q_.begin() + used_);
    end_group(n, deferred.corner, deferred.scheme, deferred.ready);
    if (!deferred.pair.empty()) {
      lbm::LinkGroup& group = links_->groups.back();
      group.across = true, group.across_begin = std::uint32_t(links_->across.size());
      deferred.pair.resize(lbm::padded(n), deferred.pair.back());
      links_->across.insert(links_->across.end(), deferred.pair.begin(), deferred.pair.end());
    }
    deferred.place.clear(), deferred.pair.clear(), deferred.q.clear(), deferred.ready = -1;
  }

  void make_room(std::size_t links) {
    const std::size_t room = used_ + links + 3 * lbm::link_lanes;
    if (place_.size() < room) place_.resize(room * 3 / 2), q_.resize(place_.size());
  }

  /// What stands at `used_` becomes a group, filled up.
  void end_group(std::uint32_t n, Int3 corner, WallScheme scheme, int ready) {
    if (n == 0) return;
    std::uint32_t* const place = place_.data() + used_;
    T* const q = q_.data() + used_;
    const std::uint32_t end = lbm::padded(n);
    std::fill(place + n, place + end, place[n - 1]), std::fill(q + n, q + end, q[n - 1]);
    links_->groups.push_back({used_, n, scheme, corner, ready});
    used_ += end;
  }

  /// Set bits of the planes [z0, z1) of the mask's frame, as far as there are such: no direction has more
  /// links.
  std::size_t bits_in(int z0, int z1) const {
    const BitFrame& f = mask_->frame();
    const std::uint64_t* const w = mask_->bits.words();
    std::size_t n = 0;
    for (std::size_t k = std::size_t(std::max(z0, 0)) * f.plane;
         k < std::size_t(std::min(z1, f.size.z)) * f.plane; ++k)
      n += std::popcount(w[k]);
    return n;
  }

  /// Tubes in double: they may be far longer than anything else is wide.
  void prepare_surface(const rigid::Shape& shape) {
    is_tube_ = std::holds_alternative<rigid::Tube>(shape);
    is_mesh_ = std::holds_alternative<rigid::Mesh>(shape);
    if (is_mesh_)
      mesh_.find(std::get<rigid::Mesh>(shape), map_, *mask_);
    else if (is_tube_)
      tube_.reset(shape, mask_->pose.orientation);
    else
      surface_.reset(shape, mask_->pose.orientation);
  }

  void set_distances(Int3 corner, const std::uint32_t* place, std::uint32_t n, T* q) {
    const int padded = int(lbm::padded(n));
    if (scheme_ == WallScheme::bounce_back)
      std::fill_n(q, n, T(0.5));
    else if (is_mesh_)
      mesh_.set(corner, place, n, q);
    else if (is_tube_)
      distance_kernel<double, T>()(place, padded, links_->frame, corner, tube_.view(), 0.0, q);
    else
      distance_kernel<T, T>()(place, padded, links_->frame, corner, surface_.view(), T(0), q);
  }

  const BlockMap& map_;
  const lbm::PassOrder& sweep_;
  WallScheme scheme_;
  int reach_;  // of a link, in cells
  lbm::PlacesAcross places_across_;
  lbm::CutLinks<T>* links_ = nullptr;  // of the body at work
  const BodyMask* mask_ = nullptr;
  SurfaceParts<T> surface_;
  SurfaceParts<double> tube_;
  MeshDistances& mesh_;
  bool is_tube_ = false, is_mesh_ = false;
  CrossingLinks<T> crossings_;
  BitWindow solid_, inner_, rim_;
  std::vector<std::uint32_t> place_, single_cell_, beyond_;
  std::vector<T> q_;
  std::array<Deferred, deferred_kinds> deferred_[2];  // inside, at the rim
  std::uint32_t used_ = 0;                            // of place_ and q_
};

/// The cell that holds the reference point of an image, and where in it: canonical, whatever the block.
lbm::SurfaceFrame surface_frame(const BlockMap& map, const BodyMask& mask, int link_reach) {
  lbm::SurfaceFrame frame{};
  double square = 0;
  for (int d = 0; d < 3; ++d) {
    const double x = mask.pose.position[d];
    const int cell = int(std::floor(x));
    frame.cell[d] = cell + mask.shift[d] - map.box.lower[d];
    frame.offset[d] = (cell + 0.5) - x;
    const int low = mask.frame().low[d], high = low + mask.frame().size[d];
    const double far = std::max(std::abs(low - frame.cell[d]), std::abs(high - frame.cell[d])) + 1;
    square += far * far;
  }
  frame.reach = std::sqrt(square);
  frame.whole = !touches_rim(mask.frame(), map.box.size, link_reach);
  return frame;
}

template <class T>
void build_links_of_masks(const BlockMap& map, const rigid::World& world, const rigid::BodySet& bodies,
                          const LinkRules<T>& rules, std::vector<SurfaceLinks<T>>& surfaces) {
  std::vector<SurfaceLinks<T>> before(map.masks.size());
  before.swap(surfaces);
  const int link_reach = lbm::link_reach(rules.coupling.wall_scheme);
  PlacedMeshes placed;
  MeshDistances own(placed);
  LinkWriter<T> writer(map, rules.sweep, rules.coupling.wall_scheme, rules.meshes ? *rules.meshes : own);
  for_masks(map.masks, [&](std::size_t k) {
    const BodyMask& mask = map.masks[k];
    if (mask.before >= 0) surfaces[k] = std::move(before[mask.before]);
    if (mask.kept) return;
    lbm::CutLinks<T>& links = surfaces[k].links;
    links.fluid = rules.fluid, links.frame = surface_frame(map, mask, link_reach);
    const std::int32_t shape = bodies.shape[mask.row];
    writer.body(mask, world.shapes[shape], mapped_motion(bodies, mask.row), links);
    if (rules.coupling.time == TimeCoupling::implicit_ && bodies.is_dynamic(mask.row))
      surfaces[k].stiffness = lbm::stiffness_of(links, lbm::stiffness_exponent(world.bounding_radii[shape]));
  });
}

}  // namespace

template <class T>
void build_links(const BlockMap& map, const rigid::World& world, const rigid::BodySet& bodies,
                 const LinkRules<T>& rules, std::vector<SurfaceLinks<T>>& surfaces) {
  build_links_of_masks(map, world, bodies, rules, surfaces);
}

template void build_links(const BlockMap&, const rigid::World&, const rigid::BodySet&,
                          const LinkRules<float>&, std::vector<SurfaceLinks<float>>&);
template void build_links(const BlockMap&, const rigid::World&, const rigid::BodySet&,
                          const LinkRules<double>&, std::vector<SurfaceLinks<double>>&);

}  // namespace silt::coupler
