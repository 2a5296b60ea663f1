#include "rigid/shapes/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace silt::rigid {
namespace {

using Triangle = TriangleMesh::Triangle;

bool is_before(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

Vec3 nearest_on_segment(const Vec3& a, const Vec3& b, const Vec3& x) {
  const Vec3 along = b - a;
  const double square = along.squaredNorm();
  const double t = square > 0 ? (x - a).dot(along) / square : 0;
  return t <= 0 ? a : t >= 1 ? b : Vec3(a + t * along);
}

/// Compares vertices by number, so that all triangles of an edge return bitwise the same point on it.
Vec3 nearest_on_triangle(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& x) {
  const Triangle& t = mesh.triangles()[triangle];
  const std::span<const Vec3> v = mesh.vertices();
  const Vec3 n = mesh.area_normal(triangle);
  bool above = n.squaredNorm() > 0;
  for (int k = 0; above && k < 3; ++k) {
    const Vec3 &a = v[t[k]], &b = v[t[(k + 1) % 3]];
    above = n.dot((b - a).cross(x - a)) > 0;
  }
  if (above) return x - n * (n.dot(x - v[t[0]]) / n.squaredNorm());
  Vec3 nearest = v[t[0]];
  for (int k = 0; k < 3; ++k) {
    const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
    const Vec3 on_edge = nearest_on_segment(v[low], v[high], x);
    if ((on_edge - x).squaredNorm() < (nearest - x).squaredNorm()) nearest = on_edge;
  }
  return nearest;
}

/// A line transformed to run along z, for exact tests on which side of an edge it passes.
class ShearedRay {
 public:
  ShearedRay(const Vec3& o, const Vec3& d) : origin_(o) {
    d.cwiseAbs().maxCoeff(&z_);
    x_ = (z_ + 1) % 3, y_ = (z_ + 2) % 3;
    shear_ = {d[x_] / d[z_], d[y_] / d[z_], 1 / d[z_]};
  }
  /// Returns t where the line meets a triangle including its edges and corners.
  std::optional<double> meets(const std::array<Vec3, 3>& corners) const {
    std::array<Vec3, 3> p;
    for (int k = 0; k < 3; ++k) {
      const Vec3 r = corners[k] - origin_;
      p[k] = {r[x_] - shear_[0] * r[z_], r[y_] - shear_[1] * r[z_], shear_[2] * r[z_]};
    }
    const auto side = [](const Vec3& a, const Vec3& b) { return a[0] * b[1] - a[1] * b[0]; };
    const double u = side(p[2], p[1]), v = side(p[0], p[2]), w = side(p[1], p[0]), sum = u + v + w;
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return {};
    if (sum == 0) return {};
    return (u * p[0][2] + v * p[1][2] + w * p[2][2]) / sum;
  }

 private:
  Vec3 origin_, shear_;
  int x_, y_, z_;
};

/// Returns t where a ray enters a node's box; infinity if it misses.
double entry(const BoxTree::Node& node, const Vec3& o, const Vec3& d) {
  constexpr double rounding = 1e-12, infinity = std::numeric_limits<double>::infinity();
  double enter = 0, leave = infinity;
  for (int k = 0; k < 3; ++k) {
    if (d[k] == 0) {
      if (o[k] < node.lower[k] || o[k] > node.upper[k]) return infinity;
      continue;
    }
    const double a = (node.lower[k] - o[k]) / d[k], b = (node.upper[k] - o[k]) / d[k];
    enter = std::max(enter, std::min(a, b) - rounding * std::abs(a));
    leave = std::min(leave, std::max(a, b) + rounding * std::abs(b));
  }
  return enter <= leave ? enter : infinity;
}

__extension__ using Whole = __int128;
using Whole3 = std::array<std::int64_t, 3>;

/// Rounds points to integers.
class Raster {
 public:
  explicit Raster(const BoundingBox& box) : origin_(box.lower) {
    constexpr int bits = 38;  // determinants of differences need three times as many and a few
    const double size = (box.upper - box.lower).maxCoeff();
    scale_ = std::ldexp(1.0, bits - 1 - std::ilogb(std::max(size, std::numeric_limits<double>::min())));
  }
  Whole3 operator()(const Vec3& x) const {
    const auto whole = [&](int d) { return std::llround((x[d] - origin_[d]) * scale_); };
    return {whole(0), whole(1), whole(2)};
  }
  double step() const { return 1 / scale_; }

 private:
  Vec3 origin_;
  double scale_;
};

int sign(Whole x) {
  return (x > 0) - (x < 0);
}

/// Returns the side of the line a-b, seen along x, on which p is, with p shifted by epsilon along y and
/// epsilon^2 along z; 0 only for a = b.
int side_of(const Whole3& a, const Whole3& b, const Whole3& p) {
  const Whole by = b[1] - a[1], bz = b[2] - a[2];
  if (const int s = sign(by * (p[2] - a[2]) - bz * (p[1] - a[1]))) return s;
  if (bz != 0) return -sign(bz);
  return sign(by);
}

/// Returns whether the line from p along x crosses a triangle, with p shifted by (e, e^2, e^3), e -> 0.
bool crosses_ahead(const std::array<Whole3, 3>& t, const Whole3& p) {
  const int side = side_of(t[0], t[1], p);
  if (side == 0 || side_of(t[1], t[2], p) != side || side_of(t[2], t[0], p) != side) return false;
  std::array<Whole, 3> u, v;
  for (int d = 0; d < 3; ++d) u[d] = t[1][d] - t[0][d], v[d] = t[2][d] - t[0][d];
  Whole height = 0;
  for (int d = 0; d < 3; ++d) {
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    height += (u[e] * v[f] - u[f] * v[e]) * (t[0][d] - p[d]);
  }
  return sign(height) == side;
}

using Vec3l = Eigen::Matrix<long double, 3, 1>;
using Mat3l = Eigen::Matrix<long double, 3, 3>;

}  // namespace

TriangleMesh::TriangleMesh(std::vector<Vec3> vertices, std::vector<Triangle> triangles)
    : vertices_(std::move(vertices)), triangles_(std::move(triangles)) {
  constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max();
  if (triangles_.empty()) throw std::invalid_argument("a mesh without triangles");
  if (triangles_.size() > most || vertices_.size() > most)
    throw std::invalid_argument("a mesh of more than 4294967295 triangles or corners");
  for (const Triangle& t : triangles_)
    for (const std::uint32_t corner : t)
      if (corner >= vertices_.size())
        throw std::invalid_argument("a triangle has corner " + std::to_string(corner) + " of " +
                                    std::to_string(vertices_.size()));
  sort_vertices();
  sort_triangles();
  build_tree();
}

void TriangleMesh::sort_vertices() {
  std::vector<std::uint32_t> order(vertices_.size()), rank(vertices_.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return is_before(vertices_[a], vertices_[b]) || (!is_before(vertices_[b], vertices_[a]) && a < b);
  });
  std::vector<Vec3> sorted(vertices_.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) sorted[k] = vertices_[order[k]], rank[order[k]] = k;
  vertices_.swap(sorted);
  for (Triangle& t : triangles_)
    for (std::uint32_t& corner : t) corner = rank[corner];
}

