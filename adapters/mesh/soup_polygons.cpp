#include "adapters/mesh/soup.hpp"

#include <Eigen/Geometry>
#include <span>
#include <stdexcept>

namespace silt::adapters {

namespace {

using rigid::Vec3;
using Point = Eigen::Vector2d;
using Corners = std::span<const std::uint32_t>;

/// Returns twice the area of a triangle, positive if counter-clockwise.
double turn(const Point& a, const Point& b, const Point& c) {
  const Point u = b - a, v = c - a;
  return u[0] * v[1] - u[1] * v[0];
}

/// Returns the normal of a face (M. Newell) times twice its area.
Vec3 area_normal(const std::vector<Vec3>& points, Corners corners) {
  Vec3 sum = Vec3::Zero();
  const Vec3& o = points[corners[0]];
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    sum += (points[corners[k]] - o).cross(points[corners[k + 1]] - o);
  return sum;
}

bool is_fan(const std::vector<Vec3>& points, Corners corners, const Vec3& normal) {
  constexpr double flat = 1e-6;
  const Vec3& o = points[corners[0]];
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    if ((points[corners[k]] - o).cross(points[corners[k + 1]] - o).dot(normal) < -flat * normal.squaredNorm())
      return false;
  return true;
}

/// Triangulates a polygon in its plane by ear clipping.
class Ears {
 public:
  Ears(const std::vector<Vec3>& points, Corners corners, const Vec3& normal) : left_(corners.size()) {
    const Vec3 right = normal.unitOrthogonal(), up = normal.normalized().cross(right), o = points[corners[0]];
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Vec3 r = points[corners[k]] - o;
      at_.emplace_back(right.dot(r), up.dot(r));
      left_[k] = k;
    }
    least_ = 1e-12 * normal.norm();
  }
  /// Calls cut(three corners) for all triangles. Returns false if the polygon crosses itself.
  template <class Cut>
  bool all(Cut&& cut) {
    while (left_.size() > 3) {
      std::size_t k = 0;
      while (k < left_.size() && !(area(k) > least_ && is_empty(k))) ++k;
      if (k == left_.size())  // only flat ears are left, where edges of other faces end
        for (k = 0; k < left_.size() && !(std::abs(area(k)) <= least_ && is_empty(k));) ++k;
      if (k == left_.size()) return false;
      cut(before(k), left_[k], after(k));
      left_.erase(left_.begin() + std::ptrdiff_t(k));
    }
    if (area(1) < -least_) return false;
    cut(left_[0], left_[1], left_[2]);
    return true;
  }

 private:
  std::size_t before(std::size_t k) const { return left_[k == 0 ? left_.size() - 1 : k - 1]; }
  std::size_t after(std::size_t k) const { return left_[k + 1 == left_.size() ? 0 : k + 1]; }
  double area(std::size_t k) const { return turn(at_[before(k)], at_[left_[k]], at_[after(k)]); }
  /// Returns whether no other corner is in the triangle or on its new side, except at the same position.
  bool is_empty(std::size_t k) const {
    const Point &a = at_[before(k)], &b = at_[left_[k]], &c = at_[after(k)];
    for (const std::size_t other : left_) {
      const Point& p = at_[other];
      if (p == a || p == b || p == c) continue;
      if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
  }

  std::vector<Point> at_;
  std::vector<std::size_t> left_;  // remaining corners, in order
  double least_ = 0;               // smaller double areas are rounding
};

bool cut_face(Soup& soup, Corners corners) {
  const Vec3 normal = area_normal(soup.points, corners);
  const auto cut = [&](std::size_t a, std::size_t b, std::size_t c) {
    soup.triangles.push_back({corners[a], corners[b], corners[c]});
  };
  if (corners.size() > 3 && !is_fan(soup.points, corners, normal))
    return Ears(soup.points, corners, normal).all(cut);
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) cut(0, k, k + 1);
  return true;
}

}  // namespace

void Polygons::add(const std::vector<std::uint32_t>& corners, std::size_t number) {
  faces_.push_back({corners_.size(), number});
  corners_.insert(corners_.end(), corners.begin(), corners.end());
}

void Polygons::cut_into(Soup& soup, const std::string& what) const {
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const std::size_t end = f + 1 < faces_.size() ? faces_[f + 1].begin : corners_.size();
    const Corners corners(corners_.data() + faces_[f].begin, end - faces_[f].begin);
    const auto refuse = [&](const std::string& text) {
      throw std::invalid_argument(what + std::to_string(faces_[f].number) + ' ' + text);
    };
    if (corners.size() < 3) refuse("has less than three corners");
    for (const std::uint32_t c : corners) {
      if (c >= soup.points.size())
        refuse("has a corner that is not one of the " + std::to_string(soup.points.size()) + " points");
      if (!soup.points[c].allFinite()) refuse("has a corner with a coordinate that is not finite");
    }
    if (!cut_face(soup, corners)) refuse("crosses itself; divide it into triangles");
  }
}

}  // namespace silt::adapters
