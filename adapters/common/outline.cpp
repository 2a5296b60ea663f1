#include "adapters/common/outline.hpp"

#include <algorithm>

namespace silt::adapters {

namespace {

/// Outward normal of the plane through edge k of the face along n, not of unit length but nearly so.
Vec3 side_normal(const Face& face, int k, const Vec3& n) {
  const Vec3 along = face.corner[(k + 1) % 4] - face.corner[k];
  Vec3 out = along.cross(n).normalized();
  const Vec3 inwards = face.corner[(k + 2) % 4] - face.corner[k];
  return out.dot(inwards) > 0 ? Vec3(-out) : out;
}

struct Corner {
  Vec3 x;
  Feature of_clipper, of_clipped;   // of the point itself
  Feature edge;                     // of the edge that leaves it
  bool edge_of_clipper;
};

/// The point where an edge of the polygon crosses the plane of the clipper's edge.
Corner crossing(const Corner& from, const Corner& to, double d_from, double d_to, const Feature& cut_edge,
                const Face& face) {
  Corner c;
  const double t = d_from / (d_from - d_to);
  c.x = from.x + std::clamp(t, 0.0, 1.0) * (to.x - from.x);
  if (from.edge_of_clipper) {
    c.of_clipper = from.edge.with(cut_edge);
    c.of_clipped = face.feature;
  } else {
    c.of_clipper = cut_edge;
    c.of_clipped = from.edge;
  }
  return c;
}

}  // namespace

Face face_towards(const RoundedBox& box, const Vec3& direction) {
  const Vec3 along = box.axes.transpose() * direction;
  int k = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(along[i]) > std::abs(along[k])) k = i;
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const std::int8_t up = along[k] < 0 ? -1 : 1;
  constexpr std::array<std::int8_t, 4> si{-1, 1, 1, -1}, sj{-1, -1, 1, 1};
  Face face;
  face.normal = up * box.axes.col(k);
  face.feature.sign[k] = up;
  for (int c = 0; c < 4; ++c) {
    Feature corner = face.feature, edge = face.feature;
    corner.sign[i] = si[c];
    corner.sign[j] = sj[c];
    // the edge to the next corner keeps the sign the two have in common
    if (si[c] == si[(c + 1) % 4]) edge.sign[i] = si[c];
    if (sj[c] == sj[(c + 1) % 4]) edge.sign[j] = sj[c];
    face.corner[c] = box.vertex(Vec3(corner.sign[0], corner.sign[1], corner.sign[2]));
    face.corner_feature[c] = corner;
    face.edge_feature[c] = edge;
  }
  return face;
}

std::vector<ClippedPoint> clip_face(const Face& clipper, const Face& face, const Vec3& n, double slack) {
  std::vector<Corner> polygon, next;
  for (int c = 0; c < 4; ++c)
    polygon.push_back({face.corner[c], clipper.feature, face.corner_feature[c], face.edge_feature[c], false});
  for (int k = 0; k < 4 && !polygon.empty(); ++k) {
    const Vec3 out = side_normal(clipper, k, n);
    const Feature& cut_edge = clipper.edge_feature[k];
    next.clear();
    for (std::size_t c = 0; c < polygon.size(); ++c) {
      const Corner &from = polygon[c], &to = polygon[(c + 1) % polygon.size()];
      const double d_from = out.dot(from.x - clipper.corner[k]), d_to = out.dot(to.x - clipper.corner[k]);
      const bool from_in = d_from <= slack, to_in = d_to <= slack;
      if (from_in) next.push_back(from);
      if (from_in == to_in) continue;
      if (from_in && d_from >= -slack) {  // leaves at this very corner
        next.back().edge = cut_edge;
        next.back().edge_of_clipper = true;
      } else if (from_in) {
        next.push_back(crossing(from, to, d_from, d_to, cut_edge, face));
        next.back().edge = cut_edge;
        next.back().edge_of_clipper = true;
      } else if (d_to < -slack) {
        next.push_back(crossing(from, to, d_from, d_to, cut_edge, face));
        next.back().edge = from.edge;
        next.back().edge_of_clipper = from.edge_of_clipper;
      }
    }
    polygon.swap(next);
  }
  std::vector<ClippedPoint> points;
  for (const Corner& c : polygon) points.push_back({c.x, c.of_clipper, c.of_clipped});
  return points;
}

std::vector<ClippedPoint> clip_segment(const Face& clipper, const RoundedBox& capsule, const Vec3& n, double slack) {
  std::array<ClippedPoint, 2> end;
  for (int e = 0; e < 2; ++e) {
    const std::int8_t sign = e ? 1 : -1;
    end[e] = {capsule.vertex(Vec3(0, 0, sign)), clipper.feature, Feature{{0, 0, sign}}};
  }
  for (int k = 0; k < 4; ++k) {
    const Vec3 out = side_normal(clipper, k, n);
    const std::array<double, 2> d{out.dot(end[0].x - clipper.corner[k]), out.dot(end[1].x - clipper.corner[k])};
    if (d[0] > slack && d[1] > slack) return {};
    for (int e = 0; e < 2; ++e) {
      if (d[e] <= slack) continue;
      end[e].x += std::clamp(d[e] / (d[e] - d[1 - e]), 0.0, 1.0) * (end[1 - e].x - end[e].x);
      end[e].of_clipper = clipper.edge_feature[k];
      end[e].of_clipped = Feature{};
    }
  }
  return {end[0], end[1]};
}

}  // namespace silt::adapters
