#include "rigid/shapes/shape.hpp"

#include <array>
#include <deque>
#include <mutex>
#include <numbers>

#include "rigid/math/elementary.hpp"

namespace silt::rigid {

BoundingBox part_box(const Part& part, const Pose& body) {
  return std::visit([&](const auto& s) { return s.bounding_box(body * part.pose); }, part.shape);
}

double reach(const Part& part) {
  return std::visit([&](const auto& s) { return s.reach(part.pose); }, part.shape);
}

bool Compound::contains(const Vec3& x) const {
  return std::ranges::any_of(parts, [&](const Part& part) {
    const Vec3 x_P = part.pose.to_body(x);
    return std::visit([&](const auto& s) { return solid::contains(s, x_P); }, part.shape);
  });
}

double Compound::signed_distance(const Vec3& x) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Part& part : parts) {
    const Vec3 x_P = part.pose.to_body(x);
    least = std::min(least, std::visit([&](const auto& s) { return s.signed_distance(x_P); }, part.shape));
  }
  return least;
}

BoundingBox Compound::bounding_box(const Pose& pose) const {
  BoundingBox all = BoundingBox::empty();
  for (const Part& part : parts) all.add(part_box(part, pose));
  return all;
}

namespace {

// Adding up the parts of a compound counts overlaps several times; the excess is integrated here.

constexpr int fewest_halvings = 3;  // of the rectangles across the rays
constexpr int most_halvings = 9;
constexpr double local_error = 2e-8;  // relative to the volume scale; rectangles above it are refined

struct Rectangle {
  double x, y, width, height;  // centre and full edges
};

struct Interval {
  double lower, upper;
};

/// Moments of a segment of unit cross-section at (x, y), z from lower to upper.
SolidMoments segment(double x, double y, const Interval& z) {
  const double l = z.upper - z.lower;
  const double s1 = 0.5 * (z.upper * z.upper - z.lower * z.lower);
  const double s2 = (z.upper * z.upper * z.upper - z.lower * z.lower * z.lower) / 3;
  SolidMoments m;
  m.volume = l;
  m.first = {x * l, y * l, s1};
  m.second << x * x * l, x * y * l, x * s1, x * y * l, y * y * l, y * s1, x * s1, y * s1, s2;
  return m;
}

class OverlapIntegral {
 public:
  OverlapIntegral(std::vector<Part> parts, double scale) : parts_(std::move(parts)), scale_(scale) {}

  SolidMoments over(const Rectangle& r, const SolidMoments& coarse, int depth) {
    const std::array<Rectangle, 4> quarters = split(r);
    std::array<SolidMoments, 4> fine;
    SolidMoments sum;
    for (int k = 0; k < 4; ++k) sum += fine[k] = gauss(quarters[k]);
    const bool good = depth >= fewest_halvings && difference(sum, coarse) <= local_error;
    if (good || depth >= most_halvings) return sum;
    SolidMoments refined;
    for (int k = 0; k < 4; ++k) refined += over(quarters[k], fine[k], depth + 1);
    return refined;
  }

  SolidMoments gauss(const Rectangle& r) {
    constexpr double node = 0.7745966692414834, at[3] = {-node, 0, node},
                     weight[3] = {5. / 18, 8. / 18, 5. / 18};
    SolidMoments sum;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        add_ray(r.x + 0.5 * r.width * at[i], r.y + 0.5 * r.height * at[j],
                weight[i] * weight[j] * r.width * r.height, sum);
    return sum;
  }

 private:
  static std::array<Rectangle, 4> split(const Rectangle& r) {
    const double w = 0.5 * r.width, h = 0.5 * r.height;
    return {{{r.x - 0.5 * w, r.y - 0.5 * h, w, h},
             {r.x + 0.5 * w, r.y - 0.5 * h, w, h},
             {r.x - 0.5 * w, r.y + 0.5 * h, w, h},
             {r.x + 0.5 * w, r.y + 0.5 * h, w, h}}};
  }

  double difference(const SolidMoments& a, const SolidMoments& b) const {
    const SolidMoments d = a - b;
    const double s3 = scale_ * scale_ * scale_;
    return std::max(std::abs(d.volume) / s3, d.second.cwiseAbs().maxCoeff() / (s3 * scale_ * scale_));
  }

