// Reading: what stands in a case file arrives in the Case, in lattice units.
#include <gtest/gtest.h>

#include <numbers>

#include "rigid/shapes/shape.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_file.hpp"
#include "tests/errors.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::testing {
namespace {

using rigid::Vec3;

TEST(CaseFile, ConvertsSiToLatticeUnits) {
  CaseText c = si_case();
  c.fluid += "body_force = [0.5, 0, 0]\n";
  c.rest = "[gravity]\nacceleration = [0, 0, -9.81]\n";
  c.bodies += "velocity = [0, 0, 0.002]\nangular_velocity = [0.1, 0, 0]\n";
  const Case setup = c.read();
  EXPECT_EQ(setup.cells, (std::array<int, 3>{32, 32, 32}));
  ASSERT_TRUE(setup.fluid);
  EXPECT_NEAR(setup.fluid->kinematic_viscosity, 1e-5 * 1e-2 / 1e-6, 1e-15);
  EXPECT_NEAR(setup.fluid->relaxation_time, 0.8, 1e-15);
  EXPECT_NEAR(setup.fluid->body_force[0], 0.5 * 1e-4 / 1e-3, 1e-15);
  EXPECT_NEAR(setup.gravity[2], -9.81 * 1e-4 / 1e-3, 1e-14);
  ASSERT_EQ(setup.bodies.size(), 1u);
  EXPECT_NEAR(setup.bodies[0].density, 1.2, 1e-15);
  EXPECT_NEAR(setup.bodies[0].pose.position[1], 16, 1e-12);
  EXPECT_NEAR(setup.bodies[0].velocity[2], 0.02, 1e-15);
  EXPECT_NEAR(setup.bodies[0].angular_velocity[0], 1e-3, 1e-17);
  EXPECT_NEAR(std::get<rigid::Sphere>(setup.shapes[0]).radius, 4, 1e-12);
}

TEST(CaseFile, UnitsThereAndBack) {
  Units units;
  units.cell_size = 2.5e-4;
  units.time_step = 5e-4;
  units.density = 960;
  for (const Dimension d :
       {dimension::length, dimension::time, dimension::velocity, dimension::acceleration,
        dimension::viscosity, dimension::density, dimension::mass, dimension::force, dimension::torque,
        dimension::angular_velocity, dimension::energy, dimension::pressure})
    EXPECT_NEAR(units.lattice(units.physical(0.37, d), d), 0.37, 1e-15);
  EXPECT_NEAR(units.physical(1, dimension::velocity), 0.5, 1e-15);
  EXPECT_NEAR(units.physical(1, dimension::pressure), 960 * 0.25, 1e-9);
  EXPECT_NEAR(units.physical(1, dimension::force), 960 * 0.25 * 6.25e-8, 1e-15);
}

TEST(CaseFile, TimeStepFromRelaxationTimeOrLargestVelocity) {
  CaseText c = si_case();
  c.units = "[units]\nsystem = \"si\"\ncell_size = 1e-3\nrelaxation_time = 0.8\n";
  EXPECT_NEAR(c.read().units.time_step, 0.1 * 1e-6 / 1e-5, 1e-15);
  EXPECT_NEAR(c.read().fluid->relaxation_time, 0.8, 1e-14);
  c.fluid = "[fluid]\ndensity = 1000\ndynamic_viscosity = 1e-2\n";
  EXPECT_NEAR(c.read().units.time_step, 0.1 * 1e-6 / 1e-5, 1e-15);
  EXPECT_NEAR(c.read().fluid->kinematic_viscosity, 0.1, 1e-14);
  c.units = "[units]\nsystem = \"si\"\ncell_size = 1e-3\nmax_velocity = 0.1\n";
  EXPECT_NEAR(c.read().units.lattice(0.1, dimension::velocity), 0.05, 1e-15);
}

TEST(CaseFile, PlacesOnASideMayBeBeyondItByRounding) {
  ASSERT_GT(0.006 / 3e-4, 20);
  CaseText c = si_case();
  c.units = "[units]\nsystem = \"si\"\ncell_size = 3e-4\ntime_step = 1e-3\n";
  c.domain = "[domain]\nsize = [0.006, 0.006, 0.006]\nboundary = \"no-slip\"\n";
  c.shapes = shape_of("ball", "sphere", "radius = 1e-3");
  c.bodies = body_of("ball", 1200, "position = [0.003, 0.003, 0.003]");
  const std::string box = "box = [[0, 0, 0], [0.006, 0.006, 0.006]]\n";
  c.rest = "[coarsening]\nlevels = 1\n[[coarsening.fine]]\n" + box + "[[outflow]]\n" + box +
           "[[quantities]]\nname = \"number\"\ntype = \"body-count\"\n" + box +
           "[[quantities]]\nname = \"flow\"\ntype = \"flow-rate\"\naxis = \"z\"\nat = 0.006\n"
           "[[output.probes]]\nname = \"corner\"\npoints = [[0.006, 0.006, 0.006]]\nevery = 2\n"
           "[[output.slices]]\nname = \"side\"\nbox = [[0, 0, 0.006], [0.006, 0.006, 0.006]]\nevery = 2\n";
  EXPECT_EQ(c.fault(), "");
  const Case setup = c.read();
  const Vec3 corner(20, 20, 20);
  EXPECT_EQ(setup.coarsening->fine[0].box.upper, corner);
  EXPECT_EQ(setup.outflows[0].box.upper, corner);
  EXPECT_EQ(setup.quantities[0].box.upper, corner);
  EXPECT_EQ(setup.quantities[1].height, 20);
  EXPECT_EQ(setup.output.probes[0].points[0], corner);
  EXPECT_EQ(setup.output.slices[0].upper[2], 20);
  EXPECT_TEXT(c.fault({"quantities[1].at=0.00600002"}), "must lie in the domain");
}

TEST(CaseFile, RevolutionsAMinute) {
  CaseText c = si_case();
  c.rest = "[[walls]]\ntype = \"tube\"\nradius = 15e-3\naxis = \"z\"\npoint = [0.016, 0.016, 0]\nrpm = 30\n";
  c.bodies += "motion = { rpm = -60, axis = \"x\" }\n";
  const Case setup = c.read();
  const double turn = 2 * std::numbers::pi * 1e-2;  // a second in radian a step
  EXPECT_NEAR(std::get<rigid::TubeWallSpec>(setup.walls.at(0).surface).angular_velocity, 0.5 * turn, 1e-16);
  EXPECT_NEAR(setup.kind_motions.at(0).angular_velocity[0], -turn, 1e-16);
}

TEST(CaseFile, BoundariesInEveryForm) {
  CaseText c;
  c.domain = R"([domain]
size = [32, 32, 32]
blocks = [16, 8, 32]
boundary.x = [{ type = "velocity-inlet", velocity = [0.02, 0, 0] }, { type = "pressure-outlet", pressure = 0.003 }]
boundary.y = ["free-slip", { type = "moving", velocity = [0, 0, 0.01], solid_for_bodies = false }]
boundary.z = "periodic"
)";
  const Case setup = c.read();
  EXPECT_EQ(setup.boundary[0].kind, coupler::BoundaryKind::velocity_inlet);
  EXPECT_EQ(setup.boundary[0].velocity, Vec3(0.02, 0, 0));
  EXPECT_EQ(setup.boundary[1].kind, coupler::BoundaryKind::pressure_outlet);
  EXPECT_EQ(setup.boundary[1].pressure, 0.003);
  EXPECT_EQ(setup.boundary[2].kind, coupler::BoundaryKind::free_slip);
  EXPECT_TRUE(setup.boundary[2].solid_for_bodies);
  EXPECT_EQ(setup.boundary[3].kind, coupler::BoundaryKind::moving);
  EXPECT_FALSE(setup.boundary[3].solid_for_bodies);
  EXPECT_TRUE(setup.periodic(2));
  EXPECT_EQ(setup.block_cells, (std::array<int, 3>{16, 8, 32}));
  c.domain = "[domain]\nsize = [32, 32, 32]\nboundary = \"no-slip\"\n";
  for (const coupler::BoundarySpec& side : c.read().boundary)
    EXPECT_EQ(side.kind, coupler::BoundaryKind::no_slip);
}