void TriangleMesh::sort_triangles() {
  for (Triangle& t : triangles_) std::rotate(t.begin(), std::ranges::min_element(t), t.end());
  std::sort(triangles_.begin(), triangles_.end());
}

void TriangleMesh::build_tree() {
  std::vector<BoundingBox> boxes(triangles_.size(), BoundingBox::empty());
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    for (const Vec3& x : corners(t)) boxes[t].add({x, x}), radius_ = std::max(radius_, x.norm());
    box_.add(boxes[t]);
  }
  std::vector<std::uint32_t> order;
  tree_ = BoxTree(boxes, order);
  std::vector<Triangle> along_leaves(triangles_.size());
  for (std::size_t k = 0; k < order.size(); ++k) along_leaves[k] = triangles_[order[k]];
  triangles_.swap(along_leaves);
}

Vec3 TriangleMesh::area_normal(std::uint32_t triangle) const {
  const auto [a, b, c] = corners(triangle);
  return (b - a).cross(c - a);
}

TriangleMesh::Nearest TriangleMesh::nearest(const Vec3& x, double within) const {
  constexpr double rounding = 1e-12;  // so that no triangle of equal distance is missed
  Nearest best;
  double square = within * within, limit = square;
  tree_.search([&](const BoxTree::Node& node) { return node.squared_distance(x); }, limit,
               [&](std::uint32_t t) {
                 const Vec3 point = nearest_on_triangle(*this, t, x);
                 const double found = (point - x).squaredNorm();
                 const bool none = best.distance == std::numeric_limits<double>::infinity();
                 if (!(found < square || (found == square && (none || t < best.triangle)))) return;
                 best = {std::sqrt(found), t, point};
                 square = found, limit = found * (1 + rounding);
               });
  return best;
}