  /// Adds weight x (sum of the parts' segments - their union) along the ray at (x, y).
  void add_ray(double x, double y, double weight, SolidMoments& sum) {
    intervals_.clear();
    for (const Part& part : parts_) {
      const auto i = line_interval(part.shape, part.pose.to_body({x, y, 0}),
                                   part.pose.orientation.conjugate() * Vec3::UnitZ());
      if (i && i->enter < i->leave) intervals_.push_back({i->enter, i->leave});
    }
    if (intervals_.size() < 2) return;
    std::sort(intervals_.begin(), intervals_.end(), [](auto& a, auto& b) { return a.lower < b.lower; });
    double covered = intervals_[0].upper;  // upper end of the union so far
    for (std::size_t k = 1; k < intervals_.size(); ++k) {
      const Interval& i = intervals_[k];
      if (i.lower < covered) sum += segment(x, y, {i.lower, std::min(i.upper, covered)}) * weight;
      covered = std::max(covered, i.upper);
    }
  }

  std::vector<Part> parts_;
  double scale_;
  std::vector<Interval> intervals_;
};

/// Returns a box around all overlaps of two parts, as far as their boxes show; empty if there are none.
BoundingBox overlap_box(const std::vector<Part>& parts) {
  BoundingBox all = BoundingBox::empty();
  std::vector<BoundingBox> boxes;
  boxes.reserve(parts.size());
  for (const Part& part : parts) boxes.push_back(part_box(part, Pose{}));
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 lower = boxes[i].lower.cwiseMax(boxes[j].lower);
      const Vec3 upper = boxes[i].upper.cwiseMin(boxes[j].upper);
      if ((lower.array() >= upper.array()).any()) continue;
      all.add({lower, upper});
    }
  return all;
}

/// Returns the sum of the parts' moments minus the moments of their union, in the body frame, with a relative
/// error of about 1e-5. Integration is exact along parallel rays and uses adaptive Gauss cubature across
/// them. The rays' direction is in general position, along no flat face: the integrand is continuous.
SolidMoments overlap_moments(const std::vector<Part>& parts) {
  // An arbitrary rotation, away from the symmetries of a cube and from the directions of a lattice.
  const Quat turn = Quat(0.8414709848, 0.3141592654, -0.2718281828, 0.3466020610).normalized();
  std::vector<Part> turned = parts;
  double scale = 0;
  for (Part& part : turned) {
    part.pose = Pose{Vec3::Zero(), turn} * part.pose;
    scale = std::max(scale, reach(part));
  }
  const BoundingBox box = overlap_box(turned);
  if ((box.lower.array() >= box.upper.array()).any()) return {};
  const Vec3 centre = 0.5 * (box.lower + box.upper), edges = box.upper - box.lower;
  const Rectangle whole{centre[0], centre[1], edges[0], edges[1]};
  OverlapIntegral integral(std::move(turned), scale);
  const SolidMoments m = integral.over(whole, integral.gauss(whole), 0);
  const Mat3 back = turn.toRotationMatrix().transpose();
  return {m.volume, back * m.first, back * m.second * back.transpose()};
}

/// A cache of the latest results of overlap_moments, whose quadrature takes tens of milliseconds: a case
/// needs the mass of each compound in many places.
class KnownOverlaps {
 public:
  SolidMoments of(const std::vector<Part>& parts) {
    const std::lock_guard lock(mutex_);
    const auto at = std::ranges::find_if(known_, [&](const auto& known) { return known.first == parts; });
    if (at != known_.end()) return at->second;
    if (known_.size() == most) known_.pop_front();
    return known_.emplace_back(parts, overlap_moments(parts)).second;
  }

 private:
  static constexpr std::size_t most = 64;
  std::mutex mutex_;
  std::deque<std::pair<std::vector<Part>, SolidMoments>> known_;
};

}  // namespace

MassProperties Compound::mass_properties() const {
  static KnownOverlaps overlaps;
  constexpr double quadrature_error = 2e-5;  // a fifth of the error stated in shape.hpp
  SolidMoments m;
  for (const Part& part : parts)
    m += moments(std::visit([](const auto& s) { return s.mass_properties(); }, part.shape), part.pose);
  m = m - overlaps.of(parts);
  MassProperties p;
  p.volume = m.volume;
  p.centre = m.first / m.volume;
  p.inertia = inertia_of(m.second - m.volume * p.centre * p.centre.transpose());
  snap_to_symmetry(p, quadrature_error);
  return p;
}

double Compound::least_width() const {
  return elementary::cbrt(6 / std::numbers::pi * mass_properties().volume);
}

Compound Compound::recentred(const Vec3& centre) const {
  Compound moved = *this;
  for (Part& part : moved.parts) part.pose.position -= centre;
  return moved;
}

}  // namespace silt::rigid
