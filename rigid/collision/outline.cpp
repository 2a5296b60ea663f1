#include "rigid/collision/outline.hpp"

#include <algorithm>
#include <cmath>

namespace silt::rigid {

namespace {

/// Where the line from x to y, at distances d_x and d_y from a plane, crosses it.
Vec3 crossing(const Vec3& x, const Vec3& y, double d_x, double d_y) {
  return x + std::clamp(d_x / (d_x - d_y), 0.0, 1.0) * (y - x);
}

}  // namespace

BoxFace face_towards(const ConvexCore& box, const Vec3& direction) {
  const Vec3 along = box.axes.transpose() * direction;
  int k = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(along[i]) > std::abs(along[k])) k = i;
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const std::int8_t up = along[k] < 0 ? -1 : 1;
  constexpr std::array<std::int8_t, 4> si{-1, 1, 1, -1}, sj{-1, -1, 1, 1};
  BoxFace face;
  face.normal = up * box.axes.col(k);
  const Vec3 middle = box.centre + box.half[k] * face.normal;
  const Vec3 along_i = box.half[i] * box.axes.col(i), along_j = box.half[j] * box.axes.col(j);
  face.feature.sign[k] = up;
  for (int c = 0; c < 4; ++c) {
    face.corner[c] = middle + si[c] * along_i + sj[c] * along_j;
    // the edge to the next corner keeps the sign the two have in common
    face.edge_feature[c] = face.feature;
    if (si[c] == si[(c + 1) % 4]) face.edge_feature[c].sign[i] = si[c];
    if (sj[c] == sj[(c + 1) % 4]) face.edge_feature[c].sign[j] = sj[c];
  }
  return face;
}

FacePrism prism_over(const BoxFace& face, const Vec3& n) {
  FacePrism prism;
  for (int k = 0; k < 2; ++k) {  // opposite edges are parallel
    const Vec3 across = (face.corner[k + 1] - face.corner[k]).cross(n).normalized();
    const Vec3 inwards = face.corner[k + 2] - face.corner[k];
    prism.outward[k] = across.dot(inwards) > 0 ? Vec3(-across) : across;
    prism.outward[k + 2] = -prism.outward[k];
  }
  for (int k = 0; k < 4; ++k) prism.bound[k] = prism.outward[k].dot(face.corner[k]);
  return prism;
}

Feature feature_under(const BoxFace& face, const FacePrism& prism, const Vec3& x, double slack) {
  Feature f = face.feature;
  for (int k = 0; k < 4; ++k)
    if (std::abs(prism.beyond(k, x)) <= slack) f = f.with(face.edge_feature[k]);
  return f;
}

Polygon clip_face(const FacePrism& prism, const BoxFace& face, double slack) {
  Polygon polygon;
  for (const Vec3& x : face.corner) polygon.add(x);
  for (int k = 0; k < 4 && polygon.size > 0; ++k) {
    Polygon kept;
    for (int c = 0; c < polygon.size; ++c) {
      const Vec3 &x = polygon.corner[c], &y = polygon.corner[(c + 1) % polygon.size];
      const double d_x = prism.beyond(k, x), d_y = prism.beyond(k, y);
      if (d_x <= slack) kept.add(x);
      // a corner on the plane, within slack, is where the outline crosses it
      if ((d_x < -slack && d_y > slack) || (d_x > slack && d_y < -slack)) kept.add(crossing(x, y, d_x, d_y));
    }
    polygon = kept;
  }
  return polygon;
}

ClippedSegment clip_segment(const FacePrism& prism, const ConvexCore& capsule, double slack) {
  ClippedSegment s{{capsule.vertex(Vec3(0, 0, -1)), capsule.vertex(Vec3(0, 0, 1))}, {-1, 1}, false};
  for (int k = 0; k < 4; ++k) {
    const std::array<double, 2> d{prism.beyond(k, s.end[0]), prism.beyond(k, s.end[1])};
    if (d[0] > slack && d[1] > slack) s.empty = true;
    if (s.empty) return s;
    for (int e = 0; e < 2; ++e) {
      if (d[e] <= slack) continue;
      s.end[e] = crossing(s.end[e], s.end[1 - e], d[e], d[1 - e]);
      s.sign[e] = 0;
    }
  }
  return s;
}

}  // namespace silt::rigid
