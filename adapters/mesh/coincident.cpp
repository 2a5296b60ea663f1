#include "adapters/mesh/soup.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace silt::adapters {

namespace {

Triangle sorted(Triangle t) {
  std::sort(t.begin(), t.end());
  return t;
}

/// Triangles [begin, end) have the same corners.
struct Group {
  std::size_t begin, end;
  enum { undecided, stays, goes } verdict = undecided;
};

/// An edge of groups: a triangle that stands alone counts once and for all.
struct Edge {
  std::vector<std::size_t> undecided;  // groups
  bool is_odd = false;                 // by what stays
};

/// Decides for each group of several whether one of it stays.
class Verdicts {
 public:
  Verdicts(const std::vector<Triangle>& triangles, std::vector<Group>& groups)
      : triangles_(triangles), groups_(groups) {
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (groups[g].verdict == Group::undecided)
        for_edges(g, [&](const Key& key) { edges_[key].undecided.push_back(g); });
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (groups[g].verdict == Group::stays)
        for_edges(g, [&](const Key& key) {
          if (const auto edge = edges_.find(key); edge != edges_.end()) edge->second.is_odd ^= true;
        });
    for (const auto& [key, edge] : edges_) follow(key);
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (groups[g].verdict == Group::undecided) decide(g, Group::stays);
  }

 private:
  using Key = std::array<std::uint32_t, 2>;

  template <class Use>
  void for_edges(std::size_t group, Use&& use) const {
    const Triangle t = sorted(triangles_[groups_[group].begin]);
    use(Key{t[0], t[1]}), use(Key{t[1], t[2]}), use(Key{t[0], t[2]});
  }
  /// Of a group that is the only one left undecided at an edge the edge decides.
  void follow(const Key& key) {
    const Edge& edge = edges_.at(key);
    if (edge.undecided.size() == 1) decide(edge.undecided[0], edge.is_odd ? Group::stays : Group::goes);
  }
  void decide(std::size_t group, decltype(Group::verdict) verdict) {
    std::vector<std::pair<std::size_t, decltype(Group::verdict)>> waiting{{group, verdict}};
    while (!waiting.empty()) {
      const auto [g, how] = waiting.back();
      waiting.pop_back();
      if (groups_[g].verdict != Group::undecided) continue;
      groups_[g].verdict = how;
      for_edges(g, [&](const Key& key) {
        Edge& edge = edges_.at(key);
        edge.is_odd ^= how == Group::stays;
        std::erase(edge.undecided, g);
        if (edge.undecided.size() == 1)
          waiting.emplace_back(edge.undecided[0], edge.is_odd ? Group::stays : Group::goes);
      });
    }
  }

  const std::vector<Triangle>& triangles_;
  std::vector<Group>& groups_;
  std::map<Key, Edge> edges_;  // of groups of several only
};

}  // namespace

void leave_out_coincident(std::vector<Triangle>& triangles, WeldCounts& counts) {
  for (Triangle& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(triangles.begin(), triangles.end(), [&](const Triangle& a, const Triangle& b) {
    return std::tuple(sorted(a), a) < std::tuple(sorted(b), b);
  });
  std::vector<Group> groups;
  for (std::size_t i = 0; i < triangles.size(); i = groups.back().end) {
    std::size_t end = i + 1;
    while (end < triangles.size() && sorted(triangles[end]) == sorted(triangles[i])) ++end;
    groups.push_back({i, end, end - i == 1 ? Group::stays : Group::undecided});
  }
  if (groups.size() == triangles.size()) return;
  Verdicts(triangles, groups);
  std::vector<Triangle> left;
  for (const Group& group : groups) {
    const bool stays = group.verdict == Group::stays;
    if (stays) left.push_back(triangles[group.begin]);
    (stays ? counts.duplicate : counts.thin) += group.end - group.begin - stays;
  }
  triangles.swap(left);
}

}  // namespace silt::adapters
