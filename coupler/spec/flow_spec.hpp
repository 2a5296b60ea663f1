#pragma once
// A flow with bodies: domain, fluid, coupling, springs and levels of cells, in lattice units (cell = step =
// reference density = 1).
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "coupler/spec/heat_spec.hpp"
#include "coupler/spec/name_table.hpp"
#include "coupler/spec/sides.hpp"
#include "device/device.hpp"
#include "lbm/collision/collision_model.hpp"
#include "lbm/walls/wall_scheme.hpp"
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/prescribed_motion.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

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
