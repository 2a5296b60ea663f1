// The kernels of object mapping, for every kind of part: against the shapes themselves, and the same bits on
// every instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "coupler/mapping/bit_kernel.hpp"
#include "coupler/mapping/surface_distance.hpp"
#include "cpu/isa.hpp"
#include "rigid/shapes/surface_parts.hpp"
#include "tests/coupler/mapping/edges_by_definition.hpp"
#include "tests/ray_distance.hpp"
#include "tests/shape_rows.hpp"

namespace silt::coupler {
namespace {

using lbm::Int3;
using rigid::Vec3;

const rigid::Quat oblique = rigid::Quat(0.7, 0.3, -0.5, 0.2).normalized();

/// A few cells wide each, the inside of the tube too; the compound has parts of every kind.
std::vector<rigid::Shape> one_of_each_kind() {
  std::vector<rigid::Shape> all;
  rigid::Compound every;
  for (const tests::ShapeRow& row : tests::shape_rows()) {
    const rigid::ConvexShape& part = row.cells_wide;
    all.push_back(part);
    every.parts.push_back({part, {Vec3(0.3, -0.2, 0.5) * double(every.parts.size()), oblique}});
  }
  all.push_back(every);
  all.push_back(rigid::Tube{4.3});
  return all;
}

/// Links of all directions from cells about a body, in whole vectors.
std::vector<std::uint32_t> random_links() {
  std::mt19937 random(5);
  std::vector<std::uint32_t> places(512 * lbm::link_lanes);
  for (std::uint32_t& p : places)
    p = lbm::link_place({int(random() % 16), int(random() % 16), int(random() % 8)}, int(1 + random() % 18));
  return places;
}

const lbm::SurfaceFrame frame{{8, 8, 4}, {0.137, -0.411, 0.279}, 16, true};

template <class T, class Kernel>
std::vector<T> distances(const rigid::Shape& shape, const Kernel& kernel, T past = 0) {
  rigid::SurfaceParts<T> parts;
  parts.reset(shape, oblique);
  const auto places = random_links();
  std::vector<T> q(places.size());
  kernel({places.data(), int(places.size()), {}}, frame, parts.view(), past, q.data());
  return q;
}

template <class Kernel>
BitWindow cells(const rigid::Shape& shape, const Kernel& kernel) {
  rigid::SurfaceParts<double> parts;
  parts.reset(shape, oblique);
  BitWindow window;
  window.reset(BitFrame({-12, -12, -12}, {25, 25, 25}));
  kernel(window.frame(), PointInFrame{0.137, -0.411, 0.279, {-12, -12, -12}}, parts.view(), window.words());
  return window;
}

TEST(SurfaceKernels, AgreeWithTheShapesThemselves) {
  for (const rigid::Shape& shape : one_of_each_kind()) {
    SCOPED_TRACE(std::string(rigid::shape_name(shape)));
    const BitWindow inside = cells(shape, portable::bit_kernels().mark_parts);
    for (int z = -10; z < 11; ++z)
      for (int y = -10; y < 11; ++y)
        for (int x = -10; x < 11; ++x) {
          const Vec3 r = Vec3(x + 0.5, y + 0.5, z + 0.5) - Vec3(0.137, -0.411, 0.279);
          EXPECT_EQ(inside.test({x, y, z}), rigid::contains(shape, oblique.conjugate() * r));
        }
    const auto places = random_links();
    const auto q = distances<double>(shape, portable::surface_distances<double, double>());
    for (std::size_t l = 0; l < places.size(); ++l) {
      const Int3 cell = lbm::place_cell(places[l]) - frame.cell,
                 i = lbm::D3Q19::c[lbm::place_direction(places[l])];
      const Vec3 r = oblique.conjugate() * (Vec3(cell.x, cell.y, cell.z) + Vec3(frame.offset)),
                 c = oblique.conjugate() * Vec3(i.x, i.y, i.z);
      if (!rigid::contains(shape, r)) {
        const double hit = tests::ray_distance(shape, r, c, 1);
        EXPECT_NEAR(q[l], coupler::testing::under_lip(shape, r, c, hit), 1e-8);
      }
    }
  }
}

TEST(SurfaceKernels, FindSurfacesPastTheEndsOfLinks) {
  constexpr double past = 0.25;
  for (const rigid::Shape& shape : one_of_each_kind()) {
    if (std::holds_alternative<rigid::Tube>(shape)) continue;  // rests
    const bool is_compound = std::holds_alternative<rigid::Compound>(shape);
    SCOPED_TRACE(std::string(rigid::shape_name(shape)));
    const auto places = random_links();
    const auto within = distances<double>(shape, portable::surface_distances<double, double>());
    const auto q = distances<double>(shape, portable::surface_distances<double, double>(), past);
    int before = 0, after = 0;
    for (std::size_t l = 0; l < places.size(); ++l) {
      const Int3 cell = lbm::place_cell(places[l]) - frame.cell,
                 i = lbm::D3Q19::c[lbm::place_direction(places[l])];
      const Vec3 c = oblique.conjugate() * Vec3(i.x, i.y, i.z),
                 r = oblique.conjugate() * (Vec3(cell.x, cell.y, cell.z) + Vec3(frame.offset)) - past * c;
      if (rigid::contains(shape, r)) continue;
      const double hit = tests::ray_distance(shape, r, c, 1 + 2 * past) - past;
      if (hit > 0 && hit < 1) {
        EXPECT_EQ(q[l], within[l]);
        continue;
      }
      // some have the surface, or that of a part, behind them
      if (hit <= 0 && (is_compound || !rigid::contains(shape, r + (past + 1) * c))) continue;
      ++(hit <= 0 ? before : after);
      EXPECT_NEAR(q[l], hit, 1e-8);
    }
    if (!is_compound) {
      EXPECT_GT(before, 10);
    }
    EXPECT_GT(after, 10);
  }
}

template <class T>
void expect_same_distances(const rigid::Shape& shape, T past) {
  const auto plain = distances<T>(shape, portable::surface_distances<T, T>(), past);
  EXPECT_GT(std::count_if(plain.begin(), plain.end(), [](T q) { return q > 0 && q < 1; }), 50);
  if (chosen_isa() != Isa::portable) {
    EXPECT_EQ(plain, distances<T>(shape, avx2::surface_distances<T, T>(), past));
  }
  if (chosen_isa() == Isa::avx512) {
    EXPECT_EQ(plain, distances<T>(shape, avx512::surface_distances<T, T>(), past));
  }
}

/// The cells next to a body, and the links between them that begin in some planes.
struct CellsBeside {
  BitWindow cells;
  std::vector<std::uint32_t> links;
  bool operator==(const CellsBeside&) const = default;
};
CellsBeside cells_beside(const BitWindow& body, const BitKernels& kernels) {
  CellsBeside found;
  const BitFrame& f = body.frame();
  found.cells.reset(f);
  kernels.widen(f, body.words(), found.cells.words());
  constexpr int planes = 6;
  found.links.resize(std::size_t(planes) * f.size.x * f.size.y * lbm::D3Q19::pairs + lbm::link_lanes);
  found.links.resize(kernels.list_crossings(f, {9, planes, 1, f.size.y - 1}, found.cells.words(),
                                            body.words(), found.links.data()));
  return found;
}

TEST(SurfaceKernels, SameBitsOnEveryInstructionSet) {
  for (const rigid::Shape& shape : one_of_each_kind()) {
    SCOPED_TRACE(std::string(rigid::shape_name(shape)));
    expect_same_distances<float>(shape, 0), expect_same_distances<float>(shape, 0.25f);
    expect_same_distances<double>(shape, 0), expect_same_distances<double>(shape, 0.25);
    const BitWindow plain = cells(shape, portable::bit_kernels().mark_parts);
    EXPECT_EQ(plain.test({0, 0, 0}), !std::holds_alternative<rigid::Tube>(shape));
    const CellsBeside beside = cells_beside(plain, portable::bit_kernels());
    EXPECT_GT(beside.links.size(), 50u);
    if (chosen_isa() != Isa::portable) {
      EXPECT_EQ(plain, cells(shape, avx2::bit_kernels().mark_parts));
      EXPECT_EQ(beside, cells_beside(plain, avx2::bit_kernels()));
    }
    if (chosen_isa() == Isa::avx512) {
      EXPECT_EQ(plain, cells(shape, avx512::bit_kernels().mark_parts));
      EXPECT_EQ(beside, cells_beside(plain, avx512::bit_kernels()));
    }
  }
}

}  // namespace
}  // namespace silt::coupler
