#include <cmath>
#include <numbers>
#include <vector>

#include "coupler/fluid_fields.hpp"
#include "coupler/spec/counter_random.hpp"
#include "coupler/spec/flow_spec.hpp"
#include "lbm/fluid.hpp"
#include "rigid/math/elementary.hpp"

namespace silt::coupler {

using std::numbers::pi;

namespace {

namespace elementary = rigid::elementary;

/// The flow at a point, lattice units.
struct Local {
  double density_deviation = 0;
  rigid::Vec3 velocity = rigid::Vec3::Zero();
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;  // strain rate
};

/// The two-dimensional Taylor-Green vortex in the x-y plane, one wave a period:
///   u = A (-cos kx x sin ky y,  kx/ky sin kx x cos ky y),  p = -A^2/4 (cos 2 kx x + (kx/ky)^2 cos 2 ky y).
struct TaylorGreen {
  double amplitude, kx, ky;
  explicit TaylorGreen(const FlowSpec& spec)
      : amplitude(spec.fluid->initial.velocity.norm()),
        kx(2 * pi / spec.cells[0]),
        ky(2 * pi / spec.cells[1]) {}
};

Local at(const TaylorGreen& vortex, const rigid::Vec3& x) {
  const auto [a, kx, ky] = vortex;
  const double sx = elementary::sin(kx * x[0]), cx = elementary::cos(kx * x[0]),
               sy = elementary::sin(ky * x[1]), cy = elementary::cos(ky * x[1]), ratio = kx / ky;
  const double xx = a * kx * sx * sy;
  return {-0.75 * a * a * (elementary::cos(2 * kx * x[0]) + ratio * ratio * elementary::cos(2 * ky * x[1])),
          {-a * cx * sy, a * kx / ky * sx * cy, 0},
          xx,
          -xx,
          0,
          0.5 * a * (-ky + kx * kx / ky) * (cx * cy),
          0,
          0};
}

struct Uniform {
  rigid::Vec3 velocity;
  explicit Uniform(const FlowSpec& spec) : velocity(spec.fluid->initial.velocity) {}
};
Local at(const Uniform& stream, const rigid::Vec3&) {
  return {0, stream.velocity};
}

/// Taylor, Green, Proc. R. Soc. A 158 (1937) 499, in a cube:
///   u = A (sin kx cos ky cos kz, -cos kx sin ky cos kz, 0),  p = A^2/16 (cos 2kx + cos 2ky)(cos 2kz + 2).
struct TaylorGreen3D {
  double amplitude, k;
  explicit TaylorGreen3D(const FlowSpec& spec)
      : amplitude(spec.fluid->initial.velocity.norm()), k(2 * pi / spec.cells[0]) {}
};

Local at(const TaylorGreen3D& vortex, const rigid::Vec3& x) {
  const double a = vortex.amplitude, k = vortex.k;
  const double sx = elementary::sin(k * x[0]), cx = elementary::cos(k * x[0]), sy = elementary::sin(k * x[1]),
               cy = elementary::cos(k * x[1]);
  const double sz = elementary::sin(k * x[2]), cz = elementary::cos(k * x[2]), stretch = a * k * cx * cy * cz;
  const double pressure = a * a / 16 * (elementary::cos(2 * k * x[0]) + elementary::cos(2 * k * x[1])) *
                          (elementary::cos(2 * k * x[2]) + 2);
  return {3 * pressure,
          {a * sx * cy * cz, -a * cx * sy * cz, 0},
          stretch,
          -stretch,
          0,
          0,
          -0.5 * a * k * sx * cy * sz,
          0.5 * a * k * cx * sy * sz};
}

/// Two shear layers along x that a wave across them rolls up (Minion, Brown, J. Comput. Phys. 138 (1997)
/// 734), with lengths in units of the period in y:
///   u = A tanh(s (1/4 - |y - 1/2|)),  v = A p sin(2 pi (x + 1/4)).
struct ShearLayer {
  double amplitude, steepness, perturbation, kx, height;
  explicit ShearLayer(const FlowSpec& spec)
      : amplitude(spec.fluid->initial.velocity.norm()),
        steepness(spec.fluid->initial.steepness),
        perturbation(spec.fluid->initial.perturbation),
        kx(2 * pi / spec.cells[0]),
        height(spec.cells[1]) {}
};

Local at(const ShearLayer& layer, const rigid::Vec3& x) {
  const double y = x[1] / layer.height - 0.5, a = layer.amplitude, phase = layer.kx * x[0] + pi / 2;
  const double u = elementary::tanh(layer.steepness * (0.25 - std::abs(y))), wave = a * layer.perturbation;
  const double slope = std::copysign(a * layer.steepness / layer.height * (1 - u * u), -y);
  Local flow;
  flow.velocity = {a * u, wave * elementary::sin(phase), 0};
  flow.xy = 0.5 * (slope + wave * layer.kx * elementary::cos(phase));
  return flow;
}

/// A vortex about the z axis through the middle of the domain in a uniform stream, with the largest speed s
/// at radius R:
///   u = U + s/R (-y, x) e^((1 - r^2/R^2)/2),  p = -s^2/2 e^(1 - r^2/R^2).
struct GaussianVortex {
  rigid::Vec3 stream, centre;
  double swirl, radius;
  explicit GaussianVortex(const FlowSpec& spec)
      : stream(spec.fluid->initial.velocity),
        centre(0.5 * spec.cells[0], 0.5 * spec.cells[1], 0),
        swirl(spec.fluid->initial.swirl),
        radius(spec.fluid->initial.radius) {}
};

Local at(const GaussianVortex& vortex, const rigid::Vec3& point) {
  const double x = point[0] - vortex.centre[0], y = point[1] - vortex.centre[1];
  const double square = vortex.radius * vortex.radius, share = elementary::exp(1 - (x * x + y * y) / square);
  const double turn = vortex.swirl / vortex.radius * std::sqrt(share);
  Local flow;
  flow.density_deviation = -1.5 * vortex.swirl * vortex.swirl * share;
  flow.velocity = vortex.stream + rigid::Vec3(-turn * y, turn * x, 0);
  flow.xx = x * y * turn / square;
  flow.yy = -flow.xx;
  flow.xy = 0.5 * (y * y - x * x) * turn / square;
  return flow;
}

/// Replaces every population by change(i, g, local(global cell)).
template <class AtCell, class Change>
void change_populations(FluidFields& fields, AtCell&& local, Change&& change) {
  for (int b = 0; b < fields.blocks(); ++b)
    change_populations(fields, b, lbm::D3Q19::directions, [&](lbm::Int3 cell, std::vector<double>& g) {
      const auto here = local(cell);
      for (int i = 0; i < lbm::D3Q19::directions; ++i) g[i] = change(i, g[i], here);
    });
}

/// Sets equilibrium and its first-order deviation, f1_i = -3 tau w_i (c_i c_i - 1/3) : S.
template <class Shape>
void set(const FlowSpec& spec, FluidFields& fields) {
  const Shape shape(spec);
  const double tau = fields.spec().relaxation_time;
  const auto local = [&](lbm::Int3 cell) { return at(shape, fields.centre(cell)); };
  change_populations(fields, local, [&](int i, double, const Local& l) {
    return lbm::equilibrium(i, l.density_deviation, l.velocity.data());
  });
  change_populations(fields, local, [&](int i, double g, const Local& l) {
    const lbm::Int3 v = lbm::D3Q19::c[i];
    const double strain = v.x * v.x * l.xx + v.y * v.y * l.yy + v.z * v.z * l.zz +
                          2 * (v.x * v.y * l.xy + v.x * v.z * l.xz + v.y * v.z * l.yz) -
                          (l.xx + l.yy + l.zz) / 3;
    return i == 0 ? g : g - 3 * tau * lbm::D3Q19::w(i) * strain * fields.width();
  });
}

/// Adds a random velocity to every cell, uniform in [-noise, noise] by component, from its first finest cell.
void add_noise(const FlowSpec& spec, FluidFields& fields) {
  const double noise = spec.fluid->initial.noise;
  const auto velocity = [&](lbm::Int3 cell) {
    const auto [x, y, z] = fields.finest(cell);
    const auto place = (std::uint64_t(z) * spec.cells[1] + y) * spec.cells[0] + x;
    return rigid::Vec3(noise * (2 * CounterRandom(mixed(place)).point() - rigid::Vec3::Ones()));
  };
  change_populations(fields, velocity, [&](int i, double g, const rigid::Vec3& u) {
    const double along = lbm::D3Q19::c[i].x * u[0] + lbm::D3Q19::c[i].y * u[1] + lbm::D3Q19::c[i].z * u[2];
    return i == 0 ? g : g + 3 * lbm::D3Q19::w(i) * along;
  });
}

}  // namespace

void set_initial_flow(const FlowSpec& spec, FluidFields& fields) {
  constexpr void (*setters[])(const FlowSpec&, FluidFields&) = {
      // by InitialFlow; null: at rest
      nullptr, set<Uniform>, set<TaylorGreen>, set<TaylorGreen3D>, set<ShearLayer>, set<GaussianVortex>};
  if (const auto set_flow = setters[int(spec.fluid->initial.type)]) set_flow(spec, fields);
  if (spec.fluid->initial.noise > 0) add_noise(spec, fields);
  set_initial_temperature(spec, fields);
}

void set_initial_temperature(const FlowSpec& spec, FluidFields& fields) {
  if (!spec.heat) return;
  std::vector<double> g;
  for (int b = 0; b < fields.blocks(); ++b) {
    const lbm::Int3 size = fields.block(b).size;
    lbm::MomentsByRow moments(fields, b, 0, size.x);
    for (lbm::CellBox row{{}, {size.x, 1, 1}}; row.lower.z < size.z; ++row.lower.z)
      for (row.lower.y = 0; row.lower.y < size.y; ++row.lower.y)
        for (int i = 0; i < lbm::D3Q7::directions; ++i) {
          g.clear();
          for_cells(row.lower, row.lower + row.size, [&](lbm::Int3 x) {
            g.push_back(lbm::heat_equilibrium(i, spec.heat->initial, fields.velocity(moments(x))));
          });
          fields.write(b, row, lbm::D3Q19::directions + i, g.data());
        }
  }
}

}  // namespace silt::coupler
