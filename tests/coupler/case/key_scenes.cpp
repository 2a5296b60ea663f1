#include "tests/coupler/case/key_scenes.hpp"

namespace silt::coupler::testing {

SceneOfKeys in_fluid() {
  SceneOfKeys scene;
  scene.text = R"([units]
system = "lattice"
[domain]
size = [24, 12, 12]
boundary = { x = "periodic", y = "periodic", z = [{ type = "no-slip" }, { type = "moving", velocity = [0.05, 0, 0] }] }
[fluid]
relaxation_time = 0.8
[gravity]
acceleration = [0, 0, -1e-3]
[[shapes]]
name = "ball"
type = "sphere"
radius = 3
[[bodies]]
name = "one"
shape = "ball"
density = 1.5
position = [5, 6, 3.3]
velocity = [0.05, 0, 0]
[[bodies]]
name = "two"
shape = "ball"
density = 1.5
position = [11.3, 6, 3.3]
[run]
steps = 24
[[quantities]]
name = "lid"
type = "fluid-force"
side = "z-high"
axis = "x"
)";
  const Overrides forced = {"fluid.body_force=[1e-4, 0, 0]"};
  const std::string lid = "domain.boundary.z[1]";
  scene.samples = {
      {"fluid.collision", "bgk"},
      {"fluid.magic", "0.3"},
      {"fluid.precision", "double"},
      {"fluid.body_force", "[1e-4, 0, 0]"},
      {"fluid.body_force_over_time", "{ table = [[0, 0], [10, 1]] }", forced},
      {"fluid.superficial_velocity", "[0.01, 0, 0]"},
      {"fluid.body_force_on_bodies", "true", forced},
      {"fluid.quiet_start", "true"},
      {"fluid.initial", "{ type = \"uniform\", velocity = [0.01, 0, 0] }"},
      {"fluid.initial.noise", "1e-3", {"fluid.initial.type=rest"}},
      {"fluid.initial.steepness",
       "20",
       {"fluid.initial={ type = \"shear-layer\", velocity = [0.02, 0, 0] }"}},
      {"gravity.over_time", "{ amplitude = 1, frequency = 0.1 }"},
      {"gravity.over_time.table", "[[0, 0], [10, 1]]"},
      {"gravity.over_time.amplitude", "1", {"gravity.over_time.frequency=0.1"}},
      {"gravity.over_time.frequency", "0.1", {"gravity.over_time.amplitude=1"}},
      {"coupling.wall_scheme", "bounce-back"},
      {"coupling.time", "explicit"},
      {"coupling.force", "exact"},
      {"coupling.remap_tolerance", "0.3"},
      {"coupling.lubrication", "false"},
      {"coupling.lubrication_min_gap", "0.5"},
      {"contacts.resolver", "ffd"},
      {"contacts.substeps", "3"},
      {lid + ".over_time", "{ table = [[0, 0], [10, 1]] }"},
      {"domain.boundary.z[0].solid_for_bodies", "false"},
      {"bodies[0].motion", "fixed", {"bodies[0].velocity="}},
      {"bodies[0].motion", "{ velocity = [0.02, 0, 0] }", {"bodies[0].velocity="}},
      {"bodies[0].motion.axis",
       "x",
       {"bodies[0].velocity=", "bodies[0].motion={ angular_velocity = 0.01, axis = \"z\" }"}},
      {"bodies[0].motion.amplitude",
       "[0.1, 0, 0]",
       {"bodies[0].velocity=", "bodies[0].motion={ frequency = 0.05 }"}},
      {"bodies[0].motion.frequency",
       "0.05",
       {"bodies[0].velocity=", "bodies[0].motion={ amplitude = [0.1, 0, 0] }"}},
      {"bodies[0].locked", "[\"x\", \"y\", \"z\"]"},
      {"bodies[0].angular_velocity", "[0, 0, 0.01]"},
      {"bodies[0].orientation", "[1, 0, 0]"},
      {"springs", "[{ body = \"one\", to = \"two\", stiffness = 1e-3, length = 5 }]"},
      {"springs[0].damping",
       "0.1",
       {"springs=[{ body = \"one\", to = \"two\", stiffness = 1e-3, length = 5 }]"}},
      {"springs[0].length", "5", {"springs=[{ body = \"one\", to = \"two\", stiffness = 1e-3 }]"}},
  };
  scene.switches = {"fluid=",
                    "bodies=",
                    "gravity=",
                    "gravity.acceleration=[0, 0, 0]",
                    "fluid.body_force=[0, 0, 0]",
                    "fluid.superficial_velocity=[0, 0.01, 0]",
                    "fluid.collision=auto",
                    "fluid.collision=regularised",
                    "fluid.initial={ type = \"vortex\", velocity = [0, 0, 0], swirl = 0.01, radius = 3 }",
                    "coupling.lubrication=false",
                    "domain.boundary=\"periodic\"",
                    "domain.boundary.z[1]={ type = \"moving\", velocity = [0, 0, 0] }",
                    "bodies[0].motion=\"fixed\"",
                    "bodies[1].motion=\"fixed\"",
                    "bodies[0].motion=\"prescribed\"",
                    "bodies[0].density=1",
                    "gravity.over_time.amplitude=0",
                    "gravity.over_time.frequency=0",
                    "bodies[0].motion.velocity=[0, 0, 0]",
                    "bodies[0].motion.angular_velocity=0",
                    "bodies[0].motion.amplitude=[0, 0, 0]",
                    "bodies[0].motion.frequency=0",
                    "springs[0].stiffness=0"};
  // ffd has no films; nothing else touches
  scene.coincide = {{"coupling.lubrication", "contacts.resolver"},
                    {"domain.boundary.z[0].solid_for_bodies", "coupling.lubrication"},
                    {"domain.boundary.z[0].solid_for_bodies", "contacts.resolver"}};
  return scene;
}

