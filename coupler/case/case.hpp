#pragma once
// A case as data: everything case.toml says, already in lattice units (cell = step = reference density = 1),
// with the conversions kept in `units` for what goes back out. case_file reads it (through adapters/toml),
// case_check judges it. Sections that are needed alone have headers of their own.
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "coupler/case/case_error.hpp"
#include "coupler/case/fluid_spec.hpp"
#include "coupler/case/output_spec.hpp"
#include "coupler/case/position_file.hpp"
#include "coupler/case/quantity_spec.hpp"
#include "coupler/case/units.hpp"
#include "device/device.hpp"
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/response/contact_resolver.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::coupler {

// The bodies: [[bodies]], [[fill]] and [[outflow]].

inline constexpr auto motion_names = names_of<rigid::Motion>("free", "fixed", "prescribed");

/// The bodies of an entry of [[bodies]] or [[fill]] have this in common.
struct EntrySpec {
  int shape = 0, material = 0;
  int kind = 0;                                // index into Case::kind_names
  double density = 1;                          // relative to the fluid's (lattice)
  rigid::Vec3 velocity = rigid::Vec3::Zero();  // of the bodies when they are placed
};

struct BodySpec : EntrySpec {
  int entry = -1;           // which [[bodies]] entry gave it; -1: a [[fill]]
  std::uint64_t point = 0;  // of a file of positions, from 1 on; 0: the case says where it is
  rigid::Motion motion = rigid::Motion::free;
  rigid::LockedAxes locked = 0;
  rigid::Pose pose;   // of the centre of mass
  bool unit = false;  // the orientation is of length 1 as it stands, to the last bit: as a file has it
  rigid::Vec3 origin = rigid::Vec3::Zero();  // the point that a position of the case places, from the centre
  rigid::Vec3 angular_velocity = rigid::Vec3::Zero();

  rigid::Vec3 given_position() const { return pose.to_world(origin); }
};

/// Bodies of one [[bodies]] entry whose positions stand in a file.
struct FiledBodies {
  BodySpec alike;  // but for what the file says; velocities that it says: the largest
  PositionFile positions;
  PositionContents contents;
};

enum class Arrangement { random, simple_cubic, hexagonal, layers };
inline constexpr auto arrangement_names =
    names_of<Arrangement>("random", "simple-cubic", "hexagonal", "layers");

/// A size of a fill's bodies.
struct FillSize {
  int shape;     // index into Case::shapes
  double up_to;  // share of the bodies, by number, that have this size or a smaller one
};

struct FillSpec : EntrySpec {   // the shape is that of the largest
  std::vector<FillSize> sizes;  // smallest first; one where all bodies are alike
  std::int64_t count = 0;       // 0: as many as there are sites for, not at random
  double gap = 0;               // least distance between bounding spheres' surfaces and to walls
  Arrangement arrangement = Arrangement::random;
  double spacing = 0;    // of sites, not at random; 0: the least
  double shift = 0;      // furthest that a body is moved from its site
  bool aligned = false;  // else turned at random
  rigid::BoundingBox box{rigid::Vec3::Zero(), rigid::Vec3::Zero()};
  std::uint64_t seed = 1;
  std::int64_t every = 0;  // steps between two applications; 0: at the start only
  double until = std::numeric_limits<double>::infinity();  // no application after this step

  /// Says whether the fill is applied again before the step that follows so many.
  bool comes_at(std::int64_t steps_done) const {
    return every > 0 && steps_done > 0 && steps_done % every == 0 && static_cast<double>(steps_done) <= until;
  }
};

/// A box out of which free bodies are taken as soon as their centre of mass is in it.
struct OutflowSpec {
  rigid::BoundingBox box{rigid::Vec3::Zero(), rigid::Vec3::Zero()};
};

/// The run begins with the end of another one.
struct StartSpec {
  std::string from;  // a folder of results, or a checkpoint; from the folder of the case
  double random_velocity = 0;
};

/// A spring and a damper between two points, each fixed to a body, or the second to the domain.
struct SpringSpec {
  rigid::BodyId body = 0, to = 0;  // 0: the domain
  rigid::Vec3 arm = rigid::Vec3::Zero(),
              to_arm = rigid::Vec3::Zero();  // from the centre of mass, in its frame
  double stiffness = 0, damping = 0;
  double length = 0;          // at which it does not pull; 0: the two points are one
  double compliance[2] = {};  // of the two points: velocity by an impulse, at most
};

// The sides of the domain and the curved walls in it: domain.boundary and [[walls]].

enum class Side { x_low, x_high, y_low, y_high, z_low, z_high };
inline constexpr auto side_names = names_of<Side>("x-low", "x-high", "y-low", "y-high", "z-low", "z-high");

enum class BoundaryKind { periodic, no_slip, moving, free_slip, velocity_inlet, pressure_outlet };
inline constexpr auto boundary_names =
    names_of<BoundaryKind>("periodic", "no-slip", "moving", "free-slip", "velocity-inlet", "pressure-outlet");

/// A body beyond a side that is open to bodies is taken out, or the run stops.
enum class Leaving { remove, stop };
inline constexpr auto leaving_names = names_of<Leaving>("remove", "stop");

struct BoundarySpec {
  BoundaryKind kind = BoundaryKind::periodic;
  rigid::Vec3 velocity = rigid::Vec3::Zero();  // moving walls and inlets
  rigid::OverTime over_time;                   // of the velocity
  double density = 1;                          // outlets
  bool solid_for_bodies = true;                // a half-space for bodies (every kind but periodic)
  Leaving leaving = Leaving::remove;           // of a side that is not solid for them
  rigid::Vec3 velocity_at(double time) const { return over_time.at(time) * velocity; }
  double largest_speed() const { return over_time.most() * velocity.norm(); }
  bool has_velocity() const { return kind == BoundaryKind::moving || kind == BoundaryKind::velocity_inlet; }
  bool lets_bodies_pass() const { return kind != BoundaryKind::periodic && !solid_for_bodies; }
  bool removes_bodies() const { return lets_bodies_pass() && leaving == Leaving::remove; }
};

/// A wall of triangles from a file.
struct MeshWall : rigid::MeshWallSpec {
  std::string file, contents;  // contents: "1280 triangles in 1 shell", and what was mended
  std::string table;           // of its motion; "" without one
  int table_headings = 0;      // its lines of headings
};

/// A curved wall of the domain, for fluid and bodies alike.
struct CurvedWall {
  std::string name;
  std::variant<rigid::HollowWallSpec, MeshWall> surface;

  const rigid::HollowWallSpec* hollow() const { return std::get_if<rigid::HollowWallSpec>(&surface); }
  const MeshWall* mesh() const { return std::get_if<MeshWall>(&surface); }
  /// Says whether its surface moves, as prescribed; that of a hollow slides along itself.
  bool moves() const {
    return std::visit([](const auto& wall) { return wall.moves(); }, surface);
  }
  /// Velocities of the origin of its frame.
  rigid::PrescribedMotion::Velocity velocity_at(double time) const {
    return std::visit([&](const auto& wall) { return wall.velocity_at(time); }, surface);
  }
  /// Returns the axis about which it turns; of a mesh where it is at the start.
  rigid::Vec3 axis() const {
    return std::visit([](const auto& wall) { return wall.axis; }, surface);
  }
  rigid::Vec3 point_of_axis() const { return mesh() ? mesh()->start.position : hollow()->point; }
};

/// The table [contacts] says how bodies collide.
struct ContactSpec {
  std::string backend = "auto", broad_phase = "auto", resolver = "sffd";
  rigid::ResolverSettings resolver_settings;
  int substeps = 1;
  double margin = 1.0;
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
  double volume() const { return 1. * cells[0] * cells[1] * cells[2]; }  // in cells

  std::optional<FluidSpec> fluid;
  std::optional<CoarseningSpec> coarsening;  // none: every cell is finest
  CouplingSpec coupling;
  ContactSpec contacts;
  rigid::Vec3 gravity = rigid::Vec3::Zero();
  rigid::OverTime gravity_over_time;
  rigid::Vec3 gravity_at(double time) const { return gravity_over_time.at(time) * gravity; }

  // material 0 is "default": of walls, and of bodies that name none
  std::vector<std::string> shape_names, material_names;
  rigid::ShapeList shapes;                 // each about its centre of mass
  std::vector<rigid::Vec3> shape_origins;  // where the origin is that the case gives each about, in its frame
  std::vector<rigid::Material> pair_materials;  // material_names.size()^2
  std::vector<BodySpec> bodies;
  std::vector<FiledBodies> filed;
  std::optional<StartSpec> start;
  std::vector<BodySpec> continued;  // of the entries whose bodies come from there; without a place
  std::vector<FillSpec> fills;
  std::vector<OutflowSpec> outflows;
  std::vector<SpringSpec> springs;
  std::vector<CurvedWall> walls;  // besides the sides of the domain
  // names of the [[bodies]] and [[fill]] entries ("light spheres", by default the shape's name); entries of
  // one name make one kind, and have one shape
  std::vector<std::string> kind_names;
  std::vector<int> kind_shapes;
  std::vector<rigid::LockedAxes> kind_locks;            // of the bodies of a kind; empty: none has any
  std::map<int, rigid::PrescribedMotion> kind_motions;  // of kinds whose bodies move by a function of time

  std::int64_t steps = 0;
  std::optional<SteadySpec> steady;
  Device device = Device::cpu;
  std::int64_t balance_every = 0;  // steps between two looks at how the work is shared; 0: none
  OutputSpec output;
  std::vector<QuantitySpec> quantities;
  std::vector<Diagnostic> warnings;     // of its readers
  std::map<std::string, Place> places;  // of every key, by its path: "fluid.density", "bodies[2].position"
  /// Returns the place of a key; if it is not in the file, that of the table that would hold it.
  Place place(std::string path) const;
  bool has_bodies() const {
    return !bodies.empty() || !filed.empty() || !fills.empty() || !continued.empty();
  }
  /// Calls f(body, count) for every given body, and once for all of a file, of which the position is not
  /// known.
  template <class F>
  void for_each_given(F&& f) const {
    for (const BodySpec& body : bodies) f(body, std::uint64_t{1});
    for (const FiledBodies& file : filed) f(file.alike, file.contents.points);
  }
  template <class Test>
  bool any_given(Test&& test) const {
    return std::ranges::any_of(bodies, test) ||
           std::ranges::any_of(filed, [&](const FiledBodies& file) { return test(file.alike); });
  }
  bool has_free_bodies() const {
    const auto free = [](const BodySpec& body) { return body.motion == rigid::Motion::free; };
    return !fills.empty() || any_given(free) || std::ranges::any_of(continued, free);
  }
  bool bodies_come() const {
    return std::ranges::any_of(fills, [](const FillSpec& fill) { return fill.every > 0; });
  }
  bool has_sizes() const {  // bodies of one kind that differ in size
    return std::ranges::any_of(fills, [](const FillSpec& fill) { return fill.sizes.size() > 1; });
  }
  bool bodies_leave() const {
    return !outflows.empty() || std::ranges::any_of(boundary, &BoundarySpec::removes_bodies);
  }
  bool has_lubrication() const {
    return fluid && coupling.lubrication && rigid::resolver_model(contacts.resolver).lubricates;
  }
  /// Something besides the sides of the domain bounds the fluid.
  bool has_surfaces() const { return has_bodies() || !walls.empty(); }
};

/// An entry of [[bodies]] or [[fill]] as a whole.
struct Entry : EntrySpec {
  std::string key;  // "bodies[2]", "fill[0]"
  rigid::Motion motion = rigid::Motion::free;
  rigid::Vec3 angular_velocity = rigid::Vec3::Zero();
  std::uint64_t count = 0;  // 0: as many as a fill has sites for

  bool smallest = true, largest = true;  // of the sizes of its fill, each of which is an entry

  bool is_free() const { return motion == rigid::Motion::free; }
  bool moves() const { return velocity.norm() + angular_velocity.norm() > 0; }
};
std::vector<Entry> entries_of(const Case&);

// The domain of a case as the bodies see it.

rigid::Extent extent_of(const Case&);
rigid::BoundingBox box_of(const Case&);

/// Puts a body where the case says it is: its `origin` at a point. Where that is in the domain, the centre of
/// mass is too along the periodic axes, a whole number of periods away.
void put_at(BodySpec&, const rigid::Vec3& point, const rigid::Extent&);

/// Returns the shortest of the displacements between a point and the periodic images of another.
rigid::Vec3 nearest_image(rigid::Vec3 displacement, const rigid::Extent&);

}  // namespace silt::coupler
