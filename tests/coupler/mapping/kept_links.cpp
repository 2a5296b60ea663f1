// Links of a tube that are kept while bodies move inside it are those that are built anew.
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/build_links.hpp"
#include "coupler/mapping/map_bodies.hpp"
#include "coupler/simulation.hpp"
#include "tests/coupler/coupled_scenes.hpp"

namespace silt::coupler::testing {
namespace {

using rigid::Vec3;

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

/// The ball goes out to the wall along every direction, by steps of a third of a cell, and along the tube.
void check_tube(const char* blocks, WallScheme scheme) {
  Simulation s = ball_in_a_tube().start(MPI_COMM_SELF, {blocks});
  const lbm::Domain& domain = s.scene().flow->domain();
  std::vector<lbm::CellBox> boxes;
  for (const auto& place : domain.blocks_of(0)) boxes.push_back(place.box);
  const auto mapping = [&] {
    return Mapping{MapBodies(domain, s.scene().world, boxes, lbm::link_reach(scheme)), {}};
  };
  Mapping lasting = mapping();
  int kept = 0, renewed = 0;
  double along = 0;
  for (int n = 0; n < 8; ++n)
    for (double out = 0; out < 9.4; out += 0.34) {
      along += 0.41;
      const double angle = 0.6 + n * 0.25 * 3.14159265;
      const Vec3 to(std::fmod(2.5 + along, 70), 11 + out * std::cos(angle), 11 + out * std::sin(angle));
      set_mapping_pose(s.bodies(), 0, {to, mapping_pose(s.bodies(), 0).orientation});
      lasting.renew(s, scheme);
      Mapping fresh = mapping();
      fresh.renew(s, scheme);
      for (std::size_t b = 0; b < boxes.size(); ++b) {
        const BlockMap& block = lasting.map.blocks()[b];
        ASSERT_EQ(block.masks.size(), fresh.map.blocks()[b].masks.size());
        for (std::size_t k = 0; k < block.masks.size(); ++k) {
          expect_same(lasting.surfaces[b][k].links, fresh.surfaces[b][k].links);
          if (block.changed && block.masks[k].hollow) ++(block.masks[k].kept ? kept : renewed);
        }
      }
      if (::testing::Test::HasFailure()) return;
    }
  EXPECT_GT(kept, 100);
  EXPECT_GT(renewed, 50);
}

TEST(KeptLinks, OfATubeAreThoseBuiltAnew) {
  check_tube("domain.blocks=[70,22,22]", WallScheme::multireflection);
  check_tube("domain.blocks=[70,22,22]", WallScheme::cli);
  check_tube("domain.blocks=[14,11,22]", WallScheme::multireflection);
}

}  // namespace
}  // namespace silt::coupler::testing
