#include "adapters/qhull/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

#include "rigid/math/elementary.hpp"

namespace silt::adapters {

namespace {

using rigid::Mat3;
using rigid::Vec3;

/// Coordinates scaled to a size of about 1.
struct Frame {
  Vec3 centre = Vec3::Zero();
  Mat3 to_frame = Mat3::Identity();
};

Vec3 extents(std::span<const Vec3> points, const Mat3& axes) {
  Vec3 lower = axes * points[0], upper = lower;
  for (const Vec3& p : points) lower = lower.cwiseMin(axes * p), upper = upper.cwiseMax(axes * p);
  return upper - lower;
}

/// Returns, as rows, the directions in which the points spread, the narrowest first.
Mat3 principal_axes(std::span<const Vec3> points, const Vec3& about) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += (p - about) / double(points.size());
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : points) spread += (p - about - mean) * (p - about - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().transpose();
}

/// Scales slender sets of points to equal extents, since flatness is relative to the size; the hull of the
/// scaled points has the same vertices.
Frame frame_of(std::span<const Vec3> points) {
  constexpr double slender = 0.1;
  if (points.size() < 4)
    throw std::invalid_argument("a convex hull needs at least 4 points, there are " +
                                std::to_string(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite()) throw std::invalid_argument("point " + std::to_string(i) + " is not finite");
  Vec3 lower = points[0], upper = points[0];
  for (const Vec3& p : points) lower = lower.cwiseMin(p), upper = upper.cwiseMax(p);
  const double size = (upper - lower).maxCoeff();
  if (!(size > 0)) throw std::invalid_argument("all points are the same");
  Frame frame{0.5 * (lower + upper), Mat3::Identity() / size};
  std::vector<Vec3> about_centre;
  for (const Vec3& p : points) about_centre.push_back(p - frame.centre);
  const Mat3 axes = principal_axes(points, frame.centre);
  const Vec3 along = extents(about_centre, axes);
  if (!(along[0] > 10 * hull_flatness * size))
    throw std::invalid_argument("all points lie in one plane, or nearly: they enclose no volume");
  if (along.minCoeff() < slender * size) frame.to_frame = along.cwiseInverse().asDiagonal() * axes;
  return frame;
}

/// Owns qhull's state and its messages. qhull's errors jump to the end of qh_new_qhull, which returns a code;
/// no other call that can fail is made, so qhull cannot end the process.
class Qhull {
 public:
  /// Finds the hull of n points, x y z each, of size about 1.
  Qhull(double* coordinates, int n, double flatness) : messages_(open_memstream(&text_, &length_)) {
    qh_zero(&state_, messages_);
    char command[64];
    std::snprintf(command, sizeof command, "qhull C-%g", flatness);
    code_ = qh_new_qhull(&state_, 3, n, coordinates, False, command, nullptr, messages_);
  }
  ~Qhull() {
    int blocks = 0, bytes = 0;
    qh_freeqhull(&state_, !qh_ALL);
    qh_memfreeshort(&state_, &blocks, &bytes);
    std::fclose(messages_);
    std::free(text_);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  void require_success() {
    if (code_ == 0) return;
    std::fflush(messages_);
    const std::string all(text_, length_);
    throw std::invalid_argument("qhull finds no hull of the points: " + all.substr(0, all.find('\n')));
  }

  /// The points at the corners of a facet, unordered, and its outward normal.
  struct Facet {
    std::vector<int> corners;
    Vec3 normal;
  };
  std::vector<Facet> facets() {
    std::vector<Facet> all;
    qhT* qh = &state_;  // the name that qhull's macros use
    facetT* facet;
    vertexT *vertex, **vertexp;
    FORALLfacets {
      Facet f{{}, {facet->normal[0], facet->normal[1], facet->normal[2]}};
      FOREACHvertex_(facet->vertices) f.corners.push_back(qh_pointid(qh, vertex->point));
      all.push_back(std::move(f));
    }
    return all;
  }

 private:
  qhT state_;
  char* text_ = nullptr;
  std::size_t length_ = 0;
  std::FILE* messages_;
  int code_ = 0;
};

/// Orders the corners of a convex polygon counter-clockwise as seen against the normal.
void put_in_order(std::vector<int>& corners, std::span<const Vec3> points, const Vec3& normal) {
  Vec3 centre = Vec3::Zero();
  for (const int c : corners) centre += points[c] / double(corners.size());
  const Vec3 right = normal.unitOrthogonal(), up = normal.cross(right);
  std::map<int, double> angle;
  for (const int c : corners)
    angle[c] = rigid::elementary::atan2(up.dot(points[c] - centre), right.dot(points[c] - centre));
  std::sort(corners.begin(), corners.end(), [&](int a, int b) { return angle[a] < angle[b]; });
}

}  // namespace

std::vector<HullFace> hull_faces(std::span<const Vec3> points, double flatness) {
  const Frame frame = frame_of(points);
  std::vector<Vec3> scaled;
  for (const Vec3& p : points) scaled.push_back(frame.to_frame * (p - frame.centre));
  Qhull qhull(scaled[0].data(), int(scaled.size()), flatness);
  qhull.require_success();
  std::vector<HullFace> faces;
  const bool is_mirrored = frame.to_frame.determinant() < 0;
  for (auto& facet : qhull.facets()) {
    put_in_order(facet.corners, scaled, facet.normal);
    if (is_mirrored) std::reverse(facet.corners.begin(), facet.corners.end());
    faces.push_back({std::move(facet.corners), (frame.to_frame.transpose() * facet.normal).normalized()});
  }
  return faces;
}

ConvexHull convex_hull(std::span<const Vec3> points) {
  std::vector<std::vector<int>> faces;
  std::map<int, int> vertex_of;  // of a point
  for (HullFace& face : hull_faces(points, hull_flatness)) {
    for (const int c : face.corners) vertex_of[c] = 0;
    faces.push_back(std::move(face.corners));
  }
  ConvexHull hull;
  std::vector<Vec3> vertices;
  for (auto& [point, vertex] : vertex_of) {
    vertex = int(vertices.size());
    vertices.push_back(points[point]);
    hull.corners.push_back(point);
  }
  for (auto& face : faces)
    for (int& c : face) c = vertex_of[c];
  hull.mesh = rigid::make_polyhedron_mesh(std::move(vertices), faces, 10 * hull_flatness);
  return hull;
}

}  // namespace silt::adapters
