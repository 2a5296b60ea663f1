#pragma once
// A flow with bodies: domain, fluid, coupling, springs and levels of cells, in lattice units (cell = step =
// reference density = 1).
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "coupler/spec/name_table.hpp"
#include "device/device.hpp"
#include "lbm/blocks/side_kinds.hpp"
#include "lbm/collision/collision_model.hpp"
#include "lbm/collision/heat_rates.hpp"
#include "lbm/walls/wall_scheme.hpp"
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/prescribed_motion.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

enum class Side { x_low, x_high, y_low, y_high, z_low, z_high };
inline constexpr auto side_names = names_of<Side>("x-low", "x-high", "y-low", "y-high", "z-low", "z-high");

enum class BoundaryKind { periodic, no_slip, moving, free_slip, velocity_inlet, pressure_outlet };

/// The properties of a kind of side.
struct BoundaryTraits {
  std::string_view name;
  lbm::SideKind fluid;                              // SideKind of the fluid
  bool is_wall = false;                             // moves fluid and touching bodies at its velocity
  bool is_inlet = false;                            // needs an outlet elsewhere
  bool has_velocity = false, has_pressure = false;  // keys in a case
};
/// The kinds in the order of the enumerators.
inline constexpr auto boundary_kinds = std::to_array<BoundaryTraits>({
    {.name = "periodic", .fluid = lbm::SideKind::periodic},
    {.name = "no-slip", .fluid = lbm::SideKind::bounce, .is_wall = true},
    {.name = "moving", .fluid = lbm::SideKind::bounce, .is_wall = true, .has_velocity = true},
    {.name = "free-slip", .fluid = lbm::SideKind::free_slip},
    {.name = "velocity-inlet", .fluid = lbm::SideKind::bounce, .is_inlet = true, .has_velocity = true},
    {.name = "pressure-outlet", .fluid = lbm::SideKind::pressure, .has_pressure = true},
});
inline constexpr auto boundary_names = names_of<BoundaryKind>(boundary_kinds);

struct BoundarySpec {
  BoundaryKind kind = BoundaryKind::periodic;
  rigid::Vec3 velocity = rigid::Vec3::Zero();  // moving walls and inlets
  rigid::OverTime over_time;                   // of the velocity
  double pressure = 0;                         // outlets; less that of the reference density
  bool solid_for_bodies = true;                // a half-space for bodies, unless periodic
  const BoundaryTraits& traits() const { return boundary_kinds[static_cast<std::size_t>(kind)]; }
  bool is_periodic() const { return kind == BoundaryKind::periodic; }
  bool is_inlet() const { return traits().is_inlet; }
  bool is_outlet() const { return lbm::is_outlet(traits().fluid); }
  bool is_open() const { return is_inlet() || is_outlet(); }
  bool is_wall() const { return traits().is_wall; }
  rigid::Vec3 velocity_at(double time) const { return over_time.at(time) * velocity; }
  double largest_speed() const { return over_time.most() * velocity.norm(); }
  bool stops_bodies() const { return !is_periodic() && solid_for_bodies; }
  /// Returns whether bodies that pass the side are removed.
  bool removes_bodies() const { return !is_periodic() && !solid_for_bodies; }
};

/// What a side of the domain is to the heat of the fluid: insulating without a temperature or a flux.
struct SideHeat {
  std::optional<double> temperature;
  double flux = 0;  // into the fluid, per area and step
};

/// What bodies of a kind or a wall are: insulating without a temperature.
struct BodyHeat {
  std::optional<double> temperature;  // at the start, of a body with a heat capacity
  double capacity = 0;  // of its mass, relative to that of the fluid; 0: it keeps its temperature
  double source = 0;    // heat that each body makes in a step
  bool operator==(const BodyHeat&) const = default;
};

struct HeatSpec : lbm::HeatSpec {
  double expansion = 0;  // β; with gravity it is the buoyancy
  double initial = 0;    // of the fluid at the start
  double of_fluid = 1;   // heat capacity of a cell of fluid, in lattice units of energy
  std::array<SideHeat, 6> sides;
  std::vector<BodyHeat> kinds, walls;  // of bodies, by kind; of [[walls]]

  /// Returns the temperature of a body of a kind at the start.
  double at_start(std::size_t kind) const { return kinds[kind].temperature.value_or(0); }
};

/// A spring and a damper between two points, each fixed to a body; the second may be fixed to the domain.
struct SpringSpec {
  rigid::BodyId body = 0, to = 0;  // 0: the domain
  rigid::Vec3 arm = rigid::Vec3::Zero(),
              to_arm = rigid::Vec3::Zero();  // from the centre of mass, in its frame
  double stiffness = 0, damping = 0;
  double length = 0;          // at rest; 0: holds the points together
  double compliance[2] = {};  // of each point: largest velocity per impulse
};

enum class Precision { single_, double_ };
inline constexpr auto precision_names = names_of<Precision>("single", "double");

inline constexpr auto collision_names = names_of<lbm::Collision>(lbm::collision_models);

/// The initial velocity field; Taylor-Green vortices and shear layers have one wave per period.
enum class InitialFlow { rest, uniform, taylor_green, taylor_green_3d, shear_layer, vortex };
inline constexpr auto initial_flow_names =
    names_of<InitialFlow>("rest", "uniform", "taylor-green", "taylor-green-3d", "shear-layer", "vortex");

