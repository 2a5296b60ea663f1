// Drag of cubic arrays of spheres in Stokes flow against theory, for choosing wall schemes: where the spheres
// sit in the grid must not matter, how they are arranged, nor whether they move through the grid.
//
//   benchmarks walls still  --phi 0.064,0.343 --diameters 6,8 [--lattice fcc] [--offsets 8] [--set
//   key=value]... benchmarks walls moving --phi ... --diameters ... [--speed 0.005] [--boost 0.05] ...
//
// Diameters are changed slightly so that the period is a whole number of cells. `moving`: the array crosses
// the grid obliquely in a fluid at rest; with --boost both move along with that velocity besides.
#include <mpi.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <sstream>

#include "silt/simulation.hpp"
#include "tests/bench/figures.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::bench::walls {
namespace {

using rigid::Vec3;

// K = F/(6 pi mu a U) by solid fraction. Simple cubic: within 1e-6 of Zick and Homsy's (1982) digits up to
// 0.45. The others were computed by scripts/accuracy/stokes_periodic.py: the last digits given are uncertain.
const std::map<std::string, std::map<double, double>> theory = {
    {"sc",
     {{0.008, 1.524655},
      {0.027, 2.007748},
      {0.064, 2.810198},
      {0.125, 4.291589},
      {0.216, 7.441954},
      {0.343, 15.39949},
      {0.45, 28.08635}}},
    {"bcc", {{0.064, 2.889385}, {0.216, 7.73878}, {0.343, 16.335}, {0.45, 31.69}}},
    {"fcc", {{0.064, 2.888753}, {0.216, 7.757677}, {0.45, 33.48979}}}};
const std::map<std::string, std::vector<Vec3>> lattices = {
    {"sc", {Vec3(0, 0, 0)}},
    {"bcc", {Vec3(0, 0, 0), Vec3(0.5, 0.5, 0.5)}},
    {"fcc", {Vec3(0, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0.5, 0, 0.5), Vec3(0, 0.5, 0.5)}}};

struct Study {
  bool moving = false;
  std::vector<double> phi = {0.064}, diameters = {8};
  int offsets = 8;
  double speed = 0.005, boost = 0, tau = 1;
  std::string lattice = "sc";
  std::vector<std::string> overrides;
};

std::vector<double> numbers(const std::string& list) {
  std::vector<double> all;
  std::stringstream in(list);
  for (std::string s; std::getline(in, s, ',');) all.push_back(std::stod(s));
  return all;
}

Study study_of(const std::vector<std::string>& given) {
  Study o;
  if (given.empty()) throw std::invalid_argument("still or moving?");
  o.moving = given[0] == "moving";
  for (std::size_t k = 1; k + 1 < given.size(); k += 2) {
    const std::string &key = given[k], &value = given[k + 1];
    if (key == "--phi")
      o.phi = numbers(value);
    else if (key == "--diameters")
      o.diameters = numbers(value);
    else if (key == "--offsets")
      o.offsets = std::stoi(value);
    else if (key == "--speed")
      o.speed = std::stod(value);
    else if (key == "--boost")
      o.boost = std::stod(value);
    else if (key == "--lattice")
      o.lattice = value;
    else if (key == "--tau")
      o.tau = std::stod(value);
    else if (key == "--set")
      o.overrides.push_back(value);
    else
      throw std::invalid_argument("unknown option " + key);
  }
  return o;
}

struct Array {
  double phi, k;             // solid fraction, exact drag coefficient
  std::vector<Vec3> places;  // of the spheres, in periods
  int period;
  double diameter;
  Array(const std::string& lattice, double f, double d)
      : phi(f),
        k(theory.at(lattice).at(f)),
        places(lattices.at(lattice)),
        period(int(std::lround(d / std::cbrt(6 * f / M_PI / double(places.size()))))),
        diameter(period * std::cbrt(6 * f / M_PI / double(places.size()))) {}
  double solid() const { return phi * volume(); }
  double volume() const { return double(period) * period * period; }
  /// The drag of all spheres at a superficial velocity.
  double drag(double velocity, double nu) const {
    return double(places.size()) * k * 3 * M_PI * nu * diameter * velocity;
  }
  /// Acceleration of the fluid that gives a superficial velocity.
  double force(double velocity, double nu) const { return drag(velocity, nu) / volume(); }
};

std::string list(const Vec3& x) {
  char text[120];
  snprintf(text, sizeof text, "[%.12g, %.12g, %.12g]", x[0], x[1], x[2]);
  return text;
}

Simulation scene(const Array& a, const Study& o, const Vec3& offset, const Vec3& force, const Vec3& fluid,
                 const Vec3& body) {
  const std::string l = std::to_string(a.period);
  char diameter[40];
  snprintf(diameter, sizeof diameter, "%.12g", a.diameter);
  const std::string motion = body.norm() > 0 ? "\"prescribed\"\nvelocity = " + list(body) : "\"fixed\"";
  std::string bodies;
  for (const Vec3& place : a.places) {
    Vec3 centre = Vec3::Constant(a.period / 2) + offset + a.period * place;
    for (double& x : centre) x -= a.period * std::floor(x / a.period);
    bodies +=
        "\n[[bodies]]\nshape = \"sphere\"\ndensity = 1\nposition = " + list(centre) + "\nmotion = " + motion;
  }
  return silt::testing::simulation_of(
      "title = \"array\"\n[units]\nsystem = \"lattice\"\n[domain]\nsize = [" + l + ", " + l + ", " + l +
          "]\nboundary = \"periodic\"\n[fluid]\nrelaxation_time = " + std::to_string(o.tau) +
          "\nbody_force = " + list(force) + "\ninitial = { type = \"uniform\", velocity = " + list(fluid) +
          " }\n[[shapes]]\nname = \"sphere\"\ntype = \"sphere\"\ndiameter = " + diameter + bodies +
          "\n[run]\nsteps = 1\n",
      MPI_COMM_SELF, o.overrides);
}

/// Returns the force on all spheres.
Vec3 force_on(Simulation& s) {
  Vec3 sum = Vec3::Zero();
  for (const auto& load : s.last_loads()) sum += load.force;
  return sum;
}

struct Flow {
  Vec3 force, velocity;  // on the spheres without the mean pressure's; superficial, of the fluid past it
  double fluid_cells;
};
Flow look(Simulation& s, const Array& a, const Vec3& g, const Vec3& body) {
  const auto t = s.checked_totals();
  const Vec3 j(t.momentum[0], t.momentum[1], t.momentum[2]);
  const Vec3 fluid = j + 0.5 * g * double(t.fluid_cells);
  return {force_on(s), (fluid + a.solid() * body) / a.volume() - body, double(t.fluid_cells)};
}

struct Still {
  double error;     // of K from g L^3, what drives the true array
  double measured;  // of K from the force on the links and g times the sphere's volume: also sees that the
                    // number of cells the force acts on is not the true volume
};
Still still_error(const Array& a, const Study& o, const Vec3& offset) {
  const double nu = (o.tau - 0.5) / 3, u = 0.012 * nu, g = a.force(u, nu);  // Reynolds number 0.012 D
  const Vec3 force(g, 0, 0), fluid(u / (1 - a.phi), 0, 0);
  Simulation s = scene(a, o, offset, force, fluid, Vec3::Zero());
  const int chunk = std::max(100, int(0.1 * a.period * a.period / nu / 6));
  double last = 0;
  for (int n = 0; n < 100; ++n) {
    for (int t = 1; t < chunk; ++t) s.step();
    const double before = force_on(s)[0];
    s.step();
    Flow f = look(s, a, force, Vec3::Zero());
    f.force[0] = 0.5 * (f.force[0] + before);  // the start leaves a mode of period 2 that nothing damps
    const double unit = a.drag(f.velocity[0], nu);
    const double balance = f.force[0] / (g * f.fluid_cells);  // 1: steady
    const double k = balance * g * a.volume() / unit;
    if (n > 1 && std::fabs(k / last - 1) < 1e-4 && std::fabs(balance - 1) < 5e-3)
      return {k - 1, (f.force[0] + g * a.solid()) / unit - 1};
    last = k;
  }
  return {NAN, NAN};
}

struct Moving {
  double error, noise;
};
/// The sphere crosses several cells obliquely; means over time after it has settled.
Moving moving_error(const Array& a, const Study& o, const Vec3& offset) {
  const double nu = (o.tau - 0.5) / 3;
  const Vec3 direction = Vec3(1, 0.853, 0.641).normalized(), relative = o.speed * direction;
  const Vec3 frame = o.boost * Vec3(0.7, 0.513, -0.497).normalized(), body = frame - relative;
  const Vec3 force = a.force(o.speed, nu) * direction, fluid = frame + relative * (a.phi / (1 - a.phi));
  Simulation s = scene(a, o, offset, force, fluid, body);
  const int settle = int(0.25 * a.period * a.period / nu), measured = std::max(settle, int(4 / o.speed));
  for (int t = 0; t < settle; ++t) s.step();
  double drag = 0, square = 0, velocity = 0;
  for (int t = 0; t < measured; ++t) {
    s.step();
    const double f = force_on(s).dot(direction) + force.norm() * a.solid();
    drag += f, square += f * f;
    if (t % 10 == 9) velocity += 10 * look(s, a, force, body).velocity.dot(direction);
  }
  drag /= measured, velocity /= measured / 10 * 10;
  return {drag / a.drag(velocity, nu) - 1, std::sqrt(std::max(0.0, square / measured / (drag * drag) - 1))};
}

/// Evenly spread over the unit cube: the additive recurrence with the root of x^4 = x + 1.
Vec3 offset(int n) {
  const double g = 1.2207440846057596;
  Vec3 x(0.5 + n / g, 0.5 + n / (g * g), 0.5 + n / (g * g * g));
  for (int d = 0; d < 3; ++d) x[d] -= std::floor(x[d]);
  return x;
}

struct Spread {
  double sum = 0, low = 1e9, high = -1e9;
  int n = 0;
  void add(double x) { sum += x, low = std::min(low, x), high = std::max(high, x), ++n; }
  double mean() const { return 100 * sum / n; }
  double width() const { return 100 * (high - low); }
};

void report(const Array& a, const Study& o) {
  Spread error, other;
  for (int n = 1; n <= o.offsets; ++n) {
    if (o.moving) {
      const Moving m = moving_error(a, o, offset(n));
      error.add(m.error), other.add(m.noise);
    } else {
      const Still s = still_error(a, o, offset(n));
      error.add(s.error), other.add(s.measured);
    }
  }
  printf("%-3s phi %-6g D %6.3f  mean %+6.2f %%  spread %5.2f", o.lattice.c_str(), a.phi, a.diameter,
         error.mean(), error.width());
  if (o.moving)
    printf("  noise %.2f\n", other.mean());
  else
    printf("  by measured force %+6.2f  spread %5.2f\n", other.mean(), other.width());
  fflush(stdout);
}

}  // namespace

void run(const Options& options) {
  const Study o = study_of(options.others);
  for (const double d : o.diameters)
    for (const double phi : o.phi) report(Array(o.lattice, phi, d), o);
}

}  // namespace silt::bench::walls
