// The flow between close surfaces on the lattice: the force on a sphere that is made to approach a
// plate, or its equal, or to slide along a plate, so slowly that nothing moves, against Stokes flow.
//
//   benchmarks close_range wall|plate|pair|slide SCHEME DIAMETER BOX [RELAXATION_TIME] < SAMPLES
//
// BOX: edge of the periodic box in diameters. RELAXATION_TIME: 2. Samples: a line each, the normal of the gap
// and the place of its middle in its cell (three numbers each, 0: the cell's centre), gap in cells. "wall":
// the domain's, across z. Prints them with force / (6 pi mu a U) of the lattice and of theory, U the speed of
// either sphere, the gap's cells_in_gap (coupler/forces/gap_cells), and torque / (8 pi mu a^2 U) of the
// lattice and of theory.
#include <mpi.h>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "coupler/forces/gap_cells.hpp"
#include "rigid/math/types.hpp"
#include "silt/simulation.hpp"
#include "tests/bench/figures.hpp"
#include "tests/coupler/forces/approach_series.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::bench::close_range {
namespace {

using rigid::Vec3;

constexpr double speed = 1e-6;
double relaxation_time = 2, viscosity = 0.5;
int look_every = 50, most_steps = 1500;
constexpr double settled = 4e-4;  // relative change between looks
constexpr double plate_thickness = 8;

/// The flow settles in so many times more steps as it is less viscous.
void set_relaxation_time(double tau) {
  const double slower = viscosity / ((tau - 0.5) / 3);
  relaxation_time = tau, viscosity /= slower;
  look_every = static_cast<int>(look_every * slower), most_steps = static_cast<int>(most_steps * slower);
}

std::string vec(const Vec3& x) {
  return fmt::format("[{:.15g}, {:.15g}, {:.15g}]", x[0], x[1], x[2]);
}

std::string body(const Vec3& x, const Vec3& v) {
  return fmt::format(
      "[[bodies]]\nshape = \"ball\"\nposition = {}\nvelocity = {}\nmotion = \"prescribed\"\ndensity = 1\n",
      vec(x), vec(v));
}

/// Against the first body's motion along n, and about the axis m, over 6 pi mu a U and 8 pi mu a^2 U.
struct Resistance {
  double force = 0, torque = 0;
};
Resistance measure(const std::string& text, double radius, const Vec3& n, const Vec3& m, int spheres) {
  Simulation simulation = silt::testing::simulation_of(text, MPI_COMM_WORLD);
  const double scale = std::numbers::pi * viscosity * radius * speed;
  Resistance r;
  double last = 0;
  do {
    last = r.force;
    simulation.run(look_every);
    const auto loads = simulation.last_loads();
    r.force = -loads[0].force.dot(n) / (6 * scale);
    if (spheres == 2) r.force = 0.5 * (r.force + loads[1].force.dot(n) / (6 * scale));
    r.torque = loads[0].torque.dot(m) / (8 * scale * radius);
  } while (simulation.steps_done() < most_steps && std::abs(r.force - last) > settled * std::abs(r.force));
  return r;
}

std::string head(const std::string& scheme, int box, const std::string& z, double diameter) {
  return fmt::format(R"(title = "close range"
[units]
system = "lattice"
[domain]
size = [{0}, {0}, {0}]
boundary = {{ x = "periodic", y = "periodic", z = "{1}" }}
[fluid]
relaxation_time = {2}
precision = "double"
[coupling]
lubrication = false
wall_scheme = "{3}"
[[shapes]]
name = "ball"
type = "sphere"
diameter = {4}
[[shapes]]
name = "plate"
type = "box"
edges = [{5}, {5}, {6}]
[run]
steps = 1
)",
                     box, z, relaxation_time, scheme, diameter, 0.8 * box, plate_thickness);
}

