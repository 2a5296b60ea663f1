#pragma once
// A case as data: everything case.toml says, already in lattice units (cell = step = reference density = 1),
// with the conversions kept in `units` for what goes back out. case_file reads it (through adapters/toml),
// case_check judges it.
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coupler/case/case_error.hpp"
#include "coupler/case/coupling_spec.hpp"
#include "coupler/case/fluid_spec.hpp"
#include "coupler/case/units.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/rigid_step.hpp"

namespace silt::coupler {

enum class Side { x_low, x_high, y_low, y_high, z_low, z_high };
inline constexpr auto side_names = names_of<Side>("x-low", "x-high", "y-low", "y-high", "z-low", "z-high");

enum class BoundaryKind { periodic, no_slip, moving, free_slip, velocity_inlet, pressure_outlet };
inline constexpr auto boundary_names =
    names_of<BoundaryKind>("periodic", "no-slip", "moving", "free-slip", "velocity-inlet", "pressure-outlet");

struct BoundarySpec {
  BoundaryKind kind = BoundaryKind::periodic;
  rigid::Vec3 velocity = rigid::Vec3::Zero();  // moving walls and inlets
  double density = 1;                          // outlets
  bool solid_for_bodies = true;                // a half-space for bodies (every kind but periodic)
};

struct ContactSpec {
  std::string backend = "auto", broad_phase = "auto", resolver = "sffd";
  rigid::ResolverSettings resolver_settings;
  int substeps = 1;
  double margin = 1.0;
};

inline constexpr auto motion_names = names_of<rigid::Motion>("free", "fixed", "prescribed");

struct BodySpec {  // one body
  int shape = 0, material = 0;
  int kind = 0;        // index into Case::kind_names
  int entry = -1;      // which [[bodies]] entry gave it; -1: a [[fill]]
  double density = 1;  // relative to the fluid's (lattice)
  rigid::Motion motion = rigid::Motion::free;
  rigid::Pose pose;  // of the shape as the case gives it, not of its centre of mass
  rigid::Vec3 velocity = rigid::Vec3::Zero(), angular_velocity = rigid::Vec3::Zero();
};

/// A curved wall of the domain, for fluid and bodies alike.
struct CurvedWall {
  std::string name;
  rigid::TubeSpec tube;
};

struct FillSpec {
  int shape = 0, material = 0, kind = 0, count = 0;
  double density = 1, gap = 0;  // gap: least distance between bounding spheres' surfaces and to walls
  bool random_orientation = true;
  rigid::Vec3 lower = rigid::Vec3::Zero(), upper = rigid::Vec3::Zero();
  std::uint64_t seed = 1;
};

struct SeriesSpec {  // 0: never
  std::int64_t every = 0;
};

enum class Field { velocity, density };
inline constexpr auto field_names = names_of<Field>("velocity", "density");

struct OutputSpec {
  SeriesSpec fields, bodies, checkpoint, report;
  std::vector<Field> quantities;  // of the fields
  int keep_checkpoints = 2;
};

/// An analytic flow that a quantity compares with.
enum class Profile { channel, duct, pipe };
inline constexpr auto profile_names = names_of<Profile>("channel", "duct", "pipe");

/// A value the run puts into report.json under "quantities", for reference.toml to compare. The types and
/// the keys each takes are in quantity_types.
struct QuantitySpec {
  std::string name, type;
  int kind = -1;  // index into Case::kind_names; -1: every body
  int axis = 2;
  Profile profile = Profile::channel;
  double time = 0;    // from when on (of an instant: when; without one the end), in steps
  double height = 0;  // along the axis
  int side = 0;       // a Side of the domain
  int wall = 0;       // index into Case::walls
  rigid::Vec3 centre = rigid::Vec3::Zero();
  rigid::Vec3 lower = rigid::Vec3::Zero(), upper = rigid::Vec3::Zero();  // a box

  bool is_about(int body_kind) const { return kind < 0 || body_kind == kind; }
};

/// The run ends before its last step when a quantity has come so close to where it goes (see SteadyWatch).
struct SteadySpec {
  std::string quantity;  // name of a QuantitySpec
  double change = 0;     // relative
  std::int64_t every = 0;
};

struct Case {
  // text: case.toml as read, then each file and each --set as a comment, for provenance
  std::string title, text;
  std::vector<std::string> files;      // that the case names: AttachedFile::fingerprint of each, in its order
  std::vector<std::string> overrides;  // the --set arguments
  std::filesystem::path directory;
  Units units;

  std::array<int, 3> cells{};
  std::array<BoundarySpec, 6> boundary;           // by Side
  std::optional<std::array<int, 3>> block_cells;  // none: "auto"
  bool periodic(int axis) const { return boundary[2 * axis].kind == BoundaryKind::periodic; }

  std::optional<FluidSpec> fluid;
  CouplingSpec coupling;
  ContactSpec contacts;
  rigid::Vec3 gravity = rigid::Vec3::Zero();

  // material 0 is "default": of walls, and of bodies that name none
  std::vector<std::string> shape_names, material_names;
  rigid::ShapeList shapes;                      // as given (a compound need not be centred)
  std::vector<rigid::Material> pair_materials;  // material_names.size()^2
  std::vector<BodySpec> bodies;
  std::vector<FillSpec> fills;
  std::vector<CurvedWall> walls;  // besides the sides of the domain
  // names of the [[bodies]] and [[fill]] entries ("light spheres", by default the shape's name); entries of
  // one name make one kind, and have one shape
  std::vector<std::string> kind_names;
  std::vector<int> kind_shapes;

  std::int64_t steps = 0;
  std::optional<SteadySpec> steady;
  OutputSpec output;
  std::vector<QuantitySpec> quantities;
  std::map<std::string, Place> places;  // of every key, by its path: "fluid.density", "bodies[2].position"
  /// Where a key stands; if it is not in the file, where the table that would hold it does.
  Place place(std::string path) const;
  bool has_bodies() const { return !bodies.empty() || !fills.empty(); }
  bool has_lubrication() const {
    return fluid && coupling.lubrication && rigid::resolver_model(contacts.resolver).lubricates;
  }
  /// Something besides the sides of the domain bounds the fluid.
  bool has_surfaces() const { return has_bodies() || !walls.empty(); }
};

}  // namespace silt::coupler
