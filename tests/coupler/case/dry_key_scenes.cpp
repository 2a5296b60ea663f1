#include "tests/coupler/case/key_scenes.hpp"

namespace silt::coupler::testing {

SceneOfKeys dry() {
  SceneOfKeys scene;
  scene.text = R"([units]
system = "lattice"
[domain]
size = [40, 20, 30]
boundary = { x = [{ type = "no-slip" }, { type = "no-slip" }], y = "periodic", z = [{ type = "no-slip" }, { type = "no-slip" }] }
[gravity]
acceleration = [0, 0, -2e-3]
[[material_pairs]]
between = ["glass", "glass"]
[[shapes]]
name = "ball"
type = "sphere"
radius = 3
[[shapes]]
name = "tip"
type = "polyhedron"
vertices = [[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6]]
[[bodies]]
name = "one"
shape = "ball"
material = "glass"
density = 1
position = [8, 10, 3]
velocity = [0.3, 0.02, 0]
[[bodies]]
name = "two"
shape = "ball"
material = "glass"
density = 1
position = [16, 10.5, 3]
[[bodies]]
name = "tip"
shape = "tip"
density = 1
position = [30, 10, 8]
[run]
steps = 80
)";
  const Overrides far_out = {"bodies[0].velocity=[0.9, 0, 0]", "contacts.margin=2",
                             "bodies[1].position=[30, 16, 3]", "bodies[2].position=[20, 10, 20]"};
  const Overrides hangs = {"bodies[0].motion=\"prescribed\"", "bodies[0].velocity=[0, 0, 0]",
                           "bodies[0].position=[8, 10, 15]", "bodies[1].position=[8, 10, 9]"};
  const auto spring = [](const std::string& lines) {
    return "springs=[{ body = \"one\", to = \"two\", " + lines + " }]";
  };
  scene.samples = {
      {"contacts.resolver", "ffd"},
      {"contacts.substeps", "3"},
      {"contacts.margin", "0.01"},
      {"contacts.restitution", "0.5"},
      {"contacts.friction", "0.3"},
      {"contacts.rolling_friction", "0.1", {"contacts.friction=0.3"}},
      {"contacts.twisting_friction", "0.1", {"bodies[0].angular_velocity=[0, 0, 0.1]"}},
      {"contacts.cohesion", "0.5", {"contacts.friction=0.3"}},
      {"contacts.hamaker", "1", {"contacts.hamaker_gap=0.2"}},
      {"contacts.hamaker_gap", "0.2", {"contacts.hamaker=1"}, "0.4"},
      {"contacts.sweeps", "1"},
      {"contacts.impact_sweeps", "5", {"contacts.restitution=0.5"}},
      {"material_pairs[0].restitution", "0.4"},
      {"material_pairs[0].friction", "0.01"},
      {"material_pairs[0].rolling_friction", "0.01", {"contacts.friction=0.3"}},
      {"material_pairs[0].twisting_friction", "0.2", {"bodies[0].angular_velocity=[0.1, 0, 0]"}},
      {"material_pairs[0].cohesion", "1", hangs},
      {"material_pairs[0].hamaker", "2", {"material_pairs[0].hamaker_gap=0.2"}},
      {"material_pairs[0].hamaker_gap", "0.4", {"material_pairs[0].hamaker=1"}, "0.3"},
      {"bodies[0].velocity", "[0.2, 0, 0]"},
      {"bodies[0].angular_velocity", "[0, 0.1, 0]"},
      {"bodies[0].orientation", "{ axis = [1, 0, 0], degrees = 30 }"},
      {"bodies[0].locked", "[\"z\"]"},
      {"bodies[0].motion", "\"prescribed\""},
      {"bodies[2].origin", "centre"},
      {"bodies[0].material", "default", {"material_pairs[0].friction=0.01"}},
      {"domain.boundary.x[1].solid_for_bodies", "false", far_out},
      {"outflow", "[{ box = [[26, 0, 5], [40, 20, 30]] }]"},
      {"springs", "[{ body = \"one\", to = \"two\", stiffness = 0.1, length = 5 }]"},
      {"springs[0].to", "tip", {spring("stiffness = 0.1, length = 5")}},
      {"springs[0].ends", "[[8, 10, 5], [16, 10, 3]]", {spring("stiffness = 0.1, length = 5")}},
      {"springs[0].damping", "0.1", {spring("stiffness = 0")}},
      {"springs[0].length", "6", {spring("stiffness = 0.1")}},
  };
  scene.switches = {"gravity=",
                    "contacts.resolver=\"ffd\"",
                    "contacts.restitution=1",
                    "material_pairs[0].hamaker=0",
                    "contacts.hamaker=0",
                    "bodies[0].motion=\"fixed\"",
                    "bodies[1].motion=\"fixed\"",
                    "domain.boundary=\"periodic\"",
                    "springs[0].stiffness=0"};
  // Nothing presses bodies together; the floor is not there; pairs of restitution 1 have an impact phase by
  // themselves, which leaves nothing to friction; another pull holds bodies, or they are moved apart; a body
  // is slower, or taken out; only how far contacts are looked for is another.
  scene.coincide = {{"contacts.rolling_friction", "gravity"},
                    {"contacts.twisting_friction", "gravity"},
                    {"material_pairs[0].rolling_friction", "gravity"},
                    {"material_pairs[0].cohesion", "gravity"},
                    {"contacts.sweeps", "domain.boundary"},
                    {"contacts.cohesion", "domain.boundary"},
                    {"contacts.impact_sweeps", "contacts.restitution"},
                    {"material_pairs[0].twisting_friction", "contacts.impact_sweeps"},
                    {"material_pairs[0].twisting_friction", "contacts.restitution"},
                    {"contacts.margin", "material_pairs[0].cohesion"},
                    {"contacts.cohesion", "material_pairs[0].cohesion"},
                    {"material_pairs[0].hamaker_gap", "material_pairs[0].cohesion"},
                    {"springs[0].damping", "material_pairs[0].cohesion"},
                    {"material_pairs[0].cohesion", "material_pairs[0].hamaker"},
                    {"material_pairs[0].cohesion", "bodies[0].velocity"},
                    {"domain.boundary.x[1].solid_for_bodies", "bodies[0].velocity"},
                    {"bodies[0].angular_velocity", "domain.boundary.x[1].solid_for_bodies"},
                    {"bodies[0].orientation", "domain.boundary.x[1].solid_for_bodies"},
                    {"bodies[2].origin", "outflow"},
                    {"material_pairs[0].hamaker", "bodies[0].material"},
                    {"material_pairs[0].hamaker_gap", "bodies[0].material"}};
  return scene;
}

