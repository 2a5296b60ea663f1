#include "coupler/build_links.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "rigid/ray_interval.hpp"

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

namespace {

/// Word k of a row of bits moved so that bit x holds what bit x + step held (step -1, 0, 1).
std::uint64_t moved(const std::uint64_t* row, int words, int k, int step) {
  if (step == 0) return row[k];
  if (step > 0) return row[k] >> 1 | (k + 1 < words ? row[k + 1] << 63 : 0);
  return row[k] << 1 | (k > 0 ? row[k - 1] >> 63 : 0);
}

/// Distance of a sphere's surface from r along c, in units of c: the smaller root of |r + q c| = radius.
double sphere_distance(const Vec3& r, Int3 c, double radius) {
  const double a = c.x * c.x + c.y * c.y + c.z * c.z, b = r[0] * c.x + r[1] * c.y + r[2] * c.z;
  const double discriminant = b * b - a * (r.squaredNorm() - radius * radius);
  return (-b - std::sqrt(std::max(discriminant, 0.0))) / a;
}

/// Distance of the inside of a tube along one link direction, in units of it.
class TubeDistance {
 public:
  TubeDistance(double radius, const rigid::Mat3& to_tube) : radius_(radius), across_(to_tube.topRows<2>()) {}
  void point(const Vec3& c) { direction_ = across_ * c, a_ = direction_.squaredNorm(); }
  /// The larger root of |o + q d| = radius, seen along the axis, without cancellation; r is in the hollow.
  double operator()(const Vec3& r) const {
    const Eigen::Vector2d o = across_ * r;
    const double rho = o.norm(), b = o.dot(direction_), c = (rho - radius_) * (rho + radius_);
    const double s = std::sqrt(std::max(b * b - a_ * c, 0.0));
    return b > 0 ? -c / (b + s) : (s - b) / a_;
  }

 private:
  double radius_, a_ = 0;
  Eigen::Matrix<double, 2, 3> across_;
  Eigen::Vector2d direction_ = Eigen::Vector2d::Zero();
};

/// Distance of a body's surface along one link direction, prepared once a body and direction.
class SurfaceDistance {
 public:
  SurfaceDistance(const rigid::Shape& shape, const rigid::Pose& pose)
      : ball_(std::get_if<rigid::Sphere>(&shape)) {
    if (ball_) return;
    const rigid::Mat3 to_body = pose.orientation.toRotationMatrix().transpose();
    if (const auto* tube = std::get_if<rigid::Tube>(&shape)) tube_.emplace(tube->radius, to_body);
    for (const auto& part : rigid::convex_parts(shape)) {
      const rigid::Mat3 to_part = part.pose.orientation.toRotationMatrix().transpose();
      parts_.push_back({part.shape, rigid::reach({part.shape, rigid::Pose{}}), to_part * to_body,
                        to_part * part.pose.position, Vec3::Zero()});
    }
  }
  void point(int i) {
    c_ = lbm::c[i];
    if (tube_) tube_->point(Vec3(c_.x, c_.y, c_.z));
    for (auto& p : parts_) p.direction = p.rotation * Vec3(c_.x, c_.y, c_.z);
  }
  double operator()(const Vec3& r) const {
    if (ball_) return std::clamp(sphere_distance(r, c_, ball_->radius), 0.0, 1.0);
    if (tube_) return std::clamp((*tube_)(r), 0.0, 1.0);
    double q = 1;
    for (const auto& p : parts_) {
      const Vec3 origin = p.rotation * r - p.centre;
      const double reach = p.radius + std::sqrt(2.0);  // of the part and the longest link
      if (origin.squaredNorm() > reach * reach) continue;
      const auto inside = rigid::ray_interval(p.shape, origin, p.direction);
      if (inside && inside->leave >= 0) q = std::min(q, inside->enter);
    }
    return std::clamp(q, 0.0, 1.0);
  }