TEST(CaseFile, ShapesAndOrientations) {
  CaseText c;
  c.shapes += R"([[shapes]]
name = "rod"
type = "capsule"
radius = 3
length = 6
[[shapes]]
name = "star"
type = "compound"
parts = [
  { type = "capsule", radius = 2, length = 6, orientation = [1, 0, 0] },
  { type = "sphere", diameter = 7, position = [1, 2, 3] },
  { type = "box", edges = [2, 4, 6], orientation = [0, 0, 0, 2] },
]
)";
  c.bodies = R"([[bodies]]
name = "turned"
shape = "rod"
density = 2
orientation = { axis = [0, 2, 0], degrees = 90 }
positions = [[8, 8, 16], [24, 24, 16]]
motion = "prescribed"
)";
  const Case setup = c.read();
  const auto& rod = std::get<rigid::Capsule>(setup.shapes[1]);
  EXPECT_EQ(rod.radius, 3);
  EXPECT_EQ(rod.half_length, 3);
  const auto& star = std::get<rigid::Compound>(setup.shapes[2]);
  ASSERT_EQ(star.parts.size(), 3u);
  EXPECT_NEAR((star.parts[0].pose.orientation * Vec3::UnitZ() - Vec3::UnitX()).norm(), 0, 1e-15);
  EXPECT_EQ(std::get<rigid::Sphere>(star.parts[1].shape).radius, 3.5);
  EXPECT_NEAR((star.parts[1].pose.position - setup.shape_origins[2] - Vec3(1, 2, 3)).norm(), 0, 1e-14);
  EXPECT_NEAR(rigid::mass_properties(star).centre.norm(), 0, 1e-4) << "about its centre of mass";
  EXPECT_EQ(std::get<rigid::Box>(star.parts[2].shape).half_edges, Vec3(1, 2, 3));
  EXPECT_EQ(star.parts[2].pose.orientation.z(), 1);
  ASSERT_EQ(setup.bodies.size(), 2u);
  EXPECT_EQ(setup.bodies[1].pose.position, Vec3(24, 24, 16));
  EXPECT_EQ(setup.bodies[1].motion, rigid::Motion::prescribed);
  EXPECT_NEAR((setup.bodies[0].pose.orientation * Vec3::UnitZ() - Vec3::UnitX()).norm(), 0, 1e-15);
  EXPECT_EQ(setup.kind_names, std::vector<std::string>{"turned"});
}

