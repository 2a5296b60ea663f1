// The links of many bodies at once: cells that several claim, gaps, bodies that move and bodies that rest.
#include "coupler/simulation.hpp"
#include "tests/coupler/coupled_scenes.hpp"
#include "tests/coupler/mapping/links_by_definition.hpp"

namespace silt::coupler::testing {
namespace {

using lbm::Int3;
using rigid::Vec3;

/// Shows the body to the fluid somewhere else.
void move(rigid::BodySet& bodies, std::size_t row, const Vec3& to) {
  set_mapping_pose(bodies, row, {to, mapping_pose(bodies, row).orientation});
}

/// The crowd after some steps, in blocks of several sizes, and then again with some of the bodies moved.
template <class T>
void check_crowd(const char* blocks, WallScheme scheme, double rounding, Device device = Device::cpu) {
  Simulation s = crowd().start(MPI_COMM_SELF, {blocks});
  for (rigid::BodyId id = 1; id <= s.scene().at_start.body_count; ++id)
    s.set_velocity(id, 0.05 * Vec3(std::cos(1.7 * id), std::sin(1.7 * id), std::sin(3.4 * id)),
                   0.01 * Vec3(std::sin(1.7 * id), 0.3, -0.5));
  for (int t = 0; t < 80; ++t) s.step();
  const lbm::Domain& domain = s.scene().flow->fields().domain();
  std::vector<lbm::CellBox> boxes;
  for (const auto& place : domain.blocks_of(0)) boxes.push_back(place.box);
  MapBodies map(domain, s.scene().world, boxes, lbm::link_reach(scheme));
  std::vector<std::vector<SurfaceLinks<T>>> surfaces(boxes.size());
  std::vector<DeviceMapping<T>> on_device;
  for (std::size_t b = 0; device != Device::cpu && b < boxes.size(); ++b) on_device.emplace_back(device);
  LinkKinds kinds;
  int kept = 0, spoilt = 0;  // spoilt: bodies at rest whose links others changed
  for (unsigned round = 0; round < 3; ++round) {
    map(s.bodies());
    for (std::size_t b = 0; b < boxes.size(); ++b)
      expect_all_links<T>(s, map.blocks()[b], scheme, rounding, surfaces[b], kinds,
                          on_device.empty() ? nullptr : &on_device[b]);
    for (const BlockMap& block : map.blocks())
      for (const BodyMask& mask : block.masks)
        (mask.kept ? kept : spoilt) += block.changed && round > 0 && mask.id % 4 != round;
    for (std::size_t row = 0; row < s.bodies().first_wall(); ++row)
      if (s.bodies().id[row] % 4 == round + 1)
        move(s.bodies(), row, mapping_pose(s.bodies(), row).position + Vec3(0.3, -0.4, 0.2));
  }
  EXPECT_EQ(kinds.single_cell > 0, scheme != WallScheme::bounce_back);
  EXPECT_EQ(kinds.two_cells > 0, scheme == WallScheme::multireflection);
  EXPECT_EQ(kinds.across > 0, scheme == WallScheme::multireflection);
  EXPECT_EQ(kinds.crossing > 0, scheme != WallScheme::bounce_back);
  EXPECT_GT(kept, 0);
  EXPECT_GT(spoilt, 0);
}

TEST(Links, AreThoseOfTheDefinition) {
  check_crowd<double>("domain.blocks=[24,20,28]", WallScheme::cli, 1e-9);
  check_crowd<float>("domain.blocks=[12,10,14]", WallScheme::cli, 2e-4);
  check_crowd<float>("domain.blocks=[12,5,28]", WallScheme::bounce_back, 0);
  check_crowd<double>("domain.blocks=[7,9,5]", WallScheme::parabolic, 1e-9);
}

TEST(Links, ThatADeviceListsAreThoseOfTheDefinition) {
  for (const Device device : {Device::host, Device::gpu}) {
    if (!unusable(device).empty()) continue;
    check_crowd<float>("domain.blocks=[24,20,28]", WallScheme::cli, 2e-4, device);
    check_crowd<float>("domain.blocks=[12,5,28]", WallScheme::bounce_back, 0, device);
    check_crowd<double>("domain.blocks=[12,10,14]", WallScheme::multireflection, 1e-9, device);
  }
}

TEST(Links, ThatReadBeyondAreThoseOfTheDefinition) {
  check_crowd<double>("domain.blocks=[24,20,28]", WallScheme::multireflection, 1e-9);
  check_crowd<double>("domain.blocks=[7,9,5]", WallScheme::multireflection, 1e-9);
  check_crowd<float>("domain.blocks=[12,10,14]", WallScheme::multireflection, 2e-4);
  check_crowd<float>("domain.blocks=[2,20,4]", WallScheme::multireflection, 2e-4);
}

/// A ball that comes to rest at mapping poses of our choice, and a smaller one of a lower id.
CaseText visited_ball() {
  CaseText c;
  c.domain = domain_of({18, 18, 18});
  c.shapes = sphere_of("visitor", 3.3) + sphere_of("ball", 5.4);
  c.bodies = body_of("visitor", 1, "position = [2.5, 2.5, 2.5]") +
             body_of("ball", 1, "position = [9.0312, 8.9371, 9.0523]");
  return c;
}

/// From within, where the visitor takes of the ball's cells without a change of what is solid, to where it is
/// out of reach of its links.
void check_visits(WallScheme scheme) {
  Simulation s = visited_ball().start(MPI_COMM_SELF);
  MapBodies map(s.scene().flow->fields().domain(), s.scene().world,
                std::vector<lbm::CellBox>{{{}, {18, 18, 18}}}, lbm::link_reach(scheme));
  std::vector<SurfaceLinks<double>> surfaces;
  LinkKinds kinds;
  int kept = 0, renewed = 0;
  const Vec3 centre = mapping_pose(s.bodies(), 1).position;
  for (int i = 1; i < lbm::directions; ++i)
    for (double distance = 1.05; distance < 9; distance += 0.55) {
      const Vec3 along = Vec3(lbm::c[i].x, lbm::c[i].y, lbm::c[i].z).normalized();
      move(s.bodies(), 0, centre + distance * along);
      map(s.bodies());
      expect_all_links<double>(s, map.blocks()[0], scheme, 1e-9, surfaces, kinds);
      ++(map.blocks()[0].masks.back().kept ? kept : renewed);
    }
  EXPECT_GT(kept, 10);
  EXPECT_GT(renewed, 10);
}

TEST(Links, OfABodyAtRestFollowWhatVisitsItsCells) {
  check_visits(WallScheme::cli);
  check_visits(WallScheme::multireflection);
}

}  // namespace
}  // namespace silt::coupler::testing
