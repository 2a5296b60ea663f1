#include "adapters/mesh/soup.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace silt::adapters {

using rigid::Vec3;

namespace {

bool is_before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// Finds points near one another by hashing; its cells are much wider than the distance.
class Grid {
 public:
  Grid(const Vec3& low, double distance, std::size_t points) : low_(low), distance_(distance) {
    cells_.reserve(points);
  }
  /// Calls use(earlier point) for the points within the distance, in the order of insertion.
  template <class Use>
  void near(const std::vector<Vec3>& points, const Vec3& x, Use&& use) const {
    std::array<std::int64_t, 3> first, last;
    for (int d = 0; d < 3; ++d) {
      first[d] = cell_of(x[d] - distance_ - low_[d]), last[d] = cell_of(x[d] + distance_ - low_[d]);
    }
    for (std::int64_t k = first[2]; k <= last[2]; ++k)
      for (std::int64_t j = first[1]; j <= last[1]; ++j)
        for (std::int64_t i = first[0]; i <= last[0]; ++i)
          if (const auto found = cells_.find(key(i, j, k)); found != cells_.end())
            for (std::uint32_t at = found->second; at != none; at = next_[at])
              if ((points[at] - x).norm() <= distance_) use(at);
  }
  void add(const Vec3& x, std::uint32_t number) {
    std::array<std::int64_t, 3> c;
    for (int d = 0; d < 3; ++d) c[d] = cell_of(x[d] - low_[d]);
    next_.resize(number + std::size_t{1}, none);
    auto [at, is_new] = cells_.try_emplace(key(c[0], c[1], c[2]), number);
    if (!is_new) next_[number] = std::exchange(at->second, number);
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  std::int64_t cell_of(double y) const { return std::int64_t(std::floor(y / (64 * distance_))); }
  static std::uint64_t key(std::int64_t i, std::int64_t j, std::int64_t k) {
    return (std::uint64_t(i) * 0x9E3779B97F4A7C15 ^ std::uint64_t(j)) * 0xC2B2AE3D27D4EB4F ^ std::uint64_t(k);
  }
  Vec3 low_;
  double distance_;
  std::unordered_map<std::uint64_t, std::uint32_t> cells_;  // the last point inserted
  std::vector<std::uint32_t> next_;
};

/// Returns the new number of each point, and welds `points`.
std::vector<std::uint32_t> welded_numbers(std::vector<Vec3>& points, double distance) {
  std::vector<std::uint32_t> order(points.size()), number(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return is_before(points[a], points[b]); });
  std::vector<Vec3> sorted;  // without duplicates
  for (const std::uint32_t k : order) {
    if (sorted.empty() || sorted.back() != points[k]) sorted.push_back(points[k]);
    number[k] = std::uint32_t(sorted.size() - 1);
  }
  std::vector<std::uint32_t> first(sorted.size());  // the first of the points welded together
  if (!sorted.empty()) {
    Vec3 low = sorted[0];
    for (const Vec3& x : sorted) low = low.cwiseMin(x);
    Grid grid(low, distance, sorted.size());
    for (std::uint32_t k = 0; k < sorted.size(); ++k) {
      first[k] = k;
      if (distance > 0) {
        grid.near(sorted, sorted[k], [&](std::uint32_t at) { first[k] = std::min(first[k], first[at]); });
        grid.add(sorted[k], k);
      }
    }
  }
  for (std::uint32_t& k : number) k = first[k];
  points = std::move(sorted);
  return number;
}

std::size_t remove_degenerate(std::vector<Triangle>& triangles) {
  return std::erase_if(triangles,
                       [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

}  // namespace

void remove_unused(Soup& soup) {
  std::vector<char> used(soup.points.size(), 0);
  for (const Triangle& t : soup.triangles)
    for (const std::uint32_t k : t) used[k] = 1;
  std::vector<std::uint32_t> number(soup.points.size());
  std::uint32_t next = 0;
  for (std::uint32_t k = 0; k < used.size(); ++k)
    if (used[k]) soup.points[next] = soup.points[k], number[k] = next++;
  soup.points.resize(next);
  for (Triangle& t : soup.triangles)
    for (std::uint32_t& k : t) k = number[k];
}

namespace {

Triangle sorted(Triangle t) {
  std::sort(t.begin(), t.end());
  return t;
}

/// Triangles [begin, end), which have the same vertices.
struct Group {
  std::size_t begin, end;
  enum { undecided, stays, goes } verdict = undecided;
};

/// An edge of such groups. A triangle without duplicates only counts for its parity.
struct Edge {
  std::vector<std::size_t> undecided;  // groups
  bool is_odd = false;                 // parity of the triangles that stay
};

/// Decides for each group of duplicates whether one of them stays.
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
    for (const auto& [key, edge] : edges_) decide_at(key);
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
  /// Decides a group that is the only undecided one at an edge.
  void decide_at(const Key& key) {
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
  std::map<Key, Edge> edges_;  // of groups with duplicates
};

/// Removes all but one or all of the triangles with the same vertices (duplicates, fins, membranes), so that
/// every edge has an even number of triangles: all if they protrude from a closed surface or divide a solid,
/// all but one if otherwise a hole would remain. If both are possible, as for a doubled surface, one stays.
/// The result does not depend on the order of the triangles.
void remove_coincident(std::vector<Triangle>& triangles, WeldCounts& counts) {
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

}  // namespace

WeldCounts weld(Soup& soup, double distance) {
  const std::vector<std::uint32_t> number = welded_numbers(soup.points, distance);
  for (Triangle& t : soup.triangles)
    for (std::uint32_t& k : t) k = number[k];
  WeldCounts counts;
  counts.degenerate = remove_degenerate(soup.triangles);
  remove_coincident(soup.triangles, counts);
  remove_unused(soup);
  return counts;
}

}  // namespace silt::adapters
