#include "rigid/shapes/compound.hpp"

#include <deque>
#include <mutex>
#include <numbers>

#include "rigid/math/elementary.hpp"
#include "rigid/shapes/defaults.hpp"
#include "rigid/shapes/overlap_quadrature.hpp"

namespace silt::rigid {

BoundingBox part_box(const Part& part, const Pose& body) {
  return std::visit([&](const auto& s) { return s.bounding_box(body * part.pose); }, part.shape);
}

double reach(const Part& part) {
  return std::visit([&](const auto& s) { return s.reach(part.pose); }, part.shape);
}

bool Compound::contains(const Vec3& x) const {
  return std::any_of(parts.begin(), parts.end(), [&](const Part& part) {
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

double Compound::ray_distance(const Vec3& o, const Vec3& d, double t_max) const {
  double t = t_max;
  for (const Part& part : parts) {
    const Vec3 o_P = part.pose.to_body(o), d_P = part.pose.orientation.conjugate() * d;
    t = std::visit([&](const auto& s) { return solid::ray_distance(s, o_P, d_P, t); }, part.shape);
  }
  return t;
}

BoundingBox Compound::bounding_box(const Pose& pose) const {
  BoundingBox all = BoundingBox::empty();
  for (const Part& part : parts) all.add(part_box(part, pose));
  return all;
}

namespace {

/// What overlap_moments, tens of milliseconds of quadrature, said of the compounds asked about last: a case
/// asks for the mass of each of its compounds in many places.
class KnownOverlaps {
 public:
  SolidMoments of(const std::vector<Part>& parts) {
    const std::lock_guard lock(mutex_);
    const auto at =
        std::find_if(known_.begin(), known_.end(), [&](const auto& known) { return known.first == parts; });
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
  constexpr double quadrature_error = 2e-5;  // a fifth of what is promised
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
