// A map keeps some things from step to step: changed cells, columns of sides, links that are built once, and
// distances that follow bodies.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <set>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/build_links.hpp"
#include "coupler/mapping/cell_bits.hpp"
#include "coupler/mapping/map_bodies.hpp"
#include "coupler/mapping/refill.hpp"
#include "silt/simulation.hpp"
#include "tests/ray_distance.hpp"
#include "tests/shape_rows.hpp"
#include "tests/silt/coupled_scenes.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;
using CellOfBlock = std::array<int, 4>;
using lbm::Int3;

/// Wide enough for a ball to be out of reach of the tube's links; the row of cells is longer than a word.
CaseText ball_in_a_tube() {
  CaseText c;
  c.domain = domain_of({70, 22, 22},
                       R"({ x = "periodic", y = ["no-slip", "no-slip"], z = ["no-slip", "no-slip"] })");
  c.rest = "[[walls]]\ntype = \"tube\"\nradius = 10.2\naxis = \"x\"\npoint = [0, 11, 11]\n";
  c.shapes = sphere_of("ball", 3.3);
  c.bodies = body_of("ball", 1, "position = [2.5, 11, 11]");
  return c;
}

struct Mapping {
  MapBodies map;
  std::vector<std::vector<SurfaceLinks<float>>> surfaces;

  void renew(const Simulation& s, WallScheme scheme) {
    map(s.bodies());
    surfaces.resize(map.blocks().size());
    CouplingSpec coupling;
    coupling.wall_scheme = scheme;
    for (std::size_t b = 0; b < surfaces.size(); ++b)
      if (const BlockMap& block = map.blocks()[b]; block.changed)
        build_links<float>(block, s.scene().world, s.bodies(),
                           {coupling, {}, lbm::PassOrder(block.box.size, sizeof(float))}, surfaces[b]);
  }
};

void expect_same(const lbm::CutLinks<float>& a, const lbm::CutLinks<float>& b) {
  EXPECT_EQ(a.place, b.place);
  EXPECT_EQ(a.q, b.q);
  EXPECT_EQ(a.across, b.across);
  ASSERT_EQ(a.groups.size(), b.groups.size());
  for (std::size_t g = 0; g < a.groups.size(); ++g) {
    EXPECT_EQ(a.groups[g].scheme, b.groups[g].scheme);
    EXPECT_EQ(a.groups[g].begin, b.groups[g].begin);
    EXPECT_EQ(a.groups[g].count, b.groups[g].count);
  }
}

/// A mapping that lasts, beside one that is made anew in every step: their links are the same.
class LastingAndFresh {
 public:
  LastingAndFresh(Simulation& s, WallScheme scheme) : s_(s), scheme_(scheme) {
    for (const auto& place : s.scene().flow->fields().domain().blocks_of(0)) boxes_.push_back(place.box);
    lasting_ = std::make_unique<Mapping>(mapping());
  }

  /// The first body is seen somewhere else. Counts the masks of the others that `counts` says so of.
  template <class Counts>
  void move_to(const Vec3& x, Counts&& counts) {
    set_mapping_pose(s_.bodies(), 0, {x, mapping_pose(s_.bodies(), 0).orientation});
    lasting_->renew(s_, scheme_);
    Mapping fresh = mapping();
    fresh.renew(s_, scheme_);
    for (std::size_t b = 0; b < boxes_.size(); ++b) {
      const BlockMap& block = lasting_->map.blocks()[b];
      ASSERT_EQ(block.masks.size(), fresh.map.blocks()[b].masks.size());
      for (std::size_t k = 0; k < block.masks.size(); ++k) {
        expect_same(lasting_->surfaces[b][k].links, fresh.surfaces[b][k].links);
        if (block.changed && counts(block.masks[k])) ++(block.masks[k].kept ? kept : renewed);
      }
    }
  }
  int kept = 0, renewed = 0;

