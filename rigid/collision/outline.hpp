#pragma once
// Outlines: the face of a box in a direction, and the clipping of outlines against each other.
#include <algorithm>
#include <array>
#include <optional>

#include "rigid/collision/convex_core.hpp"
#include "rigid/shapes/solid.hpp"

namespace silt::rigid {

/// The face of a box whose normal is closest to a direction; edge i is from corner i to i + 1.
struct BoxFace {
  Vec3 normal;
  Feature feature;
  std::array<Vec3, 4> corner;
  std::array<Feature, 4> edge_feature;

  /// Returns the distance from x to the face's plane, along unit n.
  double height(const Vec3& x, const Vec3& n) const { return normal.dot(corner[0] - x) / normal.dot(n); }
};
BoxFace face_towards(const ConvexCore& box, const Vec3& direction);

/// The prism over a face along unit n (not parallel to it): inside outward[k] . x <= bound[k] for all edges.
struct FacePrism {
  std::array<Vec3, 4> outward;  // unit
  std::array<double, 4> bound;

  std::size_t size() const { return 4; }
  double beyond(std::size_t k, const Vec3& x) const { return outward[k].dot(x) - bound[k]; }
};
FacePrism prism_over(const BoxFace&, const Vec3& n);

/// Returns the feature under x: the face, or an edge or corner within `slack` (lattice units).
Feature feature_under(const BoxFace&, const FacePrism&, const Vec3& x, double slack);

/// Returns where the line from x to y, at signed distances d_x and d_y from a plane, crosses the plane.
inline Vec3 crossing(const Vec3& x, const Vec3& y, double d_x, double d_y) {
  return x + std::clamp(d_x / (d_x - d_y), 0.0, 1.0) * (y - x);
}

/// Corners of a box face clipped by another: four plus one for each edge that cuts it.
class BoxPolygon {
 public:
  std::size_t size() const { return size_; }
  const Vec3& operator[](std::size_t k) const { return corner_[k]; }
  void push_back(const Vec3& x) { corner_[size_++] = x; }
  void clear() { size_ = 0; }

 private:
  std::array<Vec3, 8> corner_;
  std::size_t size_ = 0;
};

/// Clips a polygon by a prism (Sutherland, Hodgman, CACM 17 (1974) 32), up to `slack` (lattice units).
template <class AnyPrism, class Polygon>
void clip(const AnyPrism& prism, double slack, Polygon& polygon) {
  Polygon kept;
  for (std::size_t k = 0; k < prism.size() && polygon.size() > 0; ++k) {
    kept.clear();
    for (std::size_t c = 0; c < polygon.size(); ++c) {
      const Vec3 &x = polygon[c], &y = polygon[c + 1 < polygon.size() ? c + 1 : 0];
      const double d_x = prism.beyond(k, x), d_y = prism.beyond(k, y);
      if (d_x <= slack) kept.push_back(x);
      // a corner within slack of the plane is itself the crossing
      if ((d_x < -slack && d_y > slack) || (d_x > slack && d_y < -slack))
        kept.push_back(crossing(x, y, d_x, d_y));
    }
    std::swap(polygon, kept);
  }
}

/// The part of a segment within a prism, and which of its ends were cut; nothing if it is outside.
struct ClippedSegment {
  std::array<Vec3, 2> end;
  std::array<bool, 2> is_cut{};
};
template <class AnyPrism>
std::optional<ClippedSegment> clip_segment(const AnyPrism& prism, const Vec3& from, const Vec3& to,
                                           double slack) {
  ClippedSegment s{{from, to}};
  for (std::size_t k = 0; k < prism.size(); ++k) {
    const std::array<double, 2> d{prism.beyond(k, s.end[0]), prism.beyond(k, s.end[1])};
    if (d[0] > slack && d[1] > slack) return {};
    for (int e = 0; e < 2; ++e)
      if (d[e] > slack) s.end[e] = crossing(s.end[e], s.end[1 - e], d[e], d[1 - e]), s.is_cut[e] = true;
  }
  return s;
}

/// A point where a line along the contact normal meets both outlines. It proves that the normal is a
/// direction of closest approach or least depth.
struct CommonPoint {
  Vec3 on_a = Vec3::Zero(), on_b = Vec3::Zero();  // on the cores, lattice units
  double miss = 0;                                // distance of on_b from on_a + gap n: 0 but for rounding
  std::uint32_t code_a = 0, code_b = 0;           // of the features at the points
};

/// Returns the points of two outlines, `gap` (lattice units) apart, that lie most exactly over each other
/// along unit n. Candidates, which suffice, are corners, crossings of edges and centres of discs.
CommonPoint common_point(const ContactOutline& a, const ContactOutline& b, const Vec3& n, double gap,
                         double slack);

/// The prism over a face along unit n (not parallel to it); beyond() is > 0 outside edge k.
class Prism {
 public:
  Prism(const ContactOutline& face, const Vec3& n);
  std::size_t size() const { return outward_.size(); }
  double beyond(std::size_t k, const Vec3& x) const { return outward_[k].dot(x) - bound_[k]; }

 private:
  std::vector<Vec3> outward_;
  std::vector<double> bound_;
};

/// Returns the code of the feature under x: the face, or an edge or corner within `slack` (lattice units).
std::uint32_t code_under(const ContactOutline& face, const Prism&, const Vec3& x, double slack);

}  // namespace silt::rigid
