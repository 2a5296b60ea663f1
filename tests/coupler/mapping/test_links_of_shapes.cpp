// Links of one body at a time, whatever its shape and size, in blocks of any size and both precisions.
#include <array>
#include <string>

#include "coupler/simulation.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/coupler/case/case_text.hpp"
#include "tests/coupler/mapping/links_by_definition.hpp"
#include "tests/shape_rows.hpp"

namespace silt::coupler::testing {
namespace {

using lbm::Int3;
using rigid::Vec3;

// Wider than a word, taller than a slab of planes.
CaseText large_bodies() {
  CaseText c;
  c.domain = domain_of({96, 40, 44});
  c.shapes = shape_of("egg", "ellipsoid", "diameters = [74.6, 24.8, 34.4]") + sphere_of("ball", 34.6);
  c.bodies =
      body_of("egg", 1, "position = [41.2173, 20.4291, 22.1357]\norientation = [0.98, 0.05, 0.1, 0.02]") +
      body_of("ball", 1, "position = [90.1371, 3.2713, 1.3197]");
  return c;
}

/// One body of every shape, oblique and in line with the axes, across the sides of the box.
CaseText one_of_each() {
  CaseText c;
  c.domain = domain_of({45, 30, 26});
  c.shapes = c.bodies = "";
  std::vector<std::array<std::string, 2>> shapes;
  for (const tests::ShapeRow& row : tests::shape_rows()) {
    if (row.name == rigid::Sphere::name) continue;  // spheres have tests of their own
    shapes.push_back({std::string(row.name), row.sizes});
  }
  shapes.push_back({"compound",
                    "parts = [ { type = \"capsule\", radius = 1.6, length = 6, axis = [1, 0, 0] },\n"
                    "{ type = \"capsule\", radius = 1.6, length = 6, axis = [0, 1, 0] },\n"
                    "{ type = \"capsule\", radius = 1.6, length = 6, axis = [0, 0, 1] } ]"});
  shapes.push_back({"compound",
                    "parts = [ { type = \"sphere\", radius = 2.2, position = [3, 1, 0] },\n"
                    "{ type = \"box\", edges = [4, 3, 2.5], position = [-2, 0, 1], axis = [1, 2, 3] },\n"
                    "{ type = \"cylinder\", radius = 1.1, length = 7, axis = [0, 1, 1] },\n"
                    "{ type = \"ellipsoid\", diameters = [3, 4, 5], position = [0, -2, -1] },\n"
                    "{ type = \"polyhedron\", position = [0, 1, 1], " +
                        tests::row_of("polyhedron").sizes + " } ]"});
  int n = 0;
  for (const auto& [type, sizes] : shapes) {
    const std::string name = type + std::to_string(n / 2);
    c.shapes += shape_of(name, type, sizes);
    for (const char* turn : {"[1, 0, 0, 0]", "[0.7, 0.3, -0.5, 0.2]"}) {
      const auto at = [](int slot, int slots, double size, double shift) {
        return std::to_string(std::fmod((slot + shift) * size / slots, size));
      };
      c.bodies +=
          body_of(name, 1,
                  std::string("orientation = ") + turn + "\nposition = [" +
                      at(n % 4, 4, 45, 0.93 + 0.0041 * n) + ", " + at(n / 4 % 2, 2, 30, 0.9173 + 0.0031 * n) +
                      ", " + at(n / 8, 2, 26, 0.0341 + 0.0017 * n) + "]");
      ++n;
    }
  }
  return c;
}

/// Every q of the domain, by global cell and direction.
using Distances = std::map<std::tuple<int, int, int, int>, double>;

template <class T>
Distances distances(const CaseText& scene, Int3 block, double rounding) {
  Simulation s = scene.start(MPI_COMM_SELF);
  std::vector<lbm::CellBox> boxes;
  const Int3 n = s.scene().flow->fields().domain().cells();
  for (int z = 0; z < n.z; z += block.z)
    for (int y = 0; y < n.y; y += block.y)
      for (int x = 0; x < n.x; x += block.x) boxes.push_back({{x, y, z}, block});
  MapBodies map(s.scene().flow->fields().domain(), s.scene().world, boxes, 1);
  map(s.bodies());
  Distances all;
  LinkKinds kinds;
  for (const BlockMap& b : map.blocks()) {
    std::vector<SurfaceLinks<T>> surfaces;
    expect_all_links<T>(s, b, WallScheme::cli, rounding, surfaces, kinds);
    for (const auto& surface : surfaces)
      for (const lbm::LinkGroup& g : surface.links.groups)
        for (std::uint32_t l = g.begin; l < g.begin + g.count; ++l) {
          const std::uint32_t p = surface.links.place[l];
          const Int3 x = b.box.lower + g.corner + lbm::place_cell(p);
          all[{x.x, x.y, x.z, lbm::place_direction(p)}] = surface.links.q[l];
        }
  }
  return all;
}

/// Root of the mean square of what single precision takes away. For one link it is up to 1e-7 R^2 over its
/// way through the body: much where it grazes the surface.
void expect_close(const Distances& single, const Distances& exact, double bound) {
  EXPECT_EQ(single.size(), exact.size());
  double squares = 0;
  for (const auto& [link, q] : exact) squares += std::pow(single.at(link) - q, 2);
  EXPECT_LT(std::sqrt(squares / double(exact.size())), bound);
}

TEST(LinksOfShapes, OfEveryKind) {
  const CaseText scene = one_of_each();
  const Distances whole = distances<double>(scene, {45, 30, 26}, 1e-9);
  EXPECT_EQ(whole, distances<double>(scene, {15, 10, 13}, 1e-9));
  const Distances single = distances<float>(scene, {15, 15, 13}, 3e-5);
  EXPECT_EQ(single, distances<float>(scene, {9, 10, 26}, 3e-5));
  expect_close(single, whole, 1e-6);
}

TEST(LinksOfShapes, LargerThanAWord) {
  const Distances exact = distances<double>(large_bodies(), {96, 40, 44}, 1e-9);
  expect_close(distances<float>(large_bodies(), {96, 40, 44}, 5e-4), exact, 4e-6);
}

}  // namespace
}  // namespace silt::coupler::testing
