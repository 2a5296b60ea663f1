#include "tests/silt/case/key_scenes.hpp"

namespace silt::testing {
namespace {

/// One spring between the bodies "one" and "two".
std::string springs(const std::string& lines) {
  return "[{ body = \"one\", to = \"two\", " + lines + " }]";
}

std::vector<Sample> samples_in_fluid() {
  const Overrides forced = {"fluid.body_force=[1e-4, 0, 0]"};
  const auto moving = [](const std::string& lines) -> Overrides {
    return {"bodies[0].velocity=", "bodies[0].motion={ " + lines + " }"};
  };
  return {
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
      {"domain.boundary.z[1].over_time", "{ table = [[0, 0], [10, 1]] }"},
      {"domain.boundary.z[0].solid_for_bodies", "false"},
      {"bodies[0].motion", "fixed", {"bodies[0].velocity="}},
      {"bodies[0].motion", "{ velocity = [0.02, 0, 0] }", {"bodies[0].velocity="}},
      {"bodies[0].motion.axis", "x", moving("angular_velocity = 0.01, axis = \"z\"")},
      {"bodies[0].motion.amplitude", "[0.1, 0, 0]", moving("frequency = 0.05")},
      {"bodies[0].motion.frequency", "0.05", moving("amplitude = [0.1, 0, 0]")},
      {"bodies[0].locked", "[\"x\", \"y\", \"z\"]"},
      {"bodies[0].angular_velocity", "[0, 0, 0.01]"},
      {"bodies[0].orientation", "[1, 0, 0]"},
      {"springs", springs("stiffness = 1e-3, length = 5")},
      {"springs[0].damping", "0.1", {"springs=" + springs("stiffness = 1e-3, length = 5")}},
      {"springs[0].length", "5", {"springs=" + springs("stiffness = 1e-3")}},
  };
}

std::vector<Sample> samples_between_walls() {
  const std::string motion = "walls[1].motion";
  const Overrides turns = {motion + "={ angular_velocity = 0.01, axis = \"z\" }"};
  return {
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
      {"domain.boundary.z[1].pressure", "3e-4"},
      {"coupling.wall_scheme", "bounce-back"},
      {"walls[0].temperature", "1", {"heat={ prandtl = 1 }"}},
  };
}

std::vector<Sample> samples_when_dry() {
  const Overrides far_out = {"bodies[0].velocity=[0.9, 0, 0]", "contacts.margin=2",
                             "bodies[1].position=[30, 16, 3]", "bodies[2].position=[20, 10, 20]"};
  const Overrides hangs = {"bodies[0].motion=\"prescribed\"", "bodies[0].velocity=[0, 0, 0]",
                           "bodies[0].position=[8, 10, 15]", "bodies[1].position=[8, 10, 9]"};
  return {
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
      {"springs", springs("stiffness = 0.1, length = 5")},
      {"springs[0].to", "tip", {"springs=" + springs("stiffness = 0.1, length = 5")}},
      {"springs[0].ends", "[[8, 10, 5], [16, 10, 3]]", {"springs=" + springs("stiffness = 0.1, length = 5")}},
      {"springs[0].damping", "0.1", {"springs=" + springs("stiffness = 0")}},
      {"springs[0].length", "6", {"springs=" + springs("stiffness = 0.1")}},
  };
}

}  // namespace

SceneOfKeys in_fluid() {
  SceneOfKeys scene;
  scene.text =
      CaseText().units +
      domain_of(
          {24, 12, 12},
          R"({ x = "periodic", y = "periodic", z = [{ type = "no-slip" }, { type = "moving", velocity = [0.05, 0, 0] }] })") +
      "[fluid]\nrelaxation_time = 0.8\n[gravity]\nacceleration = [0, 0, -1e-3]\n" + sphere_of("ball", 6) +
      body_of("ball", 1.5, "name = \"one\"\nposition = [5, 6, 3.3]\nvelocity = [0.05, 0, 0]") +
      body_of("ball", 1.5, "name = \"two\"\nposition = [11.3, 6, 3.3]") +
      "[run]\nsteps = 24\n[[quantities]]\nname = \"lid\"\ntype = \"fluid-force\"\nside = \"z-high\"\naxis = "
      "\"x\"\n";
  scene.samples = samples_in_fluid();
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
  scene.text = CaseText().units +
               domain_of({48, 16, 48}, R"({ x = "periodic", y = "periodic", z = "no-slip" })") +
               "[fluid]\nrelaxation_time = 0.8\nbody_force = [1e-5, 0, 0]\n[coarsening]\nlevels = 1\n" +
               sphere_of("ball", 6) + body_of("ball", 1, "motion = \"fixed\"\nposition = [24, 8, 8]") +
               "[run]\nsteps = 8\n";
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
  scene.text =
      CaseText().units +
      domain_of(
          {20, 20, 16},
          R"({ x = "periodic", y = "periodic", z = [{ type = "no-slip" }, { type = "pressure-outlet" }] })") +
      R"([fluid]
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
)" + sphere_of("ball", 6) +
      shape_of(
          "pair", "compound",
          R"(parts = [{ type = "sphere", radius = 2 }, { type = "capsule", radius = 1.5, length = 2 }])") +
      shape_of("piece", "mesh", "file = \"block.ply\"") +
      body_of("ball", 2, "position = [4.35, 8, 3]\nvelocity = [-0.05, 0.02, 0]") +
      body_of("pair", 2, "position = [10, 6, 10]") + body_of("piece", 2, "position = [15, 8, 4]") +
      "[run]\nsteps = 16\n";
  scene.files = {{"block.ply", ply_of(rigid::testing::cuboid_mesh({-1.5, -1.5, -1.5}, {1.5, 1.5, 2}))},
                 {"path.csv", "0, 0, 0, 0, 0, 0, 0\n8, 0.1, 0, 0, 0, 0, 0.1\n16, 0.2, 0, 0, 0, 0, 0.1\n"}};
  scene.samples = samples_between_walls();
  scene.switches = {"bodies=",
                    "walls[1].motion.angular_velocity=0",
                    "walls[1].motion.velocity=[0, 0, 0]",
                    "walls[1].motion.amplitude=[0, 0, 0]",
                    "walls[1].motion.frequency=0",
                    "walls[1]=",
                    "domain.boundary.z=\"no-slip\""};
  scene.coincide = {{"shapes[1].parts[1].position", "bodies"},
                    {"shapes[1].parts[1].orientation", "bodies"},
                    {"shapes[2].scale", "bodies"}};  // nobody has the shape
  return scene;
}