std::optional<TriangleMesh::Hit> TriangleMesh::first_hit(const Vec3& o, const Vec3& d, double t_max) const {
  if (!(d.cwiseAbs().maxCoeff() > 0)) return {};
  const ShearedRay ray(o, d);
  std::optional<Hit> best;
  double limit = t_max;
  tree_.search([&](const BoxTree::Node& node) { return entry(node, o, d); }, limit,
               [&](std::uint32_t t) {
                 const auto met = ray.meets(corners(t));
                 if (!met || *met < 0 || *met > limit) return;
                 if (best && *met == best->t && t > best->triangle) return;
                 best = {*met, t}, limit = *met;
               });
  return best;
}

bool TriangleMesh::encloses(const Vec3& x, const std::function<bool(std::uint32_t)>& counts) const {
  for (int d = 0; d < 3; ++d)
    if (!(x[d] >= box_.lower[d] && x[d] <= box_.upper[d])) return false;
  const Raster raster(box_);
  const Whole3 p = raster(x);
  const Vec3 near = Vec3::Constant(2 * raster.step());
  BoundingBox ahead{x - near, x + near};
  ahead.upper[0] = box_.upper[0];
  bool odd = false;
  for_near(ahead, [&](std::uint32_t t) {
    const auto [a, b, c] = corners(t);
    odd ^= crosses_ahead({raster(a), raster(b), raster(c)}, p) && counts(t);
  });
  return odd;
}

MassProperties TriangleMesh::mass_properties() const {
  constexpr double rounding = 1e-13;
  const Vec3 about = 0.5 * (box_.lower + box_.upper);
  long double volume = 0;  // six times the volume
  Vec3l first = Vec3l::Zero();
  Mat3l second = Mat3l::Zero();
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const auto corner = corners(t);
    const auto from = [&](const Vec3& x) -> Vec3l {
      return x.cast<long double>() - about.cast<long double>();
    };
    const Vec3l a = from(corner[0]), b = from(corner[1]), c = from(corner[2]), s = a + b + c;
    const long double v = a.dot(b.cross(c));
    volume += v;
    first += v * s;
    second += v * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  const Vec3l centre = first / (4 * volume);
  const Mat3l about_centre = second / 120 - volume / 6 * centre * centre.transpose();
  MassProperties p{static_cast<double>(volume / 6), about + centre.cast<double>(),
                   inertia_of(about_centre.cast<double>())};
  snap_to_symmetry(p, rounding);
  return p;
}

TriangleMesh TriangleMesh::shifted(const Vec3& by) const {
  std::vector<Vec3> moved = vertices_;
  for (Vec3& x : moved) x += by;
  return {std::move(moved), triangles_};
}

TriangleMesh TriangleMesh::scaled(double factor) const {
  std::vector<Vec3> larger = vertices_;
  for (Vec3& x : larger) x *= factor;
  return {std::move(larger), triangles_};
}

std::vector<TriangleSide> sides_of(std::span<const Triangle> triangles) {
  std::vector<TriangleSide> sides;
  sides.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]);
      sides.push_back({low, high, t, k});
    }
  std::sort(sides.begin(), sides.end());
  return sides;
}

}  // namespace silt::rigid
