#include "rigid/collision/outline.hpp"

#include <cmath>

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

}  // namespace silt::rigid
