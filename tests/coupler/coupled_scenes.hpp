#pragma once
// Scenes shared by the tests of the coupled step, as case text.
#include <string>

#include "coupler/case/case_file.hpp"
#include "coupler/simulation.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

/// A small box stirred by gravity and given velocities: spheres, stars and boxes that touch each other and
/// the walls, cross the borders of blocks and the periodic sides, cover and uncover cells.
inline Case crowd(const std::vector<std::string>& overrides = {}) {
  return read_case_text(R"(
title = "crowd"
[units]
system = "lattice"
[domain]
size = [24, 20, 28]
boundary = { x = "periodic", y = "periodic", z = ["no-slip", "free-slip"] }
[fluid]
relaxation_time = 0.8
[gravity]
acceleration = [4e-4, 2e-4, -1e-3]
[contacts]
restitution = 0.5
friction = 0.3
[[shapes]]
name = "sphere"
type = "sphere"
diameter = 6
[[shapes]]
name = "star"
type = "compound"
parts = [ { type = "capsule", radius = 1.4, length = 4, axis = [1, 0, 0] },
          { type = "capsule", radius = 1.4, length = 4, axis = [0, 1, 0] },
          { type = "capsule", radius = 1.4, length = 4, axis = [0, 0, 1] } ]
[[shapes]]
name = "box"
type = "box"
edges = [5, 6, 4]
[[fill]]
name = "light"
shape = "sphere"
density = 0.7
count = 6
seed = 1
[[fill]]
name = "stars"
shape = "star"
density = 3
count = 4
seed = 2
[[fill]]
name = "boxes"
shape = "box"
density = 4
count = 4
seed = 3
[run]
steps = 600
)",
                        "crowd", overrides);
}

/// Spheres in a periodic box, flying through each other's wakes: nothing outside that could take momentum.
inline Case free_spheres(const std::vector<std::string>& overrides = {}) {
  return read_case_text(R"(
title = "free spheres"
[units]
system = "lattice"
[domain]
size = [24, 24, 24]
boundary = "periodic"
[fluid]
relaxation_time = 0.8
precision = "double"
[coupling]
force = "exact"
mass_correction = false
[contacts]
restitution = 1.0
friction = 0.0
[[shapes]]
name = "sphere"
type = "sphere"
diameter = 7
[[bodies]]
shape = "sphere"
density = 2
position = [5.2, 6.1, 7.3]
velocity = [0.03, 0.01, 0.0]
angular_velocity = [0, 0, 0.004]
[[bodies]]
shape = "sphere"
density = 3
position = [17.4, 6.9, 7.9]
velocity = [-0.02, 0.0, 0.005]
[[bodies]]
shape = "sphere"
density = 1.5
position = [11.4, 17.3, 16.2]
velocity = [0.01, -0.02, -0.01]
[run]
steps = 1000
)",
                        "free", overrides);
}

/// One fixed sphere in a periodic cube, driven by a body force: the simple cubic array, phi = 0.064, D
/// = 7.94.
inline Case sphere_array(const std::vector<std::string>& overrides = {}) {
  return read_case_text(R"(
title = "array"
[units]
system = "lattice"
[domain]
size = [16, 16, 16]
boundary = "periodic"
[fluid]
relaxation_time = 1.0
precision = "double"
body_force = [1e-6, 0, 0]
[[shapes]]
name = "sphere"
type = "sphere"
diameter = 7.94048
[[bodies]]
shape = "sphere"
density = 1
motion = "fixed"
position = [8, 8, 8]
[run]
steps = 2500
)",
                        "array", overrides);
}

/// Spheres at rest on the floor of a closed box and on each other, pockets of fluid between them and the
/// walls; the fluid is stirred once, at the start.
inline Case heap(const std::vector<std::string>& overrides = {}) {
  return read_case_text(R"(
title = "heap"
[units]
system = "lattice"
[domain]
size = [25, 25, 20]
boundary = "no-slip"
[fluid]
relaxation_time = 0.9
initial = { type = "uniform", velocity = [0.01, 0.005, -0.01] }
[gravity]
acceleration = [0, 0, -0.01]
[contacts]
restitution = 0.3
friction = 0.2
[[shapes]]
name = "sphere"
type = "sphere"
diameter = 8
[[bodies]]
shape = "sphere"
density = 1.2
positions = [[4.02, 4.03, 4.01], [12.03, 4.02, 4.02], [4.05, 12.04, 4.02], [12.04, 12.06, 4.03],
             [20.07, 4.04, 4.05], [20.06, 12.05, 4.01], [8.05, 8.03, 9.7], [16.05, 8.06, 9.71],
             [4.03, 20.06, 4.03], [12.06, 20.07, 4.04], [20.8, 20.8, 4.06], [8.02, 16.05, 9.71]]
[run]
steps = 4000
)",
                        "heap", overrides);
}

/// F / (6 pi mu a U), F: wall force + body force on the sphere's volume, U: mean over the whole cube.
inline double drag_coefficient(const Case& scene, MPI_Comm comm) {
  Simulation s(scene, comm);
  while (s.steps_done() < scene.steps) s.step();
  double force = 0, all = 0;
  for (const auto& load : s.last_loads()) force += load.force[0];
  MPI_Allreduce(&force, &all, 1, MPI_DOUBLE, MPI_SUM, comm);
  const FlowTotals t = s.look_at_flow();
  const double a = std::get<rigid::Sphere>(scene.shapes[0]).radius, g = scene.fluid->body_force[0];
  const double cells = double(scene.cells[0]) * scene.cells[1] * scene.cells[2];
  const double u = (t.momentum[0] + 0.5 * g * double(t.fluid_cells)) / cells;
  return (all + g * 4 * M_PI / 3 * a * a * a) / (6 * M_PI * scene.fluid->kinematic_viscosity * a * u);
}

}  // namespace silt::coupler
