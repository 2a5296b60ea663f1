#include "tests/bench/skip_rows.hpp"

#include <mpi.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>

#include "adapters/automatic/collision_factory.hpp"
#include "coupler/exchange/coupling_state.hpp"
#include "lbm/fluid.hpp"
#include "rigid/collision/detect_contacts.hpp"
#include "rigid/rigid_step.hpp"
#include "silt/guard.hpp"
#include "silt/run/run.hpp"
#include "silt/simulation.hpp"
#include "tests/bench/periodic_box.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::bench {
namespace {

using silt::Simulation;

struct SceneText {
  std::string domain = "size = [48, 48, 48]\nboundary = \"periodic\"";
  std::string fluid = "relaxation_time = 0.8", bodies, rest;
};
std::string text_of(const SceneText& t, int steps = 100000) {
  std::string text = "title = \"skip\"\n[units]\nsystem = \"lattice\"\n[domain]\n" + t.domain + "\n";
  if (!t.fluid.empty()) text += "[fluid]\n" + t.fluid + "\n";
  return text + t.rest + "\n" + t.bodies + "[run]\nsteps = " + std::to_string(steps) + "\n";
}
Simulation simulation_of(const SceneText& t) {
  return silt::testing::simulation_of(text_of(t));
}

std::string spheres(int count, const std::string& box, const std::string& more = "") {
  return "[[shapes]]\nname = \"sphere\"\ntype = \"sphere\"\ndiameter = 6\n[[fill]]\nshape = "
         "\"sphere\"\ndensity = 1.5\ncount = " +
         std::to_string(count) + "\nseed = 1\ngap = 2\nbox = " + box + "\n" + more;
}
std::string fixed_sphere(const std::string& at) {
  return "[[bodies]]\nshape = \"sphere\"\ndensity = 1\nmotion = \"fixed\"\nposition = " + at + "\n";
}

/// A scene ready for its passes, without the program around them.
struct Passes {
  explicit Passes(const SceneText& text) : simulation(simulation_of(text)) {}
  /// With what is on the lattice: looks whether it moved, and begins its sums.
  void flow() {
    if (scene.bodies.size()) scene.flow->map_bodies(scene.bodies, no_changes);
    scene.flow->stream_collide(clock);
    scene.flow->communicate();
  }
  void forces() { scene.flow->evaluate_forces(scene.bodies); }
  void clear_forces() {
    std::fill(scene.bodies.force.begin(), scene.bodies.force.end(), rigid::FixedVec3{});
    std::fill(scene.bodies.torque.begin(), scene.bodies.torque.end(), rigid::FixedVec3{});
  }
  /// With the guard, which the simulation has hung in.
  void rigid_step() { scene.rigid_step->advance(scene.bodies, 1); }
  /// Every scene whose bodies move asks whether they do so within bounds.
  void guard() {
    faults.hold_runaways(scene.setup, scene.bodies, 1);
    faults.see_overlaps(scene.setup, scene.bodies, scene.rigid_step->contacts(), 1);
  }
  Simulation simulation;
  Scene& scene = simulation.scene();
  coupler::StepClock clock;
  FaultWatch faults{scene.setup};
  const coupler::BodyChanges no_changes;
};

Steps repeated(std::function<void()> step) {
  return [step](int steps) {
    for (int t = 0; t < steps; ++t) step();
  };
}
Row row(const std::string& key, const std::string& without, const SceneText& text,
        std::function<void()> driver_step) {
  auto scene = std::shared_ptr<Simulation>(new Simulation(simulation_of(text)));
  return {key, without, repeated([scene] { scene->step(); }), repeated(std::move(driver_step))};
}

Row no_bodies() {
  const lbm::CollisionSpec collision{0.8, 1. / 6, lbm::Collision::trt, {}};
  const std::shared_ptr<lbm::Fluid<float>> fluid(
      new lbm::Fluid<float>(periodic_box<float>({48, 48, 48}, collision)));
  return row("bodies", "bodies: kernel and ghost layer alone", {}, [fluid] { step(*fluid); });
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

/// Spheres far from one another.
SceneText scattered(const std::string& gravity) {
  SceneText text;
  text.fluid = "", text.domain = "size = [480, 480, 480]\nboundary = \"periodic\"";
  text.rest = "[gravity]\nacceleration = " + gravity;
  text.bodies = spheres(100, "[[0, 0, 0], [480, 480, 480]]");
  return text;
}

/// A step without contact: half of the way, search for pairs, what the forces do, the other half.
template <class Forces>
std::function<void()> free_motion(const SceneText& text, Forces&& act) {
  auto passes = std::make_shared<Passes>(text);
  auto detect = std::make_shared<rigid::DetectContacts>();
  return [passes, detect, act] {
    Scene& s = passes->scene;
    std::vector<rigid::Contact> none;
    rigid::drift(s.bodies, s.bodies.owned + s.bodies.copies, 0.5);
    s.exchange->wrap_positions(s.bodies);
    (*detect)(s.world, s.bodies, *s.exchange, *s.contacts.backend, 1.0, none);
    act(s);
    rigid::drift(s.bodies, s.bodies.owned, 0.5);
    s.exchange->synchronise(s.bodies);
    passes->guard();
  };
}

Row no_contacts() {
  const SceneText text = scattered("[0, 0, -1e-6]");
  return row("contacts", "contacts: free motion and the search for pairs", text,
             free_motion(text, [](Scene& s) {
               for (std::size_t row = 0; row < s.bodies.owned; ++row)
                 s.bodies.velocity[row] += s.bodies.weight_in_fluid[row] * s.world.gravity;
             }));
}

Row no_force() {
  const SceneText text = scattered("[0, 0, 0]");
  return row("external_force", "forces and contacts: motion and the search for pairs", text,
             free_motion(text, [](const Scene&) {}));
}

Row no_other_shapes() {
  SceneText text, analytic;
  text.fluid = analytic.fluid = "";
  text.bodies = analytic.bodies = spheres(100, "[[0, 0, 0], [48, 48, 48]]");
  analytic.rest = "[contacts]\nbackend = \"analytic\"";
  auto passes = std::make_shared<Passes>(analytic);
  return row("non_spheres", "other shapes: closed forms called directly", text,
             [passes] { passes->rigid_step(); });
}

/// The bodies' step on an exchange that is nothing but periodic images.
Row no_neighbour_ranks() {
  struct Alone {
    explicit Alone(const SceneText& text)
        : passes(text),
          exchange(passes.scene.exchange->extent()),
          step(passes.scene.world, *passes.scene.contacts.backend, *passes.scene.contacts.resolver, exchange,
               adapters::make_broad_phase("auto", "auto")) {}
    Passes passes;
    rigid::BodyExchange exchange;
    rigid::RigidStep step;
  };
  SceneText text;
  text.fluid = "", text.bodies = spheres(100, "[[0, 0, 0], [48, 48, 48]]");
  auto alone = std::make_shared<Alone>(text);
  return row("neighbour_ranks", "neighbour ranks: bodies that know of one rank only", text, [alone] {
    alone->step.advance(alone->passes.scene.bodies, 1);
    alone->passes.guard();
  });
}

/// Spheres stacked on a floor. No driver knows their sweeps without friction: the same stack with friction
/// stands in for it, and the figure says what is left of a step.
Row no_friction() {
  const auto stack = [](double friction) {
    SceneText text;
    text.fluid = "";
    text.domain =
        "size = [48, 48, 48]\nboundary = { x = \"periodic\", y = \"periodic\", z = [\"no-slip\", "
        "\"no-slip\"] }";
    text.rest = "[gravity]\nacceleration = [0, 0, -1e-4]\n[contacts]\nrestitution = 0\nfriction = " +
                std::to_string(friction);
    text.bodies =
        "[[shapes]]\nname = \"sphere\"\ntype = \"sphere\"\ndiameter = 6\n[[bodies]]\nshape = "
        "\"sphere\"\ndensity = 1.5\npositions = [";
    for (int n = 0; n < 256; ++n) {
      const std::string x = std::to_string(3 + 6 * (n % 8)), y = std::to_string(3 + 6 * (n / 8 % 8));
      text.bodies += "[" + x + ", " + y + ", " + std::to_string(3 + 6 * (n / 64)) + "], ";
    }
    text.bodies += "]\n";
    return text;
  };
  auto rubbing = std::make_shared<Passes>(stack(0.4));
  return row("friction", "friction: the same stack with it (no driver)", stack(0),
             [rubbing] { rubbing->rigid_step(); });
}

/// The whole program, and its steps alone: many, since what MPI and the program do by the clock at the start
/// is not the same in two runs.
Row no_outputs() {
  constexpr int many = 16;
  namespace fs = std::filesystem;
  SceneText text;
  text.fluid = "", text.bodies = spheres(100, "[[0, 0, 0], [48, 48, 48]]");
  auto steps_alone = std::shared_ptr<Simulation>(new Simulation(simulation_of(text)));
  const auto whole_program = [text](int steps) {
    const fs::path folder = fs::temp_directory_path() / ("silt-skip-" + std::to_string(getpid()));
    fs::create_directories(folder);
    RunOptions options;
    options.directory = folder;
    std::ofstream(folder / "case.toml") << text_of(text, many * steps);
    const Exit exit = run_case(options, MPI_COMM_SELF);
    fs::remove_all(folder);
    if (exit != Exit::done) throw std::runtime_error("the run without outputs did not end well");
  };
  return {"outputs", "outputs: steps without the program around them", whole_program, repeated([steps_alone] {
            for (int k = 0; k < many; ++k) steps_alone->step();
          }),
          false};
}

}  // namespace

std::vector<Row> skip_rows() {
  std::vector<Row> rows;
  for (auto make :
       {no_bodies, no_fluid, no_moving_bodies, no_body_moved, no_body_near_a_block, no_fluid_in_a_block,
        no_contacts, no_force, no_friction, no_other_shapes, no_neighbour_ranks, no_outputs})
    rows.push_back(make());
  return rows;
}

}  // namespace silt::bench
