#pragma once
// The fluid of several levels that no step moves, over a tree of cuts made by hand: for tests of what looks
// at its cells.
#include <memory>
#include <vector>

#include "coupler/flow.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "lbm/fluid.hpp"
#include "parallel/collectives.hpp"
#include "silt/case/case.hpp"
#include "silt/simulation.hpp"
#include "tests/coupler/single_cells.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::coupler::testing {

class LevelledFlow final : public Flow {
 public:
  LevelledFlow(const Case& scene, const lbm::CutTree& tree, int levels, MPI_Comm comm) {
    for (int level = 0; level < levels; ++level)
      levels_.push_back(std::make_unique<Level>(scene, tree, level, comm));
    account_ = std::make_unique<FlowAccount>(fields(), comm);
    for (int level = 1; level < levels; ++level) account_->add_level(fields(level));
  }

  int levels() const override { return int(levels_.size()); }
  using Flow::fields;
  FluidFields& fields(int level = 0) override { return *levels_[level]->fields; }
  double seconds(int) const override { return 0; }
  std::optional<FluidFields::Fast> too_fast(int level) override { return fields(level).too_fast(); }
  FlowAccount& account() override { return *account_; }

  void drive(std::int64_t) override {}
  FlowControl* control() override { return nullptr; }
  void map_bodies(rigid::BodySet&, const BodyChanges&) override {}
  void stream_collide(StepClock&) override {}
  void communicate() override {}
  void evaluate_forces(rigid::BodySet&) override {}
  void hold_bodies(bool) override {}
  void resume(std::int64_t, rigid::FixedSum) override {}
  void take_over(const Flow&) override {}
  void start(rigid::BodySet&) override {}

 private:
  struct Level {
    lbm::Fluid<double> fluid;
    std::vector<BlockMap> maps;
    std::unique_ptr<FluidFields> fields;

    Level(const Case& scene, const lbm::CutTree& tree, int level, MPI_Comm comm)
        : fluid(domain_of(scene, tree, level, comm), spec_of(*scene.fluid, level), comm) {
      for (const auto& block : fluid.blocks()) {
        BlockMap& map = maps.emplace_back();
        map.box = block.box();
        map.walls = map.solid = CellBits(map.box.size);
      }
      fields = make_fields<double>(fluid, maps);
    }
    static lbm::Domain domain_of(const Case& scene, const lbm::CutTree& tree, int level, MPI_Comm comm) {
      return {tree, make_domain(scene, 1).sides(), parallel::ranks_of(comm), level};
    }
    static lbm::CollisionSpec spec_of(const FluidSpec& fluid, int level) {
      const double width = 1 << level;
      lbm::CollisionSpec spec{0.5 + (fluid.relaxation_time - 0.5) / width};
      for (int d = 0; d < 3; ++d) spec.force[d] = width * fluid.body_force[d];
      return spec;
    }
  };
  std::vector<std::unique_ptr<Level>> levels_;
  std::unique_ptr<FlowAccount> account_;
};

/// A box of 24 x 16 x 8 cells: of level 2 up to x = 8, of level 1 up to 16, of level 0 beyond; in eight
/// columns along x, which up to eight ranks share.
inline lbm::CutTree three_levels(int ranks) {
  const auto rank_of_column = [](int column, int ranks) {  // of 8, halved as the ranks are: a rank has a box
    int rank = 0;
    for (int half = 4; ranks > 1; half /= 2) {
      const int lower = ranks / 2;
      if (column & half)
        rank += lower, ranks -= lower;
      else
        ranks = lower;
    }
    return rank;
  };
  std::vector<lbm::Cut> nodes;
  std::vector<lbm::LeafKind> kinds;
  const auto column = [&] {
    nodes.push_back({0, 8, 1}), nodes.push_back({0, 16, 1});
    for (const int level : {2, 1, 0}) kinds.push_back({rank_of_column(int(kinds.size() / 3), ranks), level});
  };
  const auto layer = [&] {
    nodes.push_back({1, 8, 6}), nodes.push_back({1, 4, 3});
    column(), column();
    nodes.push_back({1, 12, 3});
    column(), column();
  };
  nodes.push_back({2, 4, 12});
  layer(), layer();
  return {{24, 16, 8}, std::move(nodes), std::move(kinds)};
}

/// The scene of that box: fluid alone, in double precision.
inline CaseText levelled_case(const std::string& fluid = "relaxation_time = 0.8\n") {
  CaseText c;
  c.domain = domain_of({24, 16, 8});
  c.fluid = "[fluid]\nprecision = \"double\"\n" + fluid;
  c.shapes = c.bodies = "";
  return c;
}

/// Gives each cell of this rank the equilibrium of what of(fields of its level, global cell) returns: density
/// deviation and velocity.
struct LocalFlow {
  double density_deviation;
  rigid::Vec3 velocity;
};
template <class Of>
void set_cells(Flow& flow, Of&& of) {
  for (int level = 0; level < flow.levels(); ++level) {
    FluidFields& fields = flow.fields(level);
    for_each_cell(fields, [&](int b, lbm::Int3 x, lbm::Int3 cell) {
      const auto [density, u] = of(fields, cell);
      for (int i = 0; i < lbm::D3Q19::directions; ++i)
        set_arriving(fields, b, x, i, lbm::equilibrium(i, density, u.data()));
    });
  }
}

/// Puts it in the place of a simulation's fluid.
inline LevelledFlow& put_levels(Simulation& s) {
  Scene& scene = s.scene();
  auto flow = std::make_unique<LevelledFlow>(scene.setup, three_levels(scene.ranks()), 3, scene.comm);
  LevelledFlow& put = *flow;
  scene.flow = std::move(flow);
  return put;
}

}  // namespace silt::coupler::testing