TEST(CaseFile, CylindersEllipsoidsAndPolyhedra) {
  CaseText c = si_case();
  c.shapes = R"([[shapes]]
name = "ball"
type = "compound"
parts = [
  { type = "cylinder", diameter = 6e-3, length = 8e-3, orientation = [1, 0, 0] },
  { type = "ellipsoid", diameters = [6e-3, 8e-3, 10e-3], position = [1e-3, 0, 0] },
  { type = "polyhedron", vertices = [[0, 0, 0], [6e-3, 0, 0], [0, 6e-3, 0], [0, 0, 6e-3]] },
]
)";
  const Case setup = c.read();
  const auto& parts = std::get<rigid::Compound>(setup.shapes[0]).parts;
  EXPECT_NEAR(std::get<rigid::Cylinder>(parts[0].shape).radius, 3, 1e-12);
  EXPECT_NEAR(std::get<rigid::Cylinder>(parts[0].shape).half_length, 4, 1e-12);
  EXPECT_NEAR((std::get<rigid::Ellipsoid>(parts[1].shape).half_axes - Vec3(3, 4, 5)).norm(), 0, 1e-12);
  const auto& mesh = *std::get<rigid::Polyhedron>(parts[2].shape).mesh;
  EXPECT_EQ(mesh.faces.size(), 4u);
  EXPECT_NEAR((mesh.vertices[3] - Vec3(0, 0, 6)).norm(), 0, 1e-12);
}