/// The initial state; initial_flow.cpp has the formulas.
struct InitialSpec {
  InitialFlow type = InitialFlow::rest;
  rigid::Vec3 velocity = rigid::Vec3::Zero();  // of the stream; else its norm is the amplitude
  double steepness = 80;                       // of shear layers: period divided by thickness
  double swirl = 0, radius = 0;                // of a vortex: largest speed, and its radius
  double noise = 0;                            // largest component of each cell's random velocity

  /// Speed across shear layers relative to that along them (Minion, Brown 1997).
  static constexpr double perturbation = 0.05;

  double largest_speed() const {
    return velocity.norm() * (1 + (type == InitialFlow::shear_layer) * perturbation) + swirl;
  }
};

/// The parameters of the fluid and its state at the start.
struct FluidSpec {
  double kinematic_viscosity = 0, relaxation_time = 0;
  lbm::Collision collision = lbm::Collision::trt;
  bool collision_by_scene = false;  // "auto": chosen for the scene
  double magic = 1. / 6;            // Lambda; with bodies or [[walls]] best_magic of the wall scheme
  Precision precision = Precision::single_;
  rigid::Vec3 body_force = rigid::Vec3::Zero();  // acceleration of the fluid
  rigid::OverTime body_force_over_time;
  /// The mean velocity over all cells to which the body force is controlled; 0 along an axis: no control.
  rigid::Vec3 superficial_velocity = rigid::Vec3::Zero();
  bool body_force_on_bodies = false;  // as a pressure gradient, which acts on free bodies too
  InitialSpec initial;
  bool quiet_start = false;  // from rest, with the pressure that balances the loads

  bool has_body_force() const { return !body_force.isZero(0) || !superficial_velocity.isZero(0); }
};

/// Cells are refined and coarsened only before steps that are multiples of this.
inline constexpr std::int64_t regrid_interval = 32;

/// A box without cells above a level.
struct FineBox {
  rigid::BoundingBox box{rigid::Vec3::Zero(), rigid::Vec3::Zero()};
  int level = 0;
};

/// Where cells are fine, and the number of coarser levels. Cells of level l are 2^l finest cells wide.
struct CoarseningSpec {
  static constexpr int most_levels = 4;
  static_assert(regrid_interval % (1 << most_levels) == 0);
  int levels = 1;       // number of coarser levels
  double distance = 0;  // cells, from bodies and curved walls, within which cells are finest
  std::vector<FineBox> fine;

  /// Returns the divisor of domain sizes (finest cells) and run intervals (steps).
  int stride() const { return 1 << levels; }
};

using lbm::WallScheme;
inline constexpr NameTable<WallScheme, lbm::wall_scheme_names.size()> wall_scheme_names{
    lbm::wall_scheme_names};

enum class TimeCoupling { explicit_, implicit_ };
inline constexpr auto time_coupling_names = names_of<TimeCoupling>("explicit", "implicit");

using lbm::ForceForm;
inline constexpr NameTable<ForceForm, lbm::force_form_names.size()> force_form_names{lbm::force_form_names};

/// The parameters of the coupling of fluid and bodies.
struct CouplingSpec {
  WallScheme wall_scheme = WallScheme::multireflection;
  TimeCoupling time = TimeCoupling::implicit_;
  ForceForm force = ForceForm::galilean;
  /// The distance in cells that a surface may move before it is mapped again (mapping/mapping_poses.hpp). At
  /// most 0.4: ranks may not know of a body more than 1/2 from where it was mapped (exchange/holders.hpp).
  double remap_tolerance = 0.1;
  bool lubrication = true;         // between close smooth surfaces; needs the resolver sffd
  double lubrication_min_gap = 0;  // cells, below which it is constant; 0: Lubrication::relative_least_gap
};

struct FlowSpec {
  std::array<int, 3> cells{};
  std::array<BoundarySpec, 6> boundary;           // by Side
  std::optional<std::array<int, 3>> block_cells;  // none: "auto"
  std::optional<FluidSpec> fluid;                 // none: bodies alone
  std::optional<HeatSpec> heat;                   // none: the fluid has no temperature
  std::optional<CoarseningSpec> coarsening;       // none: every cell is finest
  CouplingSpec coupling;
  Device device = Device::cpu;

  bool periodic(int axis) const { return boundary[2 * axis].is_periodic(); }
  double volume() const { return 1. * cells[0] * cells[1] * cells[2]; }  // in cells
};

/// Returns the extent of the domain for bodies.
rigid::Extent extent_of(const FlowSpec&);
rigid::BoundingBox box_of(const FlowSpec&);
/// Returns the sides of the domain for the fluid.
std::array<lbm::SideCondition, 6> sides_of(const FlowSpec&);

/// Returns the shortest displacement between a point and the periodic images of another.
rigid::Vec3 nearest_image(rigid::Vec3 displacement, const rigid::Extent&);

/// Returns the number of finest cells needed between a surface and the nearest coarser cell in every step:
/// the cell of a link, the reach of the link from there, and the distance mapped ahead.
int least_margin(const CouplingSpec&);

}  // namespace silt::coupler