SceneOfKeys filled() {
  SceneOfKeys scene;
  scene.text = R"([units]
system = "lattice"
[domain]
size = [32, 32, 32]
boundary = "no-slip"
[gravity]
acceleration = [0, 0, -1e-3]
[[shapes]]
name = "ball"
type = "sphere"
radius = 2
[[fill]]
shape = "ball"
density = 1
count = 6
[run]
steps = 10
)";
  const Overrides sites = {"fill[0].arrangement=simple-cubic"};
  const Overrides sized = {"fill[0].diameter={ table = [[3, 1], [4, 1]] }"};
  scene.samples = {
      {"fill[0].arrangement", "hexagonal"},
      {"fill[0].diameter", "{ smallest = 3, largest = 5 }"},
      {"fill[0].diameter.by", "mass", sized},
      {"fill[0].count", "9", {}, "6"},
      {"fill[0].spacing", "7", sites},
      {"fill[0].shift", "1", sites},
      {"fill[0].gap", "1"},
      {"fill[0].seed", "5"},
      {"fill[0].orientation", "aligned"},
      {"fill[0].box", "[[0, 0, 16], [32, 32, 32]]"},
      {"fill[0].velocity", "[0.1, 0, 0]"},
      {"fill[0].every", "4", {"fill[0].box=[[2, 2, 20], [30, 30, 30]]"}},
      {"fill[0].material",
       "glass",
       {"material_pairs=[{ between = [\"glass\", \"default\"], friction = 0.5 }]",
        "fill[0].velocity=[0.1, 0, 0]", "fill[0].box=[[0, 0, 0], [32, 32, 4.1]]"}},
  };
  scene.switches = {"fill[0].arrangement=\"simple-cubic\"", "fill[0].arrangement=\"hexagonal\"",
                    "fill[0].orientation=\"aligned\"", "fill[0].shift=0"};
  return scene;
}

}  // namespace silt::coupler::testing
