// Times of contacts with meshes, by the tree of each backend:
//   benchmarks mesh_pairs [TRIANGLES ACROSS]
// The floor has 2 n n triangles on its upper side (n = 100), bodies on it are some 1, 4 and 16 triangles
// across.
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "adapters/automatic/collision_factory.hpp"
#include "rigid/collision/mesh_contacts.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/bench/figures.hpp"
#include "tests/rigid/shapes/meshes.hpp"

namespace silt::bench::mesh_pairs {
namespace {

using namespace rigid;

constexpr const char* backends[] = {"analytic", "bullet", "fcl"};
constexpr int places = 50, times = 20;
constexpr double tolerance = 0.02;

std::shared_ptr<const TriangleMesh> shared(TriangleMesh mesh) {
  return std::make_shared<const TriangleMesh>(std::move(mesh));
}

/// Calls collide(place) for all places, several times; nanoseconds a call.
template <class Collide>
double nanoseconds(Collide&& collide) {
  for (int p = 0; p < places; ++p) collide(p);
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < times; ++i)
    for (int p = 0; p < places; ++p) collide(p);
  const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - start;
  return taken.count() / (places * times);
}

struct Row {
  const char* name;
  double lift;  // of the centre over the floor
  ConvexShape shape;
};

std::vector<Row> bodies(double size) {
  return {{"sphere", 0.5, Sphere{0.5 * size}},
          {"box", 0.3, Box{size * Vec3(0.5, 0.4, 0.3)}},
          {"capsule", 0.55, Capsule{0.25 * size, 0.3 * size}},
          {"cylinder", 0.3, Cylinder{0.5 * size, 0.3 * size}},
          {"ellipsoid", 0.3, Ellipsoid{size * Vec3(0.5, 0.4, 0.3)}}};
}

Pose place(int p, double n, double height) {
  return {{n * (0.3 + 0.4 * p / places), n * (0.3 + 0.4 * (p * 7 % places) / places), height},
          Quat(Eigen::AngleAxisd(0.1 * p, Vec3::UnitZ()))};
}

void on_floor(int n) {
  const MeshFeatures floor(Mesh{shared(rigid::testing::random_slab(n, n / 4.0, n, 1))});
  for (const double size : {1.0, 4.0, 16.0})
    for (const Row& row : bodies(size)) {
      std::printf("| %s, %.0f triangles across, on a floor |", row.name, size);
      const auto surface = features_of_polytope(row.shape);
      std::vector<ContactPoint> points;
      for (const char* name : backends) {
        const auto backend = adapters::make_backend(name);
        std::printf(" %.0f |", nanoseconds([&](int p) {
                      points.clear();
                      append_mesh_contacts({row.shape, surface.get(), place(p, n, row.lift * size - 0.001)},
                                           {floor, {}}, tolerance, *backend, points);
                    }));
      }
      std::printf("\n");
    }
}

void rings() {
  const MeshFeatures ring(Mesh{shared(rigid::testing::torus_mesh(1, 0.2, 48, 24))});
  std::printf("| ring in ring, 2304 triangles each |");
  std::vector<ContactPoint> points;
  for (const char* name : backends) {
    const auto backend = adapters::make_backend(name);
    std::printf(
        " %.0f |", nanoseconds([&](int p) {
          points.clear();
          const Quat turn(Eigen::AngleAxisd(1.2 + 0.01 * p, Vec3::UnitY()));
          append_mesh_contacts({ring, {{0, -1.601, 0}, turn}}, {ring, {}}, tolerance, *backend, points);
        }));
  }
  std::printf("\n");
}

}  // namespace

void run(const Options& options) {
  std::printf("| pair, ns | analytic | auto, bullet | fcl |\n|---|---|---|---|\n");
  on_floor(options.others.empty() ? 100 : std::stoi(options.others[0]));
  rings();
}

}  // namespace silt::bench::mesh_pairs
