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

/// Sorts links into groups. Those of kinds other than `own` are few, so links of consecutive planes share a
/// group.
template <class T>
class LinkGroups {
 public:
  explicit LinkGroups(WallScheme scheme) : scheme_(scheme) {}

  void begin(lbm::CutLinks<T>& links) {
    links_ = &links;
    links.groups.clear(), across_.clear(), room_ = {scheme_};
  }
  /// Begins a list with room for `room` links in `planes` planes.
  LinkList<T> list(lbm::Int3 corner, int planes, int ready, std::size_t room) {
    for (int kind = 0; kind < link_kinds; ++kind)  // if its places cannot reach these planes
      if (corner.z + planes - deferred_[ready < 0][kind].corner.z > 1 << lbm::place_z_bits)
        end_deferred(LinkKind(kind), deferred_[ready < 0][kind]);
    return list(corner, ready, room);
  }
  /// Adds link k of a list to the deferred group of a kind; `pair` is its index for CutLinks::across.
  void defer(LinkKind kind, const LinkList<T>& list, std::uint32_t k, std::uint32_t pair = 0) {
    Deferred& to = deferred_[list.ready < 0][int(kind)];
    if (to.place.empty()) to.corner = list.corner;  // later corners are not lower
    to.place.push_back(list.place[k] + lbm::link_place({0, 0, list.corner.z - to.corner.z}, 0));
    to.q.push_back(list.q[k]);
    if (kind == LinkKind::across) to.pair.push_back(pair);
    to.ready = std::max(to.ready, list.ready);
  }
  /// Makes a group of the list begun last.
  void add(LinkKind kind, const LinkList<T>& list) {
    if (list.n == 0) return;
    list.pad(list.place), list.pad(list.q);
    links_->groups.push_back(room_.group(kind, list.n, list.corner, list.ready));
  }
  void end_deferred() {
    for (auto& kinds : deferred_)
      for (int kind = 0; kind < link_kinds; ++kind) end_deferred(LinkKind(kind), kinds[kind]);
  }
  /// Adds links with both ends cut.
  void add_crossing(const std::vector<std::uint32_t>& place, const std::vector<T>& q, lbm::Int3 corner) {
    add(LinkKind::crossing, copied(place, q, corner, -1));
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
      if (counts[kind] > 0) links_->groups.push_back(room_.group(LinkKind(kind), counts[kind], corner, -1));
  }
  void add_counted_crossing(std::uint32_t links, lbm::Int3 corner) {
    if (links > 0) links_->groups.push_back(room_.group(LinkKind::crossing, links, corner, -1));
  }
  /// Makes room for all links, whose places and distances a device sets.
  void end_for_device() {
    renew(links_->place, room_.used), renew(links_->q, room_.used), renew(links_->across, room_.across);
    renew(links_->opposite_q, room_.gaps), renew(links_->opposite_u, room_.gaps);
  }

 private:
  struct Deferred {
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
  void end_deferred(LinkKind kind, Deferred& from) {
    if (from.place.empty()) return;
    add(kind, copied(from.place, from.q, from.corner, from.ready));
    if (!from.pair.empty()) from.pair.resize(lbm::padded(std::uint32_t(from.pair.size())), from.pair.back());
    across_.insert(across_.end(), from.pair.begin(), from.pair.end());
    from.place.clear(), from.pair.clear(), from.q.clear(), from.ready = -1;
  }

  WallScheme scheme_;
  lbm::CutLinks<T>* links_ = nullptr;  // of the current body
  std::vector<std::uint32_t> place_;
  std::vector<T> q_;
  std::vector<std::uint32_t> across_;
  LinkRoom room_{scheme_};
  Deferred deferred_[2][link_kinds];  // inner groups, groups at the rim
};

}  // namespace silt::coupler
