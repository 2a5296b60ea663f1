// Links that are kept while bodies move near their surface are those that are built anew.
#include <memory>

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
      body_of("other", 1, "position = [13.8, 13.1, 12.7]\naxis_angle = { axis = [1, 2, 3], degrees = 40 }");
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

}  // namespace
}  // namespace silt::coupler::testing
