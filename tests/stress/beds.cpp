// Beds poured on a floor between walls until they rest: `beds SHAPE COUNT [SECONDS]`, SHAPE "spheres" or
// "stars" (three crossed capsules, as in cases/segregation). Prints a line every 0.1 s and a verdict; returns
// 1 if a body passed a wall, or if the kinetic energy (of all but the fastest twentieth of the bodies) did
// not fall to 1e-6 of its largest.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <random>
#include <string>

#include "../rigid/scene.hpp"
#include "rigid/math/types.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid {
namespace {

constexpr double radius = 0.1, dt = 1e-3;  // a sphere's; a star has about its volume

Shape star() {
  Compound c;
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
    c.parts.push_back(
        {Capsule{0.5 * radius, 0.875 * radius}, {Vec3::Zero(), rotation_between(Vec3::UnitZ(), axis)}});
  return c;
}

/// About as high as wide, with solid walls all round; bodies start apart from each other.
testing::Scene pour(const std::string& kind, int count) {
  const double spacing = kind == "spheres" ? 2.2 * radius : 2.9 * radius;
  const int across = std::max(2, static_cast<int>(std::cbrt(count)));
  const int layers = (count + across * across - 1) / (across * across);
  testing::Scene s(0.3, 0.4, {across * spacing, across * spacing, (layers + 2) * spacing});
  s.world.gravity = {0, 0, -9.81};
  s.world.contact_margin = 0.1 * radius;
  const int shape = kind == "spheres" ? s.shape(Sphere{radius}) : s.shape(star());
  std::mt19937 random(1);
  std::uniform_real_distribution<> u(-1, 1);
  for (int i = 0; i < count; ++i) {
    const Vec3 cell(i % across, i / across % across, i / (across * across));
    const Quat q = Quat(u(random), u(random), u(random), u(random)).normalized();
    const Vec3 off = 0.04 * radius * Vec3(u(random), u(random), u(random));
    s.append(i, shape, spacing * (cell + Vec3::Constant(0.5)) + off, q);
  }
  s.bodies.reindex();
  std::array<WallSpec, 6> walls;
  for (WallSpec& w : walls) w.solid = true;
  add_walls(s.bodies, s.world, s.extent, walls);
  s.start();
  return s;
}

/// Kinetic energies a body. Nothing brakes a ball that rolls or spins by itself (Coulomb's law knows no
/// rolling friction), so a few may keep what they have for ever: hence three of them.
struct Energies {
  double mean = 0;     // over all
  double resting = 0;  // over all but the fastest twentieth
  double median = 0;
};

Energies energies(const testing::Scene& s) {
  std::vector<double> all;
  for (std::size_t row = 0; row < s.bodies.owned; ++row) all.push_back(s.bodies.kinetic_energy(row));
  std::sort(all.begin(), all.end());
  const auto resting = static_cast<std::ptrdiff_t>(all.size() - all.size() / 20);
  const double slow = std::accumulate(all.begin(), all.begin() + resting, 0.0);
  const double fast = std::accumulate(all.begin() + resting, all.end(), 0.0);
  return {(slow + fast) / static_cast<double>(all.size()), slow / static_cast<double>(resting),
          all[all.size() / 2]};
}

bool inside(const testing::Scene& s) {
  for (std::size_t row = 0; row < s.bodies.owned; ++row)
    for (int d = 0; d < 3; ++d)
      if (!(s.bodies.position[row][d] > 0 && s.bodies.position[row][d] < s.extent.size[d])) return false;
  return true;
}

int run(const std::string& kind, int count, double seconds) {
  testing::backend_name = "auto";
  testing::Scene s = pour(kind, count);
  double largest = 0, deepest = 0;
  Energies e;
  const auto start = std::chrono::steady_clock::now();
  const auto wall = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const int steps = static_cast<int>(std::lround(seconds / dt));
  for (int i = 1; i <= steps; ++i) {
    s.run(1, dt);
    deepest = std::max(deepest, s.report.resolver.penetration);
    if (i % 10 != 0 && i != steps) continue;
    e = energies(s);
    largest = std::max(largest, e.mean);
    if (i % 100 != 0) continue;
    std::printf(
        "%5.1f s: energy a body, of the largest mean: %.2e mean, %.2e of the slowest 95 %%, %.2e median; "
        "overlap %.2e r, contacts %llu, sweeps %d, %.2f us a body and step\n",
        i * dt, e.mean / largest, e.resting / largest, e.median / largest, s.deepest / radius,
        static_cast<unsigned long long>(s.report.resolver.contacts), s.report.resolver.sweeps,
        1e6 * wall() / i / count);
    std::fflush(stdout);
    s.deepest = 0;
  }
  const bool rests = e.resting < 1e-6 * largest, kept = inside(s);
  std::printf(
      "%d %s: energy %.2e of the largest (all bodies: %.2e): %s; %s; deepest overlap %.2e r; %.0f s\n", count,
      kind.c_str(), e.resting / largest, e.mean / largest, rests ? "at rest" : "NOT at rest",
      kept ? "all inside" : "SOME OUTSIDE", deepest / radius, wall());
  return rests && kept ? 0 : 1;
}

}  // namespace
}  // namespace silt::rigid

int main(int argc, char** argv) {
  if (argc < 3 || (std::string(argv[1]) != "spheres" && std::string(argv[1]) != "stars")) {
    std::fputs("usage: beds spheres|stars COUNT [SECONDS]\n", stderr);
    return 2;
  }
  return silt::rigid::run(argv[1], std::atoi(argv[2]), argc > 3 ? std::atof(argv[3]) : 5.0);
}
