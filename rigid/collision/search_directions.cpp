#include "rigid/collision/deepest_direction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace silt::rigid {

namespace {

/// A bound this little above the best (part of the pair's size) is not worth following.
constexpr double bound_rounding = 1e-12;
/// For pairs whose separation is the same in many directions (concentric bodies of revolution).
constexpr int most_bisections = 6000;

/// A direction and the supports' difference found there.
struct Sample {
  Vec3 n, w;
  double height() const { return n.dot(w); }
};

struct DirectionTriangle {
  double bound;  // no direction of it has a larger separation
  std::array<Sample, 3> corner;

  bool operator<(const DirectionTriangle& other) const { return bound < other.bound; }
};

/// The least over some mixtures of the three w of the largest n_j . w.
double bound_of(const std::array<Sample, 3>& c) {
  std::array<std::array<double, 3>, 3> m;  // m[i][j] = w_i . n_j
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m[i][j] = c[i].w.dot(c[j].n);
  double least = std::numeric_limits<double>::infinity();
  const auto mix = [&](double x, double y, double z) {
    double most = -std::numeric_limits<double>::infinity();
    for (int j = 0; j < 3; ++j) most = std::max(most, x * m[0][j] + y * m[1][j] + z * m[2][j]);
    least = std::min(least, most);
  };
  mix(1, 0, 0), mix(0, 1, 0), mix(0, 0, 1);
  mix(0.5, 0.5, 0), mix(0, 0.5, 0.5), mix(0.5, 0, 0.5);
  mix(1.0 / 3, 1.0 / 3, 1.0 / 3);
  if (!(least > 0)) return least;
  const Vec3 area = (c[1].n - c[0].n).cross(c[2].n - c[0].n);
  return least * area.norm() / std::abs(area.dot(c[0].n));
}

class Search {
 public:
  Search(const ConvexCore& a, const ConvexCore& b, const Peak& seed, double enough)
      : a_(a), b_(b), slack_(bound_rounding * length_scale(a, b)), enough_(enough), best_(seed) {}

  std::optional<Peak> run() {
    start_with_octants();
    for (int halving = 0; !heap_.empty() && best_.core_gap <= enough_; ++halving) {
      std::pop_heap(heap_.begin(), heap_.end());
      const DirectionTriangle t = heap_.back();
      heap_.pop_back();
      if (t.bound <= best_.core_gap + slack_ || halving >= most_bisections) break;
      halve(t.corner);
    }
    if (best_.core_gap > enough_) return {};
    return best_;
  }

 private:
  /// Octants turned out of the axes, along which shapes are often aligned: there many directions are equal.
  void start_with_octants() {
    const Mat3 turn =
        Quat(0.8414709848, 0.3141592654, -0.2718281828, 0.3466020610).normalized().toRotationMatrix();
    std::array<Sample, 6> axis;
    for (int k = 0; k < 6; ++k) axis[k] = sample((k < 3 ? 1.0 : -1.0) * turn.col(k % 3));
    heap_.reserve(64);
    for (int octant = 0; octant < 8; ++octant)
      push({axis[octant & 1 ? 0 : 3], axis[octant & 2 ? 1 : 4], axis[octant & 4 ? 2 : 5]});
  }

  Sample sample(const Vec3& n) {
    const Sample s{n, b_.support(-n) - a_.support(n)};
    return s;
  }

  void push(const std::array<Sample, 3>& corner) {
    const DirectionTriangle t{bound_of(corner), corner};
    if (t.bound <= best_.core_gap + slack_) return;
    heap_.push_back(t);
    std::push_heap(heap_.begin(), heap_.end());
  }

  void take(const Peak& peak) {
    if (peak.core_gap > best_.core_gap) best_ = peak;
  }

  void halve(const std::array<Sample, 3>& c) {
    std::array<double, 3> edge;
    for (int k = 0; k < 3; ++k) edge[k] = (c[(k + 1) % 3].n - c[k].n).squaredNorm();
    const int k = std::max_element(edge.begin(), edge.end()) - edge.begin();
    const double length = std::sqrt(edge[k]);
    const Sample &from = c[k], &to = c[(k + 1) % 3], &opposite = c[(k + 2) % 3];
    if (length < search_resolution) {
      if (2 - 2 * best_.normal.dot(from.n) > search_resolution * search_resolution)
        take(climb(a_, b_, (c[0].n + c[1].n + c[2].n).normalized(), 2 * search_resolution));
      return;
    }
    const Sample middle = sample((from.n + to.n).normalized());
    if (middle.height() > best_.core_gap + slack_)
      take(climb(a_, b_, walk_uphill(a_, b_, middle.n), search_resolution));
    push({from, middle, opposite});
    push({middle, to, opposite});
  }

  const ConvexCore &a_, &b_;
  double slack_, enough_;
  Peak best_;
  std::vector<DirectionTriangle> heap_;
};

}  // namespace

std::optional<Peak> search_directions(const ConvexCore& a, const ConvexCore& b, const Peak& seed,
                                      double enough) {
  return Search(a, b, seed, enough).run();
}

}  // namespace silt::rigid
