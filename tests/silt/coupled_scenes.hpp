#pragma once
// Scenes shared by the tests of the coupled step, as case text.
#include "tests/silt/case/case_text.hpp"

namespace silt::testing {

/// A small box stirred by gravity and given velocities: spheres, stars and boxes that touch each other and
/// the walls, cross the borders of blocks and the periodic sides, cover and uncover cells.
inline CaseText crowd() {
  CaseText c;
  c.domain = domain_of({24, 20, 28}, R"({ x = "periodic", y = "periodic", z = ["no-slip", "free-slip"] })");
  c.rest = R"([gravity]
acceleration = [4e-4, 2e-4, -1e-3]
[contacts]
restitution = 0.5
friction = 0.3
)";
  c.shapes = sphere_of("sphere", 6) +
             shape_of("star", "compound",
                      "parts = [ { type = \"capsule\", radius = 1.4, length = 4, orientation = [1, 0, 0] },\n"
                      "{ type = \"capsule\", radius = 1.4, length = 4, orientation = [0, 1, 0] },\n"
                      "{ type = \"capsule\", radius = 1.4, length = 4, orientation = [0, 0, 1] } ]") +
             shape_of("box", "box", "edges = [5, 6, 4]");
  c.bodies = fill_of("sphere", 0.7, 6, "seed = 1") + fill_of("star", 3, 4, "seed = 2") +
             fill_of("box", 4, 4, "seed = 3");
  return c;
}

/// Spheres in a periodic box, flying through each other's wakes: nothing outside that could take momentum.
inline CaseText free_spheres() {
  CaseText c;
  c.domain = domain_of({24, 24, 24});
  c.fluid += "precision = \"double\"\n";
  c.rest = R"([coupling]
force = "exact"
[contacts]
restitution = 1.0
friction = 0.0
)";
  c.shapes = sphere_of("sphere", 7);
  c.bodies = body_of("sphere", 2,
                     "position = [5.2, 6.1, 7.3]\nvelocity = [0.03, 0.01, 0.0]\n"
                     "angular_velocity = [0, 0, 0.004]") +
             body_of("sphere", 3, "position = [17.4, 6.9, 7.9]\nvelocity = [-0.02, 0.0, 0.005]") +
             body_of("sphere", 1.5, "position = [11.4, 17.3, 16.2]\nvelocity = [0.01, -0.02, -0.01]");
  return c;
}

/// The simple cubic array of spheres, phi = 0.064: the cells an edge, the diameter and the body force.
inline constexpr double array_edge = 16, array_diameter = 7.94048, array_force = 1e-6;

/// One fixed sphere in a periodic cube, driven by a body force along x.
inline CaseText sphere_array() {
  CaseText c;
  c.domain = domain_of({16, 16, 16});
  c.fluid = "[fluid]\nrelaxation_time = 1.0\nprecision = \"double\"\nbody_force = [1e-6, 0, 0]\n";
  c.shapes = sphere_of("sphere", array_diameter);
  c.bodies = body_of("sphere", 1, "motion = \"fixed\"\nposition = [8, 8, 8]");
  return c;
}

/// Spheres at rest on the floor of a closed box and on each other, pockets of fluid between them and the
/// walls; the fluid is stirred once, at the start.
inline CaseText heap() {
  CaseText c;
  c.domain = domain_of({25, 25, 20}, "\"no-slip\"");
  c.fluid = R"([fluid]
relaxation_time = 0.9
initial = { type = "uniform", velocity = [0.01, 0.005, -0.01] }
)";
  c.rest = R"([gravity]
acceleration = [0, 0, -0.01]
[contacts]
restitution = 0.3
friction = 0.2
)";
  c.shapes = sphere_of("sphere", 8);
  c.bodies = body_of("sphere", 1.2, R"(
positions = [[4.02, 4.03, 4.01], [12.03, 4.02, 4.02], [4.05, 12.04, 4.02], [12.04, 12.06, 4.03],
             [20.07, 4.04, 4.05], [20.06, 12.05, 4.01], [8.05, 8.03, 9.7], [16.05, 8.06, 9.71],
             [4.03, 20.06, 4.03], [12.06, 20.07, 4.04], [20.8, 20.8, 4.06], [8.02, 16.05, 9.71]])");
  return c;
}

}  // namespace silt::testing
