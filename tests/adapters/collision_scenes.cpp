#include "tests/adapters/collision_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>

namespace silt::tests {

namespace {

/// Returns the number of scenes of a pair of kinds in each band. Scenes whose reference is a search cost
/// milliseconds each: SILT_SCENES=200 in the environment asks for more of them.
int scenes_of(Kind a, Kind b) {
  if (has_closed_form(a, b)) return 40;
  const char* wanted = std::getenv("SILT_SCENES");
  return wanted ? std::atoi(wanted) : 4;
}

void add_scenes(Kind a, Kind b, std::mt19937_64& random, std::vector<Scene>& scenes) {
  const int each = scenes_of(a, b);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const char* band : {"apart", "touching", "overlapping", "deep"})
    for (int i = 0; i < each; ++i) {
      const double u = unit(random);
      Pair p;
      switch (band[0]) {
        case 'a':
          p = random_pair(a, b, std::pow(10, -3 + 2.99 * u), random);
          break;
        case 't':
          p = random_pair(a, b, (2 * u - 1) * 1e-7, random);
          break;
        case 'o':
          p = random_pair(a, b, -3 * std::pow(10, -3 + 2.5 * u), random);
          break;
        default:
          p = random_pair(a, b, -1e-3, random);
          p.pose_b.position = p.pose_a.position + u * (p.pose_b.position - p.pose_a.position);
      }
      scenes.push_back({a, b, band, p, reference_gap(p)});
    }
}

}  // namespace

const std::vector<Scene>& random_scenes() {
  static const std::vector<Scene> scenes = [] {
    std::vector<Scene> all;
    std::mt19937_64 random(20);
    for (const bool closed_form : {true, false})
      for (const Kind a : bodies())
        for (const Kind b : all_kinds())
          if (has_closed_form(a, b) == closed_form) add_scenes(a, b, random, all);
    return all;
  }();
  return scenes;
}

const rigid::ContactPoint& deepest(const Points& points) {
  if (points.empty()) throw std::runtime_error("no contact point where there must be one");
  return *std::min_element(points.begin(), points.end(),
                           [](const auto& p, const auto& q) { return p.gap < q.gap; });
}

double off_surface(const ConvexShape& shape, const Pose& pose, const Vec3& x) {
  return std::visit(
      [&](const auto& s) { return std::abs(rigid::signed_distance(rigid::Shape(s), pose.to_body(x))); },
      shape);
}

Quat turned(double degrees, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()));
}

Pair stacked_boxes(const Vec3& upper, const Vec3& offset, double degrees_about_z, double gap) {
  Pair p{rigid::Box{{4, 3, 2}}, rigid::Box{upper}, {}, {}};
  p.pose_b = {Vec3(offset.x(), offset.y(), 2 + upper.z() + gap), turned(degrees_about_z, Vec3::UnitZ())};
  return p;
}

}  // namespace silt::tests