SceneOfKeys warm() {
  SceneOfKeys scene;
  scene.text =
      CaseText().units +
      domain_of({12, 12, 24},
                "{ x = \"periodic\", y = \"periodic\", z = [{ type = \"no-slip\" }, { type = "
                "\"no-slip\", temperature = 2 }] }") +
      "[fluid]\nrelaxation_time = 0.8\n[heat]\nprandtl = 1\n[gravity]\nacceleration = [0, 0, -1e-4]\n" +
      sphere_of("ball", 6) + body_of("ball", 2, "name = \"one\"\nposition = [6.2, 6.1, 5.3]") +
      fill_of("ball", 2, 1, "name = \"two\"\nbox = [[2, 2, 11], [10, 10, 20]]") + "[run]\nsteps = 12\n";
  scene.samples = {{"heat.temperature", "1"},
                   {"heat.initial", "3"},
                   {"heat.expansion", "0.1"},
                   {"heat.mean_gradient", "[0.1, 0, 0]"},
                   {"domain.boundary.z[0].temperature", "4"},
                   {"domain.boundary.z[0].heat_flux", "0.1"}};
  for (const std::string of : {"bodies[0]", "fill[0]"}) {
    const Overrides warm = {of + ".temperature=2"}, lump = {of + ".temperature=2", of + ".heat_capacity=0.5"};
    scene.samples.push_back({of + ".temperature", "3"});
    scene.samples.push_back({of + ".heat_capacity", "0.5", warm});
    scene.samples.push_back({of + ".heat_source", "0.1", lump});
  }
  return scene;
}

SceneOfKeys dry() {
  SceneOfKeys scene;
  const std::string floor = R"([{ type = "no-slip" }, { type = "no-slip" }])";
  scene.text =
      CaseText().units +
      domain_of({40, 20, 30}, "{ x = " + floor + ", y = \"periodic\", z = " + floor + " }") +
      "[gravity]\nacceleration = [0, 0, -2e-3]\n[[material_pairs]]\nbetween = [\"glass\", \"glass\"]\n" +
      sphere_of("ball", 6) +
      shape_of("tip", "polyhedron", "vertices = [[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6]]") +
      body_of("ball", 1,
              "name = \"one\"\nmaterial = \"glass\"\nposition = [8, 10, 3]\nvelocity = [0.3, 0.02, 0]") +
      body_of("ball", 1, "name = \"two\"\nmaterial = \"glass\"\nposition = [16, 10.5, 3]") +
      body_of("tip", 1, "name = \"tip\"\nposition = [30, 10, 8]") + "[run]\nsteps = 80\n";
  scene.samples = samples_when_dry();
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
  scene.text = CaseText().units + domain_of({32, 32, 32}, "\"no-slip\"") +
               "[gravity]\nacceleration = [0, 0, -1e-3]\n" + sphere_of("ball", 4) +
               fill_of("ball", 1, 6, "") + "[run]\nsteps = 10\n";
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

}  // namespace silt::testing
