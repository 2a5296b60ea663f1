// Wall distances follow a surface that moves on from where it was mapped.
#include <cmath>
#include <optional>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/build_links.hpp"
#include "coupler/mapping/map_bodies.hpp"
#include "coupler/simulation.hpp"
#include "tests/coupler/coupled_scenes.hpp"
#include "tests/shape_rows.hpp"

namespace silt::coupler::testing {
namespace {

using lbm::Int3;
using rigid::Vec3;

constexpr std::int64_t mapped_steps = 9;  // for which bodies are mapped
constexpr double way = 0.1;  // how far in cells, the fastest point is from the middle in the last one

/// From x along a link, in units of it; the surface may have moved past either end. None for a line that
/// grazes it, which it may meet at one time only.
std::optional<double> distance(const rigid::Shape& shape, const rigid::Pose& pose, const Vec3& x,
                               const Vec3& c) {
  constexpr double past = 0.25;
  const Vec3 along = pose.orientation.conjugate() * c, from = pose.to_body(x) - past * along;
  const double found = rigid::ray_distance(shape, from, along, 1 + 2 * past);
  if (rigid::contains(shape, from) || found >= 1 + 2 * past) return {};
  return found - past;
}

struct Errors {
  double held = 0, following = 0;  // root of the mean square
  int links = 0, close = 0;        // close: following within a tenth of the way
};

/// Of the links of one body that turns and moves, in every one of its mapped_steps.
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
  set_mapped_motion(s.bodies(), 0, mapped);
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
                 c = lbm::c[lbm::place_direction(links.place[l])];
      const Vec3 x(cell.x + 0.5, cell.y + 0.5, cell.z + 0.5), along(c.x, c.y, c.z);
      const std::optional<double> middle = distance(shape, mapped.pose, x, along);
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
  expect_following<float>("compound",
                          "parts = [ { type = \"capsule\", radius = 1.6, length = 6, axis = [1, 0, 0] },\n"
                          "{ type = \"capsule\", radius = 1.6, length = 6, axis = [0, 1, 0] } ]");
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
    set_mapped_motion(s.bodies(), 0, mapped);
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