 private:
  Mapping mapping() const {
    return {MapBodies(s_.scene().flow->fields().domain(), s_.scene().world, boxes_, lbm::link_reach(scheme_)),
            {}};
  }

  Simulation& s_;
  WallScheme scheme_;
  std::vector<lbm::CellBox> boxes_;
  std::unique_ptr<Mapping> lasting_;
};

/// The ball goes out to the wall along every direction, by steps of a third of a cell, and along the tube.
void check_tube(const char* blocks, WallScheme scheme) {
  Simulation s = ball_in_a_tube().start(MPI_COMM_SELF, {blocks});
  LastingAndFresh both(s, scheme);
  double along = 0;
  for (int n = 0; n < 8; ++n)
    for (double out = 0; out < 9.4; out += 0.34) {
      along += 0.41;
      const double angle = 0.6 + n * 0.25 * 3.14159265;
      const Vec3 to(std::fmod(2.5 + along, 70), 11 + out * std::cos(angle), 11 + out * std::sin(angle));
      both.move_to(to, [](const BodyMask& mask) { return mask.hollow; });
      if (::testing::Test::HasFailure()) return;
    }
  EXPECT_GT(both.kept, 100);
  EXPECT_GT(both.renewed, 50);
}

/// The ball comes from afar to a body in the middle, along directions all around, by steps of a fifth of a
/// cell, until they overlap.
void check_body(const std::string& shape, const char* blocks, WallScheme scheme) {
  CaseText c;
  c.domain = domain_of({28, 27, 26}, R"({ x = "periodic", y = "periodic", z = "periodic" })");
  c.rest = "";
  c.shapes = sphere_of("ball", 3.3) + shape;
  c.bodies =
      body_of("ball", 1, "position = [2.5, 11, 11]") +
      body_of("other", 1, "position = [13.8, 13.1, 12.7]\norientation = { axis = [1, 2, 3], degrees = 40 }");
  Simulation s = c.start(MPI_COMM_SELF, {blocks});
  LastingAndFresh both(s, scheme);
  for (int n = 0; n < 26; ++n) {
    const double z = (n - 12.5) / 13, r = std::sqrt(1 - z * z), angle = 2.4 * n;
    const Vec3 direction(r * std::cos(angle), r * std::sin(angle), z);
    for (double distance = 10; distance > 3; distance -= 0.2) {
      both.move_to(Vec3(13.8, 13.1, 12.7) + distance * direction,
                   [](const BodyMask& m) { return m.row == 1; });
      if (::testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(both.kept, 100);
  EXPECT_GT(both.renewed, 100);
}

TEST(KeptLinks, OfATubeAreThoseBuiltAnew) {
  check_tube("domain.blocks=[70,22,22]", WallScheme::multireflection);
  check_tube("domain.blocks=[70,22,22]", WallScheme::cli);
  check_tube("domain.blocks=[14,11,22]", WallScheme::multireflection);
}

TEST(KeptLinks, OfABodyThatAnotherComesToAreThoseBuiltAnew) {
  const std::string ball = sphere_of("other", 7), box = shape_of("other", "box", "edges = [7, 4, 2.5]");
  for (const char* blocks : {"domain.blocks=[28,27,26]", "domain.blocks=[14,27,13]"})
    for (const WallScheme scheme : {WallScheme::multireflection, WallScheme::cli}) {
      check_body(ball, blocks, scheme);
      check_body(box, blocks, scheme);
    }
}

std::set<CellOfBlock> cells_in(const std::vector<CoveredCell>& listed) {
  std::set<CellOfBlock> cells;
  for (const CoveredCell& c : listed)
    EXPECT_TRUE(cells.insert({c.block, c.cell.x, c.cell.y, c.cell.z}).second) << "listed twice";
  return cells;
}

/// Two balls that pass one another and share cells on the way, through the sides of a periodic domain.
TEST(ChangedCells, AreThoseOfTheMaps) {
  CaseText c;
  c.domain = domain_of({70, 20, 18}, R"({ x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] })");
  c.shapes = sphere_of("ball", 6.6);
  c.bodies = body_of("ball", 1, "positions = [[20, 6, 8], [30, 6, 8]]");
  Simulation s = c.start(MPI_COMM_SELF, {"domain.blocks=[35, 20, 18]"});
  const lbm::Domain& domain = s.scene().flow->fields().domain();
  std::vector<lbm::CellBox> boxes;
  for (const auto& place : domain.blocks_of(0)) boxes.push_back(place.box);
  MapBodies map(domain, s.scene().world, boxes, 2);
  map(s.bodies());
  std::size_t covered = 0, uncovered = 0;
  for (int step = 1; step < 120; ++step) {
    for (std::size_t row = 0; row < 2; ++row) {
      const double way = (row ? -0.27 : 0.31) * step;
      const auto within = [](double x, double n) { return x - n * std::floor(x / n); };
      const rigid::Vec3 x(within((row ? 30 : 20) + 2 * way, 70), within(6 + 1.7 * way, 20), 8 + row);
      set_mapping_pose(s.bodies(), row, {x, mapping_pose(s.bodies(), row).orientation});
    }
    map(s.bodies());
    const ChangedCells changed = changed_cells(map.blocks());
    std::set<CellOfBlock> now_solid, now_fluid;
    for (int b = 0; b < int(boxes.size()); ++b) {
      const BlockMap& block = map.blocks()[b];
      for_cells({}, block.box.size, [&](lbm::Int3 x) {
        if (block.solid.test(x) && !block.before.test(x)) now_solid.insert({b, x.x, x.y, x.z});
        if (!block.solid.test(x) && block.before.test(x)) now_fluid.insert({b, x.x, x.y, x.z});
      });
    }
    EXPECT_EQ(cells_in(changed.covered), now_solid) << step;
    EXPECT_EQ(cells_in(changed.uncovered), now_fluid) << step;
    covered += now_solid.size(), uncovered += now_fluid.size();
  }
  EXPECT_GT(covered, 1000u);
  EXPECT_GT(uncovered, 1000u);
}

TEST(SideColumns, HaveTheCellsOfTheRows) {
  std::mt19937 random(1);
  for (const Int3 size :
       {Int3{1, 1, 1}, Int3{3, 70, 2}, Int3{4, 60, 5}, Int3{63, 64, 3}, Int3{130, 129, 4}}) {
    SCOPED_TRACE(::testing::Message() << size.x << " x " << size.y << " x " << size.z);
    constexpr int ghosts = CellBits::ghosts;
    const Int3 margin{ghosts, ghosts, ghosts};
    CellBits first(size), solid(size);
    for_cells(Int3{} - margin, size + margin, [&](Int3 x) {
      if (random() % 3 == 0) first.set(x);
      if (random() % 3 == 0) solid.set(x);
    });
    SideColumns columns(first);
    columns.reset(solid);  // nothing of before stays
    for_cells(Int3{} - margin, size + margin, [&](Int3 x) {
      const std::uint64_t column = columns.from(solid, x.x, x.y, x.z);
      for (int n = 0; n < 64 && x.y + n < size.y + ghosts; ++n)
        ASSERT_EQ(column >> n & 1, std::uint64_t(solid.test(x + Int3{0, n, 0})))
            << x.x << ' ' << x.y << ' ' << n;
    });
  }
}

constexpr std::int64_t mapped_steps = 9;  // for which bodies are mapped
constexpr double way = 0.1;  // how far in cells, the fastest point is from the middle in the last one

/// Returns the distance from x along a link, in units of it; the surface may have moved past either end. None
/// for a line that grazes it, which it may meet at one time only.
std::optional<double> distance(const rigid::Shape& shape, const rigid::Pose& pose, const Vec3& x,
                               const Vec3& c) {
  constexpr double past = 0.25;
  const Vec3 along = pose.orientation.conjugate() * c, from = pose.to_body(x) - past * along;
  const double found = tests::ray_distance(shape, from, along, 1 + 2 * past);
  if (rigid::contains(shape, from) || found >= 1 + 2 * past) return {};
  return found - past;
}

struct Errors {
  double held = 0, following = 0;  // root of the mean square
  int links = 0, close = 0;        // close: following within a tenth of the way
};

/// Compares the links of one body that turns and moves, in every one of its mapped_steps.
template <class T>
Errors errors(const std::string& type, const std::string& sizes, const Vec3& velocity, const Vec3& spin) {
  CaseText scene;
  scene.domain = domain_of({32, 32, 32});
  scene.shapes = shape_of("body", type, sizes);
  scene.bodies = body_of("body", 1, "position = [16.17, 15.83, 16.41]\norientation = [0.7, 0.3, -0.5, 0.2]");
  Simulation s = scene.start(MPI_COMM_SELF);
  const rigid::Shape& shape = s.scene().world.shapes[s.bodies().shape[0]];
  const double fastest = velocity.norm() + s.scene().world.bounding_radii[s.bodies().shape[0]] * spin.norm();
  const double scale = way / (fastest * (mapped_steps - 1) / 2);
  MappedMotion mapped{s.bodies().pose(0), scale * velocity, scale * spin, 100, 100 + mapped_steps};
  coupling_of(s.bodies(), 0).mapped = mapped;
  const lbm::CellBox box{{0, 0, 0}, {32, 32, 32}};
  MapBodies map(s.scene().flow->fields().domain(), s.scene().world, std::span(&box, 1), 2);
  map(s.bodies());
  std::vector<SurfaceLinks<T>> surfaces;
  build_links<T>(map.blocks()[0], s.scene().world, s.bodies(),
                 {CouplingSpec{}, {}, lbm::PassOrder(box.size, sizeof(T))}, surfaces);
  const lbm::CutLinks<T>& links = surfaces.at(0).links;
  EXPECT_EQ(links.rate.size(), links.q.size());
  Errors all;
  for (const lbm::LinkGroup& g : links.groups)
    for (std::uint32_t l = g.begin; l < g.begin + g.count && !g.crossing; ++l) {
      const Int3 cell = g.corner + lbm::place_cell(links.place[l]),
                 c = lbm::D3Q19::c[lbm::place_direction(links.place[l])];
      const Vec3 x(cell.x + 0.5, cell.y + 0.5, cell.z + 0.5), along(c.x, c.y, c.z);
      const std::optional<double> middle = distance(shape, mapped.pose(), x, along);
      if (!middle || std::abs(*middle - links.q[l]) > 1e-4) continue;  // beside an edge
      for (double age = -(mapped_steps - 1) / 2; age <= (mapped_steps - 1) / 2; ++age) {
        const std::optional<double> exact = distance(shape, mapped.pose_after(age), x, along);
        if (!exact) continue;
        all.held += std::pow(links.q[l] - *exact, 2), ++all.links;
        const double error = links.q[l] + age * links.rate[l] - *exact;
        all.following += error * error, all.close += std::abs(error) < 0.1 * way;
      }
    }
  all.held = std::sqrt(all.held / all.links), all.following = std::sqrt(all.following / all.links);
  return all;
}

template <class T>
void expect_following(const std::string& type, const std::string& sizes) {
  const auto expect = [&](const char* how, const Vec3& velocity, const Vec3& spin) {
    SCOPED_TRACE(type + " " + how);
    const Errors e = errors<T>(type, sizes, velocity, spin);
    EXPECT_GT(e.links, 1000);
    EXPECT_GT(e.held, 0.01);
    EXPECT_LT(e.following, 0.5 * e.held);  // lines that pass an edge, or graze, do not change evenly
    EXPECT_GT(e.close, 0.85 * e.links);
  };
  expect("moves", {1, 0.6, -0.3}, {0, 0, 0});
  if (type != rigid::Sphere::name) expect("turns", {0, 0, 0}, {0.5, 1, 0.3});
  expect("both", {0.6, -0.2, 0.4}, {0.1, -0.1, 0.05});
}

TEST(FollowingDistances, OfEveryShape) {
  for (const tests::ShapeRow& row : tests::shape_rows()) {
    expect_following<double>(std::string(row.name), row.sizes);
    expect_following<float>(std::string(row.name), row.sizes);
  }
  expect_following<float>(
      "compound",
      "parts = [ { type = \"capsule\", radius = 1.6, length = 6, orientation = [1, 0, 0] },\n"
      "{ type = \"capsule\", radius = 1.6, length = 6, orientation = [0, 1, 0] } ]");
}

/// The forces on a small sphere in nine steps at 0.01 cells; none if some cell changed sides.
std::vector<Vec3> forces_without_changes(double along, const std::string& tolerance) {
  CaseText scene;
  scene.domain = domain_of({12, 12, 12});
  scene.fluid = "[fluid]\nrelaxation_time = 0.8\nprecision = \"double\"\n";
  scene.shapes = sphere_of("ball", 4);
  scene.bodies = body_of("ball", 1,
                         "position = [" + std::to_string(6 + along) +
                             ", 5.83, 6.41]\nvelocity = [0.01, 0, 0]\nmotion = \"prescribed\"");
  Simulation s = scene.start(MPI_COMM_SELF, {"coupling.remap_tolerance=" + tolerance});
  std::vector<Vec3> forces;
  for (int step = 0; step < 9; ++step) {
    s.step();
    const MappingCounts changed = s.scene().flow->account().mapping();
    if (changed.covered + changed.uncovered > 0) return {};
    forces.push_back(s.last_loads()[0].force);
  }
  return forces;
}

// Mapped in the second step for the eight to come. Distances of 0.035 cells less change the force by 0.3 %.
TEST(FollowingDistances, TheFluidSeesTheBodyWhereItIs) {
  int compared = 0;
  for (double along = 0; along < 1; along += 0.02) {
    const auto mapped_anew = forces_without_changes(along, "0"),
               followed = forces_without_changes(along, "0.1");
    if (mapped_anew.empty() || followed.empty()) continue;
    ++compared;
    double squares = 0;
    for (std::size_t t = 2; t < 9; ++t)
      squares += (followed[t] - mapped_anew[t]).squaredNorm() / mapped_anew[t].squaredNorm() / 7;
    EXPECT_LT(std::sqrt(squares), 5e-4) << along;
  }
  EXPECT_GE(compared, 2);
}

TEST(FollowingDistances, NoneOfABodyAtRestOrMappedForOneStep) {
  Simulation s = CaseText{}.start(MPI_COMM_SELF);
  const lbm::Domain& domain = s.scene().flow->fields().domain();
  const lbm::CellBox box{{0, 0, 0}, domain.cells()};
  const auto built = [&](const MappedMotion& mapped) {
    coupling_of(s.bodies(), 0).mapped = mapped;
    MapBodies map(domain, s.scene().world, std::span(&box, 1), 2);
    map(s.bodies());
    std::vector<SurfaceLinks<float>> surfaces;
    build_links<float>(map.blocks()[0], s.scene().world, s.bodies(),
                       {CouplingSpec{}, {}, lbm::PassOrder(box.size, sizeof(float))}, surfaces);
    return surfaces.at(0).links;
  };
  const rigid::Pose here = s.bodies().pose(0);
  EXPECT_FALSE(built({here, {0.01, 0, 0}, {0, 0, 0}, 8, 16}).rate.empty());
  EXPECT_TRUE(built({here, {0, 0, 0}, {0, 0, 0}, 8, 16}).rate.empty());
  EXPECT_TRUE(built({here, {0.1, 0, 0}, {0, 0, 0}, 8, 9}).rate.empty());
}

}  // namespace
}  // namespace silt::coupler::testing
