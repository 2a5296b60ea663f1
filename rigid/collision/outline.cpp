#include "rigid/collision/outline.hpp"

#include <cmath>
#include <limits>

namespace silt::rigid {

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
    // the edge to the next corner has the sign common to both corners
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

namespace {

struct Place {
  Vec3 x;
  std::uint32_t code;
};

double across(const Vec3& v, const Vec3& n) {
  return (v - v.dot(n) * n).norm();
}

/// Returns the point of the edge from corner k nearest to x, as seen along n.
Place nearest_on_edge(const ContactOutline& o, std::size_t k, const Vec3& x, const Vec3& n, double slack) {
  const auto &from = o.corners[k], &to = o.next(k);
  const Vec3 along = to.x - from.x, seen = along - along.dot(n) * n;
  const double length = seen.norm();
  const double t = length > 0 ? std::clamp((x - from.x).dot(seen) / (length * length), 0.0, 1.0) : 0;
  const std::uint32_t code = t * length <= slack         ? from.code
                             : (1 - t) * length <= slack ? to.code
                                                         : from.edge_code;
  return {from.x + t * along, code};
}

/// Returns the point of the outline nearest to x, as seen along n.
Place nearest(const ContactOutline& o, const Vec3& x, const Vec3& n, double slack) {
  if (o.size() == 1) return {o.corners[0].x, o.corners[0].code};
  if (o.size() == 2) return nearest_on_edge(o, 0, x, n, slack);
  if (o.disc_radius > 0) {
    const Vec3 onto = x + o.height(x, n) * n, from_centre = onto - o.centre;
    const double distance = from_centre.norm();
    return {distance <= o.disc_radius ? onto : Vec3(o.centre + o.disc_radius / distance * from_centre),
            o.code};
  }
  const Prism prism(o, n);
  bool inside = true;
  for (std::size_t k = 0; k < prism.size(); ++k) inside = inside && prism.beyond(k, x) <= 0;
  if (inside) return {x + o.height(x, n) * n, code_under(o, prism, x, slack)};
  Place best{};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < o.size(); ++k) {
    const Place p = nearest_on_edge(o, k, x, n, slack);
    if (const double d = across(p.x - x, n); d < least) {
      least = d;
      best = p;
    }
  }
  return best;
}

/// Returns where the edge p to p_end crosses another edge's line, seen along n, or its nearer end.
Vec3 crossing(const Vec3& p, const Vec3& p_end, const Vec3& q, const Vec3& q_end, const Vec3& n) {
  const Vec3 side = (q_end - q).cross(n);
  const double slope = (p_end - p).dot(side);
  const double t = slope != 0 ? std::clamp((q - p).dot(side) / slope, 0.0, 1.0) : 0;
  return p + t * (p_end - p);
}

std::size_t edges_of(const ContactOutline& o) {
  return o.disc_radius > 0 || o.size() < 2 ? 0 : o.size() == 2 ? 1 : o.size();
}

}  // namespace

Prism::Prism(const ContactOutline& face, const Vec3& n) {
  Vec3 middle = Vec3::Zero();
  for (const auto& c : face.corners) middle += c.x;
  middle /= static_cast<double>(face.size());
  for (std::size_t k = 0; k < face.size(); ++k) {
    const Vec3& x = face.corners[k].x;
    const Vec3 sideways = (face.next(k).x - x).cross(n).normalized();
    outward_.push_back(sideways.dot(middle - x) > 0 ? Vec3(-sideways) : sideways);
    bound_.push_back(outward_.back().dot(x));
  }
}

std::uint32_t code_under(const ContactOutline& face, const Prism& prism, const Vec3& x, double slack) {
  const std::size_t count = face.size();
  std::uint32_t code = face.code;
  for (std::size_t k = 0; k < count; ++k) {
    if (std::abs(prism.beyond(k, x)) > slack) continue;
    const std::size_t before = k > 0 ? k - 1 : count - 1, after = k + 1 < count ? k + 1 : 0;
    if (std::abs(prism.beyond(before, x)) <= slack) return face.corners[k].code;
    if (std::abs(prism.beyond(after, x)) <= slack) return face.corners[after].code;
    code = face.corners[k].edge_code;
  }
  return code;
}

CommonPoint common_point(const ContactOutline& a, const ContactOutline& b, const Vec3& n, double gap,
                         double slack) {
  CommonPoint best{Vec3::Zero(), Vec3::Zero(), std::numeric_limits<double>::infinity(), 0, 0};
  const auto consider = [&](const Vec3& near) {
    const Place on_a = nearest(a, near, n, slack), on_b = nearest(b, on_a.x, n, slack);
    const double miss = (on_b.x - on_a.x - gap * n).norm();
    if (miss < best.miss) best = {on_a.x, on_b.x, miss, on_a.code, on_b.code};
  };
  if (a.size() == 1) return consider(a.corners[0].x), best;
  if (b.size() == 1) return consider(b.corners[0].x), best;
  for (std::size_t i = 0; i < edges_of(a); ++i)
    for (std::size_t j = 0; j < edges_of(b); ++j)
      consider(crossing(a.corners[i].x, a.next(i).x, b.corners[j].x, b.next(j).x, n));
  for (const ContactOutline* o : {&a, &b}) {
    for (const auto& c : o->corners) consider(c.x);
    if (o->disc_radius > 0) {
      consider(o->centre);
      consider(nearest(o == &a ? b : a, o->centre, n, slack).x);
    }
  }
  return best;
}

}  // namespace silt::rigid