TEST(CaseFile, BodiesFromStlFilesBesideTheCase) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "silt_stl_case";
  std::filesystem::create_directories(folder / "rocks");
  CaseText c = si_case();
  c.shapes = "[[shapes]]\nname = \"ball\"\ntype = \"polyhedron\"\nfile = \"rocks/a.stl\"\nscale = 1e-3\n";
  std::ofstream(folder / "case.toml") << c.text();
  const auto write = [&](const char* last_corner) {
    std::ofstream file(folder / "rocks/a.stl");
    file << "solid a\n";
    for (const char* corners : {"0 0 0 vertex 0 6 0 vertex 6 0 0", "0 0 0 vertex 6 0 0 vertex 0 0 6",
                                "6 0 0 vertex 0 6 0 vertex 0 0 6"})
      file << "facet normal 0 0 0 outer loop vertex " << corners << " endloop endfacet\n";
    file << "facet normal 0 0 0 outer loop vertex 0 6 0 vertex 0 0 0 vertex " << last_corner
         << " endloop endfacet\nendsolid a\n";
  };
  write("0 0 6");
  const Case setup = read_case(folder);
  EXPECT_NEAR(rigid::mass_properties(setup.shapes[0]).volume, 36, 1e-9) << "millimetres, in cells of one";
  ASSERT_EQ(setup.files.size(), 1u);
  EXPECT_TRUE(setup.files[0].starts_with("rocks/a.stl: ")) << setup.files[0];
  write("0 0 5");
  EXPECT_TEXT(error_of([&] { read_case(folder); }),
              "case.toml:14:1: shapes[0].file: 'rocks/a.stl': the surface is not closed: it ends at 4 edges");
  std::filesystem::remove_all(folder);
}

TEST(CaseFile, MaterialsContactsCouplingAndOutput) {
  CaseText c;
  c.rest = R"([coupling]
wall_scheme = "bounce-back"
time = "explicit"
force = "exact"
[contacts]
backend = "fcl"
resolver = "ffd"
restitution = 0.9
friction = 0.3
sweeps = 8
substeps = 4
margin = 0.5
[[material_pairs]]
between = ["steel", "rubber"]
friction = 0.8
[output]
fields = { every = 10, quantities = ["velocity"] }
bodies = { every = 5 }
checkpoint = { every = 50, keep = 3 }
report = { every = 20 }
[[quantities]]
name = "height"
type = "mean-height"
body = "ball"
axis = "x"
)";
  c.bodies += "material = \"rubber\"\n";
  const Case setup = c.read();
  EXPECT_EQ(setup.coupling.wall_scheme, coupler::WallScheme::bounce_back);
  EXPECT_EQ(setup.coupling.time, coupler::TimeCoupling::explicit_);
  EXPECT_EQ(setup.coupling.force, coupler::ForceForm::exact);
  EXPECT_EQ(setup.contacts.backend, "fcl");
  EXPECT_EQ(setup.contacts.resolver, "ffd");
  EXPECT_EQ(setup.contacts.resolver_settings.max_sweeps, 8);
  EXPECT_EQ(setup.contacts.substeps, 4);
  EXPECT_EQ(setup.contacts.margin, 0.5);
  EXPECT_EQ(setup.material_names, (std::vector<std::string>{"default", "steel", "rubber"}));
  ASSERT_EQ(setup.pair_materials.size(), 9u);
  EXPECT_EQ(setup.pair_materials[1 * 3 + 2].friction, 0.8);
  EXPECT_EQ(setup.pair_materials[2 * 3 + 1].friction, 0.8);
  EXPECT_EQ(setup.pair_materials[2 * 3 + 1].restitution, 0.9);
  EXPECT_EQ(setup.pair_materials[0].friction, 0.3);
  EXPECT_EQ(setup.bodies[0].material, 2);
  EXPECT_EQ(setup.output.fields.every, 10);
  EXPECT_EQ(setup.output.fields.quantities, (std::vector{Field::velocity, Field::solid}));
  EXPECT_EQ(setup.output.keep_checkpoints, 3);
  ASSERT_EQ(setup.quantities.size(), 1u);
  EXPECT_EQ(setup.quantities[0].axis, 0);
  EXPECT_EQ(setup.quantities[0].kind, 0);
}

