// Spheres at rest in a closed funnel, a square one, of triangles and of half-spaces: `funnel BACKEND COUNT
// STEPS`. Prints the overlaps of both and a verdict; returns 1 if a sphere leaked, if the spheres did not
// come to rest, or if those in the mesh overlap more, in the second half of the run, than between the
// half-spaces.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>

#include "../rigid/scene.hpp"
#include "../rigid/shapes/meshes.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {
namespace {

constexpr double radius = 0.1, dt = 1e-3;
constexpr double same = 1e-3;  // radii: overlaps of two packings at rest may be so far apart

/// Half diagonals of its squares, and heights: a slope of 45 degrees to the floor across the edges, a shaft
/// above.
struct Funnel {
  double outlet = 0.5, shaft = 2.5, rim = 2 / std::numbers::sqrt2, top = 6.5;
  Vec3 origin{4, 4, 1};

  TriangleMesh surface() const {
    constexpr int rings = 8;
    std::vector<std::pair<double, double>> profile{{0, 0}};
    for (int i = 0; i <= rings; ++i)
      profile.emplace_back(outlet + (shaft - outlet) * i / rings, rim * i / rings);
    for (int i = 1; i <= rings; ++i) profile.emplace_back(shaft, rim + (top - rim) * i / rings);
    profile.emplace_back(0, top);
    return testing::lathe_mesh(profile, 4);
  }
};

void add_plane(testing::Scene& s, const Vec3& point, const Vec3& normal, int number) {
  s.world.shapes.push_back(HalfSpace{normal});
  s.world.bounding_radii.push_back(std::numeric_limits<double>::infinity());
  BodyRecord wall;
  wall.id = first_wall_id + number;
  wall.shape = static_cast<std::int32_t>(s.world.shapes.size()) - 1;
  wall.kind = -1;
  wall.motion = Motion::fixed;
  Eigen::Map<Vec3>{wall.position} = point;
  s.bodies.insert(s.bodies.size(), wall);
  ++s.bodies.walls;
  s.bodies.reindex();
}

void add_planes(testing::Scene& s, const Funnel& f) {
  int number = 0;
  add_plane(s, f.origin, Vec3::UnitZ(), number++);
  add_plane(s, f.origin + f.top * Vec3::UnitZ(), -Vec3::UnitZ(), number++);
  for (int k = 0; k < 4; ++k) {
    const double u = (k + 0.5) * std::numbers::pi / 2;
    const Vec3 out(std::cos(u), std::sin(u), 0);
    const double near = f.outlet / std::numbers::sqrt2, far = f.shaft / std::numbers::sqrt2;
    add_plane(s, f.origin + far * out, -out, number++);
    add_plane(s, f.origin + near * out, (-f.rim * out + (far - near) * Vec3::UnitZ()).normalized(), number++);
  }
}

struct Outcome {
  double deepest = 0, deepest_late = 0, energy = 0;  // overlaps in radii; energy: of the largest
  bool kept = true;
};

Outcome settle(bool of_triangles, const char* backend, int count, int steps) {
  testing::backend_name = backend;
  testing::Scene s(0.3, 0.3, {8, 8, 10});
  s.world.gravity = {0, 0, -9.81};
  s.world.contact_margin = 0.1 * radius;
  const Funnel funnel;
  const int ball = s.shape(Sphere{radius});
  std::mt19937 random(1);
  std::uniform_real_distribution<> u(-0.04 * radius, 0.04 * radius);
  constexpr int across = 10;
  for (int i = 0; i < count; ++i) {
    const Vec3 site(i % across - 4.5, i / across % across - 4.5, i / (across * across));
    s.append(i, ball, funnel.origin + 2.2 * radius * site + Vec3(u(random), u(random), u(random) + 2),
             Quat::Identity());
  }
  s.bodies.reindex();
  const Mesh vessel = testing::vessel_of(funnel.surface());
  if (of_triangles)
    add_wall(s.bodies, s.world, {vessel, {funnel.origin, Quat::Identity()}, Vec3::UnitZ(), 0, {}});
  else
    add_planes(s, funnel);
  s.start();

  Outcome outcome;
  double largest = 0;
  for (int i = 1; i <= steps; ++i) {
    s.run(1, dt);
    outcome.deepest = std::max(outcome.deepest, s.report.resolver.penetration / radius);
    if (i > steps / 2)
      outcome.deepest_late = std::max(outcome.deepest_late, s.report.resolver.penetration / radius);
    outcome.energy = s.kinetic_energy();
    largest = std::max(largest, outcome.energy);
    if (i % 1000 != 0) continue;
    for (std::size_t row = 0; row < s.bodies.owned; ++row)
      outcome.kept &= vessel.signed_distance(s.bodies.position[row] - funnel.origin) > 0.9 * radius;
  }
  outcome.energy /= largest;
  std::printf("%s: overlap %.2e r, in the second half %.2e r; energy %.1e of the largest; %s\n",
              of_triangles ? backend : "half-spaces", outcome.deepest, outcome.deepest_late, outcome.energy,
              outcome.kept ? "none leaked" : "SOME LEAKED");
  std::fflush(stdout);
  return outcome;
}

int run(const char* backend, int count, int steps) {
  const Outcome planes = settle(false, backend, count, steps), mesh = settle(true, backend, count, steps);
  const bool rests = mesh.energy < 1e-5 && planes.energy < 1e-5;
  const bool sound = mesh.deepest_late <= planes.deepest_late + same;
  std::printf("%d spheres, %d steps: %s, %s\n", count, steps, rests ? "at rest" : "NOT at rest",
              sound ? "overlaps as between half-spaces" : "MORE overlap than between half-spaces");
  return mesh.kept && planes.kept && rests && sound ? 0 : 1;
}

}  // namespace
}  // namespace silt::rigid

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: funnel BACKEND COUNT STEPS\n", stderr);
    return 2;
  }
  return silt::rigid::run(argv[1], std::atoi(argv[2]), std::atoi(argv[3]));
}
