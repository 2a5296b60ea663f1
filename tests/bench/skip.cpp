// What a scene does not contain costs nothing: each row of a table runs a scene through Simulation, and
// beside it a driver that calls only the passes the scene needs. Instructions (callgrind, 256-bit build) are
// exact; times, taken in turn, say what caches add.
//   scripts/bench skip [--quick] [--json FILE]
#include <cstdio>
#include <functional>
#include <memory>
#include <string>

#include "coupler/analytic_flow.hpp"
#include "coupler/case_file.hpp"
#include "coupler/simulation.hpp"
#include "rigid/detect_contacts.hpp"
#include "rigid/integrate.hpp"
#include "tests/bench/instruction_count.hpp"
#include "tests/bench/main.hpp"
#include "tests/bench/spread.hpp"

namespace silt::bench {
namespace {

using coupler::Simulation, coupler::read_case_text;

/// One row: a scene without something, and a driver without the passes for it. Each call does one step.
struct Row {
  std::string key, without;
  std::function<void()> scene, driver;
};

struct SceneText {
  std::string domain = "size = [48, 48, 48]\nboundary = \"periodic\"";
  std::string fluid = "relaxation_time = 0.8", bodies, rest;
};
coupler::Case case_of(const SceneText& t) {
  std::string text = "title = \"skip\"\n[units]\nsystem = \"lattice\"\n[domain]\n" + t.domain + "\n";
  if (!t.fluid.empty()) text += "[fluid]\n" + t.fluid + "\n";
  return read_case_text(text + t.rest + "\n" + t.bodies + "[run]\nsteps = 100000\n", "skip");
}

std::string spheres(int count, const std::string& box, const std::string& more = "") {
  return "[[shapes]]\nname = \"sphere\"\ntype = \"sphere\"\ndiameter = 6\n[[fill]]\nshape = "
         "\"sphere\"\ndensity = 1.5\ncount = " +
         std::to_string(count) + "\nseed = 1\ngap = 3\nbox = " + box + "\n" + more;
}
std::string fixed_sphere(const std::string& at) {
  return "[[bodies]]\nshape = \"sphere\"\ndensity = 1\nmotion = \"fixed\"\nposition = " + at + "\n";
}

/// A scene ready for its passes, without the program around them.
struct Passes {
  explicit Passes(const SceneText& text) : scene(case_of(text), MPI_COMM_SELF) {
    if (!scene.flow) return;
    coupler::set_initial_flow(scene.setup, *scene.flow);
    scene.flow->start(scene.bodies);
  }
  /// With what is on the lattice: looks whether it moved, and begins its sums.
  void flow() {
    if (scene.bodies.size()) scene.flow->map_bodies(scene.bodies);
    scene.flow->stream_collide(scene.setup.gravity);
    scene.flow->communicate();
  }
  void forces() { scene.flow->evaluate_forces(scene.bodies, scene.setup.gravity); }
  void clear_forces() {
    std::fill(scene.bodies.force.begin(), scene.bodies.force.end(), rigid::FixedVec3{});
    std::fill(scene.bodies.torque.begin(), scene.bodies.torque.end(), rigid::FixedVec3{});
  }
  void rigid_step() { scene.rigid_step->advance(scene.bodies, scene.setup.contacts.substeps); }
  coupler::Scene scene;
};

Row row(const std::string& key, const std::string& without, const SceneText& text,
        std::function<void()> driver) {
  auto scene = std::make_shared<Simulation>(case_of(text), MPI_COMM_SELF);
  return {key, without, [scene] { scene->step(); }, std::move(driver)};
}

Row no_bodies() {
  const std::array<lbm::SideCondition, 6> periodic{};
  auto fluid = std::make_shared<lbm::Fluid<float>>(lbm::Domain({48, 48, 48}, periodic, std::nullopt, 1),
                                                   lbm::CollisionSpec{0.8, 1. / 6, false, {}}, MPI_COMM_SELF);
  return row("bodies", "bodies: kernel and ghost layer alone", {}, [fluid] {
    fluid->stream_collide();
    fluid->exchange();
  });
}

Row no_fluid() {
  SceneText text;
  text.fluid = "", text.bodies = spheres(100, "[[0, 0, 0], [48, 48, 48]]");
  auto passes = std::make_shared<Passes>(text);
  return row("fluid", "fluid: the step of the bodies alone", text, [passes] { passes->rigid_step(); });
}

Row no_moving_bodies() {
  SceneText text;
  text.bodies = "[[shapes]]\nname = \"sphere\"\ntype = \"sphere\"\ndiameter = 6\n" +
                fixed_sphere("[12.3, 24.1, 24.7]") + fixed_sphere("[36.3, 24.1, 24.7]");
  auto passes = std::make_shared<Passes>(text);
  return row("moving_bodies", "moving bodies: links built once, no step of bodies", text, [passes] {
    passes->flow();
    passes->forces();
    passes->clear_forces();
  });
}

Row no_body_moved() {
  SceneText text;
  text.bodies = spheres(30, "[[0, 0, 0], [48, 48, 48]]");
  auto passes = std::make_shared<Passes>(text);
  return row("moved", "bodies that moved: nothing mapped", text, [passes] {
    passes->flow();
    passes->forces();
    passes->rigid_step();
  });
}

Row no_body_near_a_block() {
  SceneText both, near;
  both.domain = "size = [48, 48, 96]\nboundary = \"periodic\"\nblocks = [48, 48, 48]";
  both.bodies = near.bodies = spheres(15, "[[4, 4, 4], [44, 44, 44]]");
  auto one = std::make_shared<Passes>(near), other = std::make_shared<Passes>(SceneText{});
  return row("near_block", "bodies near one of two blocks: no links there", both, [one, other] {
    one->flow(), other->flow();
    one->forces();
    one->rigid_step();
  });
}

/// A fixed box from z = 48 to the lid.
SceneText boxed_in(int height) {
  const auto text = [](double x) { return std::to_string(x); };
  SceneText scene;
  scene.domain = "size = [48, 48, " + std::to_string(height) +
                 "]\nboundary = { x = \"periodic\", y = \"periodic\", z = [\"no-slip\", \"no-slip\"] }\n"
                 "blocks = [48, 48, 52]";
  scene.bodies = "[[shapes]]\nname = \"box\"\ntype = \"box\"\nedges = [47.9, 47.9, " + text(height - 48.04) +
                 "]\n[[bodies]]\nshape = \"box\"\ndensity = 1\nmotion = \"fixed\"\nposition = [24, 24, " +
                 text((height + 48) / 2.0) + "]\n";
  return scene;
}

Row no_fluid_in_a_block() {
  auto passes = std::make_shared<Passes>(boxed_in(52));
  return row("solid_block", "fluid in one of two blocks: the other one's passes", boxed_in(104), [passes] {
    passes->flow();
    passes->forces();
    passes->clear_forces();
  });
}

Row no_contacts() {
  SceneText text;
  text.fluid = "", text.domain = "size = [480, 480, 480]\nboundary = \"periodic\"";
  text.bodies = spheres(100, "[[0, 0, 0], [480, 480, 480]]");
  auto passes = std::make_shared<Passes>(text);
  auto detect = std::make_shared<rigid::DetectContacts>();
  return row("contacts", "contacts: motion round the domain and the search for pairs", text,
             [passes, detect] {
               coupler::Scene& s = passes->scene;
               std::vector<rigid::Contact> none;
               rigid::drift(s.bodies, 0.5);
               s.exchange->synchronise(s.bodies);
               (*detect)(s.world, s.bodies, *s.exchange, *s.backend, 1.0, none);
               rigid::drift(s.bodies, 0.5);
               s.exchange->synchronise(s.bodies);
             });
}

Row no_other_shapes() {
  SceneText text, analytic;
  text.fluid = analytic.fluid = "";
  text.bodies = analytic.bodies = spheres(100, "[[0, 0, 0], [48, 48, 48]]");
  analytic.rest = "[contacts]\nbackend = \"analytic\"\nbroad_phase = \"grid\"";
  auto passes = std::make_shared<Passes>(analytic);
  return row("non_spheres", "other shapes: closed forms called directly", text,
             [passes] { passes->rigid_step(); });
}

std::vector<Row> all_rows() {
  std::vector<Row> rows;
  for (auto make : {no_bodies, no_fluid, no_moving_bodies, no_body_moved, no_body_near_a_block,
                    no_fluid_in_a_block, no_contacts, no_other_shapes})
    rows.push_back(make());
  return rows;
}

constexpr int warm_up = 4, counted = 4;  // steps

void pieces() {
  for (Row& row : all_rows())
    for (const auto& [which, step] : {std::pair{"scene", &row.scene}, std::pair{"driver", &row.driver}}) {
      for (int t = 0; t < warm_up; ++t) (*step)();
      count_piece(row.key + "." + which, [&] {
        for (int t = 0; t < counted; ++t) (*step)();
      });
    }
}

/// Scene over driver, sample by sample in turn.
Spread times(Row& row, bool quick) {
  const auto sample = [](const std::function<void()>& step, int steps) {
    return seconds([&] {
      for (int t = 0; t < steps; ++t) step();
    });
  };
  const double first = sample(row.scene, warm_up) + sample(row.driver, warm_up);
  const int steps = 2 * std::max(1, int((quick ? 0.002 : 0.02) * warm_up / first));
  Spread scene, driver;
  for (int r = 0; r < (quick ? 3 : 9); ++r) {
    scene.add(sample(row.scene, steps));
    driver.add(sample(row.driver, steps));
  }
  return ratio(scene, driver);
}

void run(const Options& o) {
  if (o.others == std::vector<std::string>{"--pieces"}) return pieces();
  require_no_others(o);
  const auto counts = count_instructions("--pieces");
  Figures out;
  for (Row& row : all_rows()) {
    const double instructions = counts.at(row.key + ".scene") / counts.at(row.key + ".driver");
    const Spread time = times(row, o.quick);
    printf("without %-52s instructions %.4f  time %.3f (%.3f to %.3f)\n", row.without.c_str(), instructions,
           time.middle(), time.lowest(), time.highest());
    out.figures["skip." + row.key + ".ratio"] = instructions;
    out.figures["skip." + row.key + ".time_ratio"] = time.middle();
    out.table.push_back(adapters::Json::object({{"without", row.without},
                                                {"instructions_scene_over_driver", instructions},
                                                {"time_scene_over_driver", time.middle()},
                                                {"time_lowest", time.lowest()},
                                                {"time_highest", time.highest()}}));
  }
  out.write(o.json);
}

}  // namespace
}  // namespace silt::bench

int main(int argc, char** argv) {
  return silt::bench::main_of(argc, argv, silt::bench::run);
}
