#pragma once
// Sorts the links of a surface into groups.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "coupler/mapping/device_mapping.hpp"
#include "lbm/walls/cut_links.hpp"

namespace silt::coupler {

using lbm::WallScheme;

/// Links listed with one corner that wait for the same part of the pass.
template <class T>
struct LinkList {
  lbm::Int3 corner;
  int ready;
  std::uint32_t* place;  // room for whole vectors
  T* q;
  std::uint32_t n = 0;

  void remove(std::uint32_t k) {
    --n;
    place[k] = place[n], q[k] = q[n];
  }
  /// Pads the last vector.
  template <class Value>
  void pad(Value* values) const {
    std::fill(values + n, values + lbm::padded(n), values[n - 1]);
  }
};

/// Links for which the surface's scheme cannot be used, or not from memory of the block: the cell behind is
/// not fluid; the second cell behind is not fluid; the cell behind is in another block. They are few, so
/// links of consecutive planes share a group.
enum class GapKind { single_cell, two_cells, across, count };

template <class T>
class LinkGroups {
 public:
  explicit LinkGroups(WallScheme scheme) : scheme_(scheme) {
    for (auto& kinds : deferred_) {
      kinds[int(GapKind::single_cell)].scheme = WallScheme::single_cell_gap;
      kinds[int(GapKind::two_cells)].scheme = lbm::two_cell_gap_scheme(scheme);
      kinds[int(GapKind::across)].scheme = scheme;
    }
  }

  void begin(lbm::CutLinks<T>& links) {
    links_ = &links;
    links.groups.clear(), across_.clear(), room_ = {scheme_};
  }
  /// Begins a list with room for `room` links in `planes` planes.
  LinkList<T> list(lbm::Int3 corner, int planes, int ready, std::size_t room) {
    for (Deferred& deferred : deferred_[ready < 0])  // if its places cannot reach these planes
      if (corner.z + planes - deferred.corner.z > 1 << lbm::place_z_bits) end_deferred(deferred);
    return list(corner, ready, room);
  }
  /// Adds link k of a list to the deferred group of a kind; `pair` is its index for CutLinks::across.
  void defer(GapKind kind, const LinkList<T>& list, std::uint32_t k, std::uint32_t pair = 0) {
    Deferred& to = deferred_[list.ready < 0][int(kind)];
    if (to.place.empty()) to.corner = list.corner;  // later corners are not lower
    to.place.push_back(list.place[k] + lbm::link_place({0, 0, list.corner.z - to.corner.z}, 0));
    to.q.push_back(list.q[k]);
    if (kind == GapKind::across) to.pair.push_back(pair);
    to.ready = std::max(to.ready, list.ready);
  }
  /// Makes a group of the list begun last.
  void add(const LinkList<T>& list, WallScheme scheme) {
    if (list.n == 0) return;
    list.pad(list.place), list.pad(list.q);
    links_->groups.push_back(room_.group(list.n, scheme, list.corner, list.ready));
  }
  void end_deferred() {
    for (auto& kinds : deferred_)
      for (Deferred& deferred : kinds) end_deferred(deferred);
  }
  /// Adds links with both ends cut, with a scheme that reads at most the cell behind, which is fluid.
  void add_crossing(const std::vector<std::uint32_t>& place, const std::vector<T>& q, lbm::Int3 corner) {
    if (place.empty()) return;
    add(copied(place, q, corner, -1), deferred_[0][int(GapKind::two_cells)].scheme);
    links_->groups.back().crossing = true;
  }
  void end() {
    links_->place.assign(place_.begin(), place_.begin() + room_.used);
    links_->q.assign(q_.begin(), q_.begin() + room_.used);
    links_->across.assign(across_.begin(), across_.end());
    links_->opposite_q.assign(room_.gaps, T(0)), links_->opposite_u.assign(room_.gaps, T(0));
  }
  /// Adds groups, in the order of the kinds, for links that a device has counted from a corner on.
  void add_counted(const KindCounts& counts, lbm::Int3 corner) {
    for (int kind = 0; kind < link_kinds; ++kind)
      if (counts[kind] > 0) links_->groups.push_back(room_.group(LinkKind(kind), counts[kind], corner));
  }
  /// Makes room for all links, whose places and distances a device sets, except those of crossing links.
  void end_for_device(DeviceMapping<T>& device) {
    const auto tell = [&](const lbm::LinkGroup& g, const auto& from, auto& to) {
      device.upload(std::span(from.data() + g.begin, g.count), to.data() + g.begin);
    };
    renew(links_->place, room_.used), renew(links_->q, room_.used), renew(links_->across, room_.across);
    renew(links_->opposite_q, room_.gaps), renew(links_->opposite_u, room_.gaps);
    for (const lbm::LinkGroup& g : links_->groups)
      if (g.crossing) tell(g, place_, links_->place), tell(g, q_, links_->q);
  }

 private:
  struct Deferred {
    WallScheme scheme;
    std::vector<std::uint32_t> place, pair;
    std::vector<T> q;
    lbm::Int3 corner;
    int ready = -1;
  };

  LinkList<T> list(lbm::Int3 corner, int ready, std::size_t links) {
    const std::size_t room = room_.used + links + 3 * lbm::link_lanes;
    if (place_.size() < room) place_.resize(room * 3 / 2), q_.resize(place_.size());
    return {corner, ready, place_.data() + room_.used, q_.data() + room_.used};
  }
  LinkList<T> copied(const std::vector<std::uint32_t>& place, const std::vector<T>& q, lbm::Int3 corner,
                     int ready) {
    LinkList<T> to = list(corner, ready, place.size());
    to.n = std::uint32_t(place.size());
    std::copy(place.begin(), place.end(), to.place), std::copy(q.begin(), q.end(), to.q);
    return to;
  }
  void end_deferred(Deferred& from) {
    if (from.place.empty()) return;
    add(copied(from.place, from.q, from.corner, from.ready), from.scheme);
    if (!from.pair.empty()) {
      lbm::LinkGroup& group = links_->groups.back();
      group.across = true, group.across_begin = std::uint32_t(across_.size());
      from.pair.resize(lbm::padded(group.count), from.pair.back());
      across_.insert(across_.end(), from.pair.begin(), from.pair.end());
    }
    from.place.clear(), from.pair.clear(), from.q.clear(), from.ready = -1;
  }

  WallScheme scheme_;
  lbm::CutLinks<T>* links_ = nullptr;  // of the current body
  std::vector<std::uint32_t> place_;
  std::vector<T> q_;
  std::vector<std::uint32_t> across_;
  LinkRoom room_{scheme_};
  Deferred deferred_[2][int(GapKind::count)];  // inner groups, groups at the rim
};

}  // namespace silt::coupler