SceneOfKeys of_levels() {
  SceneOfKeys scene;
  scene.text = R"([units]
system = "lattice"
[domain]
size = [48, 16, 48]
boundary = { x = "periodic", y = "periodic", z = "no-slip" }
[fluid]
relaxation_time = 0.8
body_force = [1e-5, 0, 0]
[coarsening]
levels = 1
[[shapes]]
name = "ball"
type = "sphere"
radius = 3
[[bodies]]
shape = "ball"
density = 1
motion = "fixed"
position = [24, 8, 8]
[run]
steps = 8
)";
  scene.samples = {
      {"coarsening.distance", "12"},
      {"coarsening.fine", "[{ box = [[8, 0, 20], [24, 16, 40]] }]"},
      {"coarsening.fine[0].level",
       "1",
       {"coarsening.levels=2", "coarsening.fine=[{ box = [[8, 0, 20], [24, 16, 40]] }]"}},
  };
  scene.switches = {"bodies=", "coarsening.fine=[{ box = [[0, 0, 0], [48, 16, 48]] }]"};
  return scene;
}

SceneOfKeys between_walls() {
  SceneOfKeys scene;
  scene.text = R"([units]
system = "lattice"
[domain]
size = [20, 20, 16]
boundary = { x = "periodic", y = "periodic", z = [{ type = "no-slip" }, { type = "pressure-outlet" }] }
[fluid]
relaxation_time = 0.8
body_force = [1e-5, 0, 0]
[gravity]
acceleration = [0, 0, -2e-3]
[[material_pairs]]
between = ["default", "glass"]
friction = 0.3
[[walls]]
type = "tube"
axis = "z"
radius = 9
point = [10, 10, 0]
[[walls]]
type = "mesh"
file = "block.ply"
solid = "inside"
position = [10, 14, 8]
[[shapes]]
name = "ball"
type = "sphere"
radius = 3
[[shapes]]
name = "pair"
type = "compound"
parts = [{ type = "sphere", radius = 2 }, { type = "capsule", radius = 1.5, length = 2 }]
[[shapes]]
name = "piece"
type = "mesh"
file = "block.ply"
[[bodies]]
shape = "ball"
density = 2
position = [4.35, 8, 3]
velocity = [-0.05, 0.02, 0]
[[bodies]]
shape = "pair"
density = 2
position = [10, 6, 10]
[[bodies]]
shape = "piece"
density = 2
position = [15, 8, 4]
[run]
steps = 16
)";
  scene.files = {{"block.ply", ply_of(rigid::testing::cuboid_mesh({-1.5, -1.5, -1.5}, {1.5, 1.5, 2}))},
                 {"path.csv", "0, 0, 0, 0, 0, 0, 0\n8, 0.1, 0, 0, 0, 0, 0.1\n16, 0.2, 0, 0, 0, 0, 0.1\n"}};
  const std::string motion = "walls[1].motion";
  const Overrides turns = {motion + "={ angular_velocity = 0.01, axis = \"z\" }"};
  scene.samples = {
      {"walls[0].angular_velocity", "0.005"},
      {"walls[0].material", "glass", {"contacts.friction=0.01"}},
      {"walls[1].scale", "0.9"},
      {"walls[1].position", "[10, 13, 8]"},
      {"walls[1].orientation", "[1, 0, 0]"},
      {motion, "{ velocity = [0.02, 0, 0] }"},
      {motion + ".velocity", "[0.03, 0, 0]", turns},
      {motion + ".angular_velocity", "0.02", {motion + "={ axis = \"z\" }"}},
      {motion + ".axis", "x", turns},
      {motion + ".point", "[10, 12, 8]", turns},
      {motion + ".table", "path.csv", {motion + "={}"}},
      {motion + ".amplitude", "[0.2, 0, 0]", {motion + "={ frequency = 0.05 }"}},
      {motion + ".frequency", "0.05", {motion + "={ amplitude = [0.2, 0, 0] }"}},
      {"shapes[1].parts[1].position", "[0, 0, 2]"},
      {"shapes[1].parts[1].orientation", "[1, 0, 0]"},
      {"shapes[2].scale", "0.9"},
      {"domain.boundary.z[1].density", "1.001"},
      {"coupling.wall_scheme", "bounce-back"},
  };
  scene.switches = {"bodies=",
                    motion + ".angular_velocity=0",
                    motion + ".velocity=[0, 0, 0]",
                    motion + ".amplitude=[0, 0, 0]",
                    motion + ".frequency=0",
                    "walls[1]=",
                    "domain.boundary.z=\"no-slip\""};
  scene.coincide = {{"shapes[1].parts[1].position", "bodies"},
                    {"shapes[1].parts[1].orientation", "bodies"},
                    {"shapes[2].scale", "bodies"}};  // nobody has the shape
  return scene;
}

}  // namespace silt::coupler::testing
