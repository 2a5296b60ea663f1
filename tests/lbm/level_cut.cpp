// Levels: which cells have which level, and how accurate a flow is through borders of levels.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "lbm/levels/level_cut.hpp"
#include "tests/lbm/levelled_cut.hpp"
#include "tests/lbm/levelled_flow.hpp"

namespace silt::lbm {
namespace {

using Boxes = std::vector<LevelBox>;
using testing::LevelledCut;
using testing::LevelledFlow;
using testing::Vector;
using Gradient = std::array<Vector, 3>;

/// Boxes on a grid of so many cells, of every level below `levels`; some stick out of the part.
Boxes random_boxes(int count, int grid, int levels, const CellBox& part, int least, int most) {
  std::mt19937 random(5);
  Boxes boxes;
  for (int k = 0; k < count; ++k) {
    LevelBox& b = boxes.emplace_back();
    b.level = k % levels;
    for (int d = 0; d < 3; ++d) {
      b.box.size[d] = grid * std::uniform_int_distribution(least, most)(random);
      b.box.lower[d] = part.lower[d] + grid * std::uniform_int_distribution(-2, part.size[d] / grid)(random);
    }
  }
  return boxes;
}

int leaves_of(const CellBox& part, const Boxes& boxes, int coarsest) {
  return int(level_cut(part, boxes, coarsest).levels.size());
}

/// The tree of a part at the origin.
CutTree tree_of(const CellBox& part, const LevelCut& cut) {
  std::vector<LeafKind> kinds;
  for (const int level : cut.levels) kinds.push_back({0, level});
  return {part.size, cut.nodes, kinds};
}

TEST(LevelCut, EveryCellHasTheLeastLevelOfItsBoxes) {
  const CellBox part{{}, {48, 40, 32}};
  for (int count = 0; count < 20; ++count) {
    SCOPED_TRACE(count);
    const Boxes boxes = random_boxes(count, 4, 2, part, 2, 8);
    const LevelCut cut = level_cut(part, boxes, 2);
    const CutTree tree = tree_of(part, cut);
    for_cells({}, part.size, [&](Int3 x) {
      int level = 2;
      for (const LevelBox& b : boxes)
        if (b.box.contains(x)) level = std::min(level, b.level);
      ASSERT_EQ(cut.levels[tree.leaf_at(x).index], level);
    });
  }
}

TEST(LevelCut, OfBoxesAlikeTheFinerCounts) {
  const CellBox part{{}, {32, 32, 32}};
  EXPECT_EQ(level_cut(part, Boxes{{part, 0}, {part, 1}}, 2).levels, std::vector<std::int32_t>{0});
}

TEST(LevelCut, PartsAreCutAsTheyLieInTheDomain) {
  const CellBox part{{64, 32, 16}, {32, 32, 32}};
  const Boxes boxes = {{{{72, 40, 24}, {8, 8, 8}}, 0}};
  const LevelCut cut = level_cut(part, boxes, 1);
  EXPECT_EQ(cut.levels.size(), 7u);
  for (const Cut& plane : cut.nodes) {
    EXPECT_GT(plane.position, part.lower[plane.axis]);
    EXPECT_LT(plane.position, part.lower[plane.axis] + part.size[plane.axis]);
  }
}

TEST(LevelCut, AViewHasTheLeavesOfPartsThatAreTold) {
  const CutTree parts({64, 32, 32}, {{0, 32, 2}, {1, 16, 1}});
  const LevelCut cut = level_cut(parts.leaf(1).box, Boxes{{{{8, 16, 8}, {8, 8, 8}}, 0}}, 1);
  const CutTree view = view_of(parts, {{1, cut}});
  const auto leaves = int(cut.levels.size());
  EXPECT_EQ(view.leaves(), leaves + 2);
  for (int k = 0; k < view.leaves(); ++k) {
    const int part = k == 0 ? 0 : k <= leaves ? 1 : 2;
    EXPECT_EQ(view.kinds()[k].rank, part);
    EXPECT_EQ(view.kinds()[k].level, part == 1 ? cut.levels[k - 1] : LeafKind::far);
    EXPECT_EQ(parts.leaf_at(view.leaf(k).box.lower).index, part);
  }
  EXPECT_EQ(view.kinds()[view.leaf_at({8, 16, 8}).index].level, 0);
}

TEST(LevelCut, LeavesAreFew) {
  const CellBox part{{}, {256, 256, 256}};
  const LevelBox inner{{{104, 104, 104}, {32, 32, 32}}, 0}, outer{{{72, 80, 88}, {96, 88, 80}}, 1};
  EXPECT_EQ(leaves_of(part, {}, 2), 1);
  EXPECT_EQ(leaves_of(part, {inner}, 1), 7);
  EXPECT_EQ(leaves_of(part, {outer, inner}, 2), 13);
  EXPECT_EQ(leaves_of(part, {inner, outer, {{{112, 112, 112}, {8, 8, 8}}, 1}}, 2), 13);  // a hidden one
  EXPECT_EQ(leaves_of(part, {{{{-8, -8, -8}, {300, 300, 300}}, 0}}, 1), 1);
  const LevelBox one_half{{{0, 0, 0}, {256, 128, 256}}, 0}, other_half{{{0, 128, 0}, {256, 128, 256}}, 0};
  EXPECT_EQ(leaves_of(part, {one_half, other_half}, 1), 1);
  for (const int count : {50, 200})
    EXPECT_LE(leaves_of(part, random_boxes(count, 4, 1, part, 7, 7), 1), 10 * count) << count;
}

/// A periodic cube of n coarse cells an edge. With `refined` the middle half along each axis has finest
/// cells.
LevelledFlow<double> middle_refined(int n, bool refined, double nu, double magic, Collision model) {
  const int fine = refined ? 2 : 1, edge = fine * n;  // finest cells in a coarse one
  const auto level = [&](Int3 x) {
    bool middle = true;
    for (int d = 0; d < 3; ++d) middle &= x[d] >= edge / 4 && x[d] < 3 * edge / 4;
    return refined && !middle ? 1 : 0;
  };
  const LevelledCut cut({edge, edge, edge}, edge / 4, level);
  return {cut.tree(), {}, {0.5 + 3 * nu * fine, magic, model}, refined ? 1 : 0};
}

/// Returns the error of the velocity in the mean square, over that of the exact flow beside a stream.
template <class Exact>
double relative_error(LevelledFlow<double>& flow, Exact&& exact, const Vector& stream = {}) {
  double error = 0, size = 0;
  flow.for_all([&](Fluid<double>& fluid, int b, Int3 x, const Vector& at, int level) {
    double rho;
    Vector u;
    Gradient gradient;
    exact(at, rho, u, gradient);
    const auto v = fluid.velocity(fluid.moments(b, x));
    for (int d = 0; d < 3; ++d) {
      error += (1 << 3 * level) * std::pow(v[d] - u[d], 2);
      size += (1 << 3 * level) * std::pow(u[d] - stream[d], 2);
    }
  });
  return std::sqrt(error / size);
}

/// Returns the error of a Taylor-Green vortex after nu k^2 t = 1/2; n coarse cells along an edge, their nu.
double vortex_error(int n, double nu, bool refined, Collision model = Collision::trt) {
  const int fine = refined ? 2 : 1, edge = fine * n;
  auto flow = middle_refined(n, refined, nu, 0.25, model);
  const double k = 2 * std::numbers::pi / edge;  // in finest cells
  double speed = 0.02 * 16 / n;
  const auto exact = [&](const Vector& x, double& rho, Vector& u, Gradient& gradient) {
    const double a = k * x[0], b = k * (x[1] + x[2]);
    const double sa = speed * std::sin(a), ca = speed * std::cos(a), sb = std::sin(b), cb = std::cos(b);
    u = {ca * sb, -sa * cb / 2, -sa * cb / 2};
    gradient = {Vector{-k * sa * sb, k * ca * cb, k * ca * cb},
                Vector{-k * ca * cb / 2, k * sa * sb / 2, k * sa * sb / 2},
                Vector{-k * ca * cb / 2, k * sa * sb / 2, k * sa * sb / 2}};
    rho = -1.5 * (u[0] * u[0] + 2 * u[1] * u[1]) - 2.25 * std::pow(ca * cb, 2) + 1.125 * speed * speed;
  };
  flow.set(exact);
  // the wave number squared is 3 k^2; it is that of finest cells, whose nu is twice the coarse one
  const double rate = fine * nu * 3 * k * k;
  const int steps = int(std::lround(0.5 / rate / fine)) * fine;
  flow.step(steps);
  speed *= std::exp(-rate * steps);
  return relative_error(flow, exact);
}

TEST(LevelsAccuracy, VortexIsAsAccurateAsOnTheCoarseLattice) {
  for (const double nu : {0.1, 0.02, 0.005})
    EXPECT_LT(vortex_error(16, nu, true), 1.1 * vortex_error(16, nu, false));
  EXPECT_LT(vortex_error(16, 0.1, true, Collision::regularised),
            1.1 * vortex_error(16, 0.1, false, Collision::regularised));
  const double order = std::log2(vortex_error(16, 0.05, true) / vortex_error(32, 0.05, true));
  EXPECT_GT(order, 1.9);
}

/// Returns the error of a decaying wave of shear, u_y = cos kx, after nu k^2 t = 1/2. With `refined` half of
/// the cells are finest, in stairs whose steps are 8 of them: shear crosses edges all along the border. n
/// coarse cells an edge, their nu.
double stairs_error(int n, double nu, bool refined) {
  const int fine = 2, edge = fine * n, tile = 8, tiles = edge / tile;
  const LevelledCut cut({edge, edge, tile}, tile, [&](Int3 x) {
    return refined && (x.x / tile + x.y / tile) % tiles < tiles / 2 ? 0 : 1;
  });
  LevelledFlow<double> flow(cut.tree(), {}, {0.5 + 3 * nu * fine, 0.25}, 1);
  const double k = 2 * std::numbers::pi / edge, rate = fine * nu * k * k;
  double speed = 0.02 * 16 / n;
  const auto exact = [&](const Vector& x, double& rho, Vector& u, Gradient& gradient) {
    rho = 0, u = {0, speed * std::cos(k * x[0]), 0};
    gradient = {};
    gradient[1][0] = -speed * k * std::sin(k * x[0]);
  };
  flow.set(exact);
  const int steps = int(std::lround(0.5 / rate / fine)) * fine;
  flow.step(steps);
  speed *= std::exp(-rate * steps);
  return relative_error(flow, exact);
}

// 5 and 2.6 times, if packets that cross an edge have no part of the change by the last collision
TEST(LevelsAccuracy, ShearCrossesABorderInStairs) {
  EXPECT_LT(stairs_error(32, 0.02, true), 4 * stairs_error(32, 0.02, false));
  EXPECT_LT(stairs_error(32, 0.1, true), 2 * stairs_error(32, 0.1, false));
}

/// Returns the error, over the vortex, of one about an axis along (0, 1, 1) that a stream carries obliquely
/// through the middle of the box, from three eighths of an edge before it to as much behind it. It is
/// Taylor's, u = U r/R exp(1/2 - r^2/2R^2), exact with viscosity: R^2 grows by 2 nu t, U R^3 does not change.
/// n coarse cells along an edge, their nu.
double carried_error(int n, double nu, bool refined, Collision model) {
  const int fine = refined ? 2 : 1, edge = fine * n;
  auto flow = middle_refined(n, refined, nu, 1.0 / 6, model);
  const Vector stream = {0.05, 0.04, -0.02};
  const double swirl = 0.02, first = edge / 10.0, half = std::numbers::sqrt2 / 2;
  const int steps = int(std::lround(0.75 * edge / stream[0])) / 2 * 2;
  int done = 0;
  const auto exact = [&](const Vector& x, double& rho, Vector& u, Gradient& gradient) {
    const double since = done - steps / 2;  // it was in the middle
    double a = x[0] - edge / 2 - stream[0] * since,
           b = half * (x[1] - x[2]) - half * (stream[1] - stream[2]) * since;
    a -= edge * std::round(a / edge), b -= half * edge * std::round(b / (half * edge));
    const double square = first * first + 2 * nu * fine * done, radius = std::sqrt(square);
    const double turn =
        swirl * std::pow(first / radius, 3) / radius * std::exp(0.5 - (a * a + b * b) / (2 * square));
    u = {stream[0] - turn * b, stream[1] + half * turn * a, stream[2] - half * turn * a};
    const double along[2] = {turn * a * b / square, turn * (1 - a * a / square)},  // changes along a, and b
        across[2] = {-turn * (1 - b * b / square), -turn * a * b / square};
    gradient = {Vector{along[0], half * across[0], -half * across[0]},
                Vector{half * along[1], across[1] / 2, -across[1] / 2},
                Vector{-half * along[1], -across[1] / 2, across[1] / 2}};
    rho = -1.5 * turn * turn * square;
  };
  flow.set(exact);
  flow.step(steps);
  done = steps;
  return relative_error(flow, exact, stream);
}

TEST(LevelsAccuracy, VortexIsCarriedThroughBordersBetterThanOnTheCoarseLattice) {
  for (const double nu : {0.01, 0.005}) {
    const double coarse = carried_error(24, nu, false, Collision::regularised);
    EXPECT_LT(coarse, 0.1);
    EXPECT_LT(carried_error(24, nu, true, Collision::regularised), coarse);
  }
}

/// Returns what of a plane pulse of sound a border that it meets at a right angle sends back, over the
/// pulse's height. The pulse is a Gaussian of this deviation in coarse cells, nu theirs.
double sent_back(double deviation, double nu, bool from_coarse) {
  constexpr int start = 160, middle = 384, end = 640, length = 768, width = 8;  // finest cells
  const LevelledCut cut({length, width, width}, width,
                        [&](Int3 x) { return (x.x < middle) == from_coarse ? 1 : 0; });
  LevelledFlow<double> flow(cut.tree(), {}, {0.5 + 6 * nu}, 1);
  const double sound = 1 / std::numbers::sqrt3, height = 1e-4;
  flow.set([&](const Vector& x, double& rho, Vector& u, Gradient& gradient) {
    const double s = (x[0] - start) / (2 * deviation);
    rho = height * std::exp(-s * s / 2), u[0] = sound * rho;
    gradient[0][0] = -s / (2 * deviation) * u[0];
  });
  flow.step(int((end - start) / sound) / 2 * 2);
  // what runs back, near where a pulse is now that turned at the border, not what the start sent back
  double back = 0;
  flow.for_all([&](Fluid<double>& fluid, int b, Int3 x, const Vector& at, int) {
    const Moments m = fluid.moments(b, x);
    if (std::abs(at[0] - (2 * middle - end)) < middle - start)
      back = std::max(back, std::abs(m.density_deviation - fluid.velocity(m)[0] / sound) / 2);
  });
  return back / height;
}

TEST(LevelsAccuracy, SoundPassesABorder) {
  for (const double nu : {0.1, 0.002})
    for (const bool from_coarse : {false, true}) EXPECT_LT(sent_back(4, nu, from_coarse), 0.002);
}

}  // namespace
}  // namespace silt::lbm
