#pragma once
// The fluid: the tables [fluid], [coupling] and [coarsening] of a case, and which collision model lasts in a
// scene, by what was measured (scripts/stability).
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "coupler/case/case_error.hpp"
#include "lbm/collision_model.hpp"
#include "lbm/wall_scheme.hpp"
#include "rigid/bodies/prescribed_motion.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

struct Case;

enum class Precision { single_, double_ };
inline constexpr auto precision_names = names_of<Precision>("single", "double");

inline constexpr auto collision_names = [] {
  NameTable<lbm::Collision, lbm::collision_models.size()> table;
  for (std::size_t i = 0; i < table.names.size(); ++i) table.names[i] = lbm::collision_models[i].name;
  return table;
}();

/// The velocity of the fluid at the start; of the Taylor-Green vortices and the layers one wave a period.
enum class InitialFlow { rest, uniform, taylor_green, taylor_green_3d, shear_layer, vortex };
inline constexpr auto initial_flow_names =
    names_of<InitialFlow>("rest", "uniform", "taylor-green", "taylor-green-3d", "shear-layer", "vortex");

/// The flow begins with this state (initial_flow.cpp has the formulas).
struct InitialSpec {
  InitialFlow type = InitialFlow::rest;
  rigid::Vec3 velocity = rigid::Vec3::Zero();  // of the stream; its length is the amplitude of the others
  double steepness = 80;                       // of shear layers: period over thickness
  double swirl = 0, radius = 0;                // of a vortex: largest speed, where it is
  double noise = 0;                            // largest component of a random velocity of each cell

  /// The speed across shear layers is this share of that along them (Minion, Brown 1997).
  static constexpr double perturbation = 0.05;

  double largest_speed() const {
    return velocity.norm() * (1 + (type == InitialFlow::shear_layer) * perturbation) + swirl;
  }
};

struct FluidSpec {
  double kinematic_viscosity = 0, relaxation_time = 0;
  lbm::Collision collision = lbm::Collision::trt;
  bool collision_by_scene = false;  // "auto": chosen once the scene is known
  double magic = 1. / 6;            // Lambda; with bodies or [[walls]] best_magic of the wall scheme
  double smagorinsky = 0.1;         // least viscosity of a cell, of collision models that have one
  Precision precision = Precision::single_;
  rigid::Vec3 body_force = rigid::Vec3::Zero();  // acceleration of the fluid
  rigid::OverTime body_force_over_time;
  /// Mean over all cells that the body force is controlled for, along the axes on which it is not 0.
  rigid::Vec3 superficial_velocity = rigid::Vec3::Zero();
  bool body_force_on_bodies = false;  // it stands for a pressure gradient, which pushes free bodies too
  InitialSpec initial;
  bool quiet_start = false;  // from rest: with the pressure that the loads ask for

  bool has_body_force() const { return !body_force.isZero(0) || !superficial_velocity.isZero(0); }
};

// The table [coupling] says how fluid and bodies are coupled.

using lbm::WallScheme;
inline constexpr NameTable<WallScheme, lbm::wall_scheme_names.size()> wall_scheme_names{
    lbm::wall_scheme_names};

enum class TimeCoupling { explicit_, implicit_ };
inline constexpr auto time_coupling_names = names_of<TimeCoupling>("explicit", "implicit");

enum class Refill { equilibrium, grad };
inline constexpr auto refill_names = names_of<Refill>("equilibrium", "grad");

using lbm::ForceForm;
inline constexpr NameTable<ForceForm, lbm::force_form_names.size()> force_form_names{lbm::force_form_names};

struct CouplingSpec {
  WallScheme wall_scheme = WallScheme::multireflection;
  TimeCoupling time = TimeCoupling::implicit_;
  Refill refill = Refill::grad;
  ForceForm force = ForceForm::galilean;
  /// A surface may be this far, in cells, from where its cells were found; mapping/mapping_poses.hpp. At most
  /// 0.4: holders of a body that is more than 1/2 from there might not know of it (exchange/holders.hpp).
  double remap_tolerance = 0.1;
  bool lubrication = true;         // between close smooth surfaces; needs the resolver sffd
  double lubrication_min_gap = 0;  // where it stops growing; 0: Lubrication::relative_least_gap
};

/// Returns the largest speed that a case gives anything: sides, bodies, the fluid at the start; lattice
/// units.
double fastest_given(const Case&);

/// Returns the cell Reynolds number u / nu at that speed.
double cell_reynolds(const Case&);

/// Returns the largest u / nu up to which a model lasted in every scene of the map, at up to 0.1 cells a
/// step.
double measured_reynolds(lbm::Collision);

/// Resolves `fluid.collision = "auto"`: trt, the cheapest, up to what was measured, regularised above.
void choose_collision(Case&);

/// Returns why the case has its collision model: "given", or what "auto" compared.
std::string collision_reason(const Case&);

struct Case;

/// Cells are refined and coarsened before steps that are multiples of this, and at no other time.
inline constexpr std::int64_t regrid_interval = 16;

/// A box in which no cell is of a higher level.
struct FineBox {
  rigid::BoundingBox box{rigid::Vec3::Zero(), rigid::Vec3::Zero()};
  int level = 0;
};

/// The table [coarsening]: cells of level l are 2^l finest cells wide.
struct CoarseningSpec {
  static constexpr int most_levels = 4;
  static_assert(regrid_interval % (1 << most_levels) == 0);
  int levels = 1;       // besides the finest, 0
  double distance = 0;  // cells: from bodies, curved walls and fine sides up to which cells are finest
  std::array<bool, 6> fine_sides{};  // by Side
  std::vector<FineBox> fine;

  /// Finest cells, and steps, of which sizes of the domain and intervals of a run are whole multiples.
  int stride() const { return 1 << levels; }
};

/// Returns how many finest cells there must be, in every step, between a surface and the nearest coarser
/// cell: what links read beyond it, up to where it is mapped ahead, and the two cells that a border fills.
int least_margin(const Case&);

}  // namespace silt::coupler