TEST(CaseFile, RemembersWhereKeysStand) {
  const Case setup = CaseText{}.read();
  EXPECT_EQ(setup.place("domain.size").text(), "case.toml:4:1");
  EXPECT_EQ(setup.place("bodies[0].position").text(), "case.toml:15:1");
  EXPECT_EQ(setup.place("bodies[0].velocity").text(), "case.toml:12:1") << "not there: its table";
}

TEST(CaseFile, OverridesReplaceAddAndDisplace) {
  CaseText c;
  const Case setup =
      c.read({"fluid.relaxation_time=0.9", "contacts.backend=bullet", "contacts.resolver=\"ffd\"",
              "bodies[0].position=[8, 8, 8]", "domain.blocks=[8,8,8]", "run.time=7"});
  EXPECT_EQ(setup.fluid->relaxation_time, 0.9);
  EXPECT_EQ(setup.contacts.backend, "bullet");
  EXPECT_EQ(setup.contacts.resolver, "ffd");
  EXPECT_EQ(setup.bodies[0].pose.position, Vec3(8, 8, 8));
  EXPECT_EQ(setup.block_cells, (std::array<int, 3>{8, 8, 8}));
  EXPECT_EQ(setup.steps, 7) << "run.time takes the place of run.steps";
  EXPECT_TEXT(setup.text, "# --set run.time=7");
  EXPECT_EQ(setup.text.find(c.text()), 0u);
}

TEST(CaseFile, EntriesOfOneNameMakeOneKind) {
  CaseText c;
  c.bodies +=
      "[[bodies]]\nshape = \"ball\"\ndensity = 2\nposition = [16, 16, 26]\n[[fill]]\nname = \"more\"\n"
      "shape = \"ball\"\ndensity = 2\ncount = 3\n";
  const Case setup = c.read();
  EXPECT_EQ(setup.kind_names, (std::vector<std::string>{"ball", "more"}));
  EXPECT_EQ(setup.bodies[1].kind, 0);
  EXPECT_EQ(setup.bodies[1].entry, 1);
  EXPECT_EQ(setup.fills[0].kind, 1);
}

TEST(ShippedCases, AllAreReadAndRunnableWithoutWarnings) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(SILT_SOURCE_DIR) / "cases")) {
    if (!std::filesystem::exists(entry.path() / "case.toml")) continue;
    SCOPED_TRACE(entry.path().string());
    ++count;
    const Case setup = read_case(entry.path());
    EXPECT_EQ(listed(judgement(setup)), "");
    EXPECT_FALSE(setup.title.empty());
    EXPECT_TEXT(derived_table(setup), "cells");
    EXPECT_TRUE(std::filesystem::exists(entry.path() / "README.md"));
    const std::string reference = file_text(entry.path() / "reference.toml");
    for (const QuantitySpec& quantity : setup.quantities)
      EXPECT_TEXT(reference, '"' + quantity.name + '"') << quantity.name << " has no reference";
  }
  EXPECT_GE(count, 9);
}

TEST(CaseFile, CellsAreFinestHalfTheLargestBodyAwayUnlessACaseSaysOtherwise) {
  CaseText c;
  c.rest = "[coarsening]\nlevels = 2\n[[coarsening.fine]]\nbox = [[0, 0, 0], [8, 8, 8]]\n";
  EXPECT_EQ(c.read().coarsening->distance, 8);
  EXPECT_EQ(c.read({"coarsening.distance=10.5"}).coarsening->distance, 10.5);
  c.shapes = shape_of("ball", "sphere", "radius = 12.5");
  const coupler::CoarseningSpec spec = *c.read().coarsening;
  EXPECT_EQ(spec.distance, 13);
  EXPECT_EQ(spec.fine[0].box.upper, rigid::Vec3(8, 8, 8));
  c = si_case();
  c.rest = "[coarsening]\nlevels = 1\ndistance = 0.01\n";
  EXPECT_NEAR(c.read().coarsening->distance, 10, 1e-12);
}

}  // namespace
}  // namespace silt::testing