/// Returns a plate with its upper face through x, normal to n.
std::string plate(const Vec3& x, const Vec3& n) {
  const rigid::Quat q = rigid::rotation_between(Vec3::UnitZ(), n);
  return fmt::format(
      "[[bodies]]\nshape = \"plate\"\nposition = {}\norientation = [{:.15g}, {:.15g}, {:.15g}, {:.15g}]\n"
      "motion = \"fixed\"\ndensity = 1\n",
      vec(x - 0.5 * plate_thickness * n), q.w(), q.x(), q.y(), q.z());
}

struct Approach {
  Vec3 direction, offset;
  double gap;
};

Vec3 middle_of(const std::string& kind, const Approach& s, int box) {
  Vec3 middle = Vec3::Constant(std::floor(0.5 * box) + 0.5) + s.offset;
  if (kind == "wall") middle[2] = 0.5 * s.gap;
  return middle;
}

/// Returns the cells in the gap, from the sphere to what it approaches.
double cells(const std::string& kind, const Approach& s, double radius, int box) {
  const Vec3 n = s.direction.normalized();
  const rigid::Mat3 curvature = (rigid::Mat3::Identity() - n * n.transpose()) / radius;
  const rigid::Mat3 other = kind == "pair" ? curvature : rigid::Mat3(rigid::Mat3::Zero());
  return coupler::cells_in_gap({s.gap, 0, curvature, other, middle_of(kind, s, box), n});
}

Vec3 along(const Vec3& n) {
  int smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  return n.cross(Vec3::Unit(smallest)).normalized();
}

std::string bodies(const std::string& kind, const Approach& s, double radius, int box) {
  const Vec3 n = s.direction.normalized(), middle = middle_of(kind, s, box);
  const std::string ball =
      body(middle - (radius + 0.5 * s.gap) * n, speed * (kind == "slide" ? along(n) : n));
  if (kind == "wall") return ball;
  if (kind == "plate" || kind == "slide") return ball + plate(middle + 0.5 * s.gap * n, -n);
  return ball + body(middle + (radius + 0.5 * s.gap) * n, -speed * n);
}

/// Returns the sphere's force and torque by theory.
Resistance exact(const std::string& kind, double gap, double radius) {
  if (kind == "pair") return {silt::testing::approach_of_two(1 + 0.5 * gap / radius), 0};
  if (kind == "slide")
    return {silt::testing::slide_force(gap / radius), silt::testing::slide_torque(gap / radius)};
  return {silt::testing::approach_to_wall(1 + gap / radius), 0};
}

}  // namespace

void run(const Options& options) {
  const auto& given = options.others;
  if (given.size() != 4 && given.size() != 5)
    throw std::invalid_argument(
        "usage: benchmarks close_range wall|plate|pair|slide SCHEME DIAMETER BOX [RELAXATION_TIME] < "
        "SAMPLES");
  if (given.size() == 5) set_relaxation_time(std::stod(given[4]));
  const std::string kind = given[0], scheme = given[1];
  const double diameter = std::stod(given[2]), radius = diameter / 2;
  const int box = static_cast<int>(std::round(std::stod(given[3]) * diameter));
  const std::string start = head(scheme, box, kind == "wall" ? "no-slip" : "periodic", diameter);
  Approach s;
  while (std::cin >> s.direction[0] >> s.direction[1] >> s.direction[2] >> s.offset[0] >> s.offset[1] >>
         s.offset[2] >> s.gap) {
    if (kind == "wall") s.direction = -Vec3::UnitZ();
    const Vec3 n = s.direction.normalized(), t = kind == "slide" ? along(n) : n;
    const Resistance r =
        measure(start + bodies(kind, s, radius, box), radius, t, t.cross(n), kind == "pair" ? 2 : 1);
    const Resistance theory = exact(kind, s.gap, radius);
    std::cout << fmt::format("{} {} {} {} {} {} {} {} {} {} {:.5f} {:.5f} {:.6f} {:.5f} {:.5f}", kind, scheme,
                             diameter, s.direction[0], s.direction[1], s.direction[2], s.offset[0],
                             s.offset[1], s.offset[2], s.gap, r.force, theory.force,
                             cells(kind, s, radius, box), r.torque, theory.torque)
              << std::endl;
  }
}

}  // namespace silt::bench::close_range