 private:
  struct PreparedPart {
    rigid::ConvexShape shape;
    double radius;
    rigid::Mat3 rotation;    // world to part
    Vec3 centre, direction;  // of the part from the centre of mass, and of the link; in the part's frame
  };
  const rigid::Sphere* ball_;
  std::optional<TubeDistance> tube_;
  std::vector<PreparedPart> parts_;
  Int3 c_;
};

template <class T>
struct LinkWriter {
  const BlockMap& map;
  const lbm::Block<T>& block;
  WallScheme scheme;
  lbm::CutLinks<T>& links;
  lbm::CutLinks<T> narrow;  // of the direction at work

  static void push(lbm::CutLinks<T>& to, std::ptrdiff_t cell, double q, const Vec3& r) {
    to.cell.push_back(std::int32_t(cell)), to.q.push_back(T(q));
    to.rx.push_back(T(r[0])), to.ry.push_back(T(r[1])), to.rz.push_back(T(r[2]));
  }

  void row(const BodyMask& mask, const SurfaceDistance& distance, int i, int y, int z) {
    const Int3 c = lbm::c[i];
    const std::uint64_t* const body = mask.at(y + c.y, z + c.z);
    const std::uint64_t* const here = map.solid.at(y, z);
    const std::uint64_t* const back = map.solid.at(y - c.y, z - c.z);
    for (int k = 0; k < mask.words; ++k) {
      const std::uint64_t cut = moved(body, mask.words, k, c.x) & ~here[k] & map.solid.interior(k);
      if (!cut) continue;
      const std::uint64_t blocked = moved(back, mask.words, k, -c.x);
      for_bits(cut, k, [&](int x) {
        const Vec3 r = mask.arm(map.box.lower + Int3{x, y, z});
        const double q = scheme == WallScheme::bounce_back ? 0.5 : distance(r);
        const bool no_fluid_behind = blocked >> ((x + 1) & 63) & 1;
        push(no_fluid_behind && lbm::reads_behind(scheme, q) ? narrow : links, block.cell(x, y, z), q, r);
      });
    }
  }

  void body(int surface, const BodyMask& mask, SurfaceDistance distance) {
    const Int3 size = map.box.size;
    for (int i = 1; i < lbm::directions; ++i) {
      const Int3 c = lbm::c[i];
      distance.point(i);
      const auto begin = std::uint32_t(links.size());
      narrow.clear();
      for (int z = std::max(mask.z0 - c.z, 0); z < std::min(mask.z1 - c.z, size.z); ++z)
        for (int y = std::max(mask.y0 - c.y, 0); y < std::min(mask.y1 - c.y, size.y); ++y)
          row(mask, distance, i, y, z);
      end_run(begin, surface, i, scheme);
      const auto end = std::uint32_t(links.size());
      append(narrow);
      end_run(end, surface, i, WallScheme::narrow);
    }
  }

  void end_run(std::uint32_t begin, int surface, int i, WallScheme s) {
    if (const auto end = std::uint32_t(links.size()); end > begin)
      links.runs.push_back({begin, end, surface, std::uint8_t(i), s});
  }
  void append(const lbm::CutLinks<T>& more) {
    for (std::size_t l = 0; l < more.size(); ++l)
      push(links, more.cell[l], more.q[l], {more.rx[l], more.ry[l], more.rz[l]});
  }
};

}  // namespace

template <class T>
void build_links(const BlockMap& map, const lbm::Block<T>& block, const rigid::World& world,
                 const rigid::BodySet& bodies, WallScheme scheme, lbm::CutLinks<T>& links) {
  links.clear();
  LinkWriter<T> writer{map, block, scheme, links, {}};
  for (int k = 0; k < int(map.masks.size()); ++k) {
    const BodyMask& mask = map.masks[k];
    if (!mask.any) continue;
    writer.body(k, mask, SurfaceDistance(world.shapes[bodies.shape[mask.row]], mask.pose));
  }
}

template void build_links(const BlockMap&, const lbm::Block<float>&, const rigid::World&,
                          const rigid::BodySet&, WallScheme, lbm::CutLinks<float>&);
template void build_links(const BlockMap&, const lbm::Block<double>&, const rigid::World&,
                          const rigid::BodySet&, WallScheme, lbm::CutLinks<double>&);

}  // namespace silt::coupler
