#pragma once
// A case as data: everything case.toml says, in lattice units (cell = step = reference density = 1); `units`
// keeps the conversions for output. case_file reads it (through adapters/toml), case_check checks it.
// Sections that are used alone have their own headers.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "coupler/spec/flow_spec.hpp"
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/response/contact_resolver.hpp"
#include "rigid/shapes/shape_fwd.hpp"
#include "silt/case/case_error.hpp"
#include "silt/case/output_spec.hpp"
#include "silt/case/position_file.hpp"
#include "silt/case/quantity_spec.hpp"
#include "silt/case/units.hpp"

namespace silt {

struct Case;

/// Returns the number of steps: sound crosses the longest side twice, or once along a periodic axis. 0 if the
/// case turns it off, if fluid or inlets do not start at rest, or without a weight, spring or body force.
std::int64_t quiet_start_steps(const Case&);

/// Returns whether the fluid, its inlets and a continued state start at rest; needs a fluid.
bool begins_at_rest(const Case&);

// The bodies: [[bodies]], [[fill]] and [[outflow]].

inline constexpr auto motion_names = coupler::names_of<rigid::Motion>("free", "fixed", "prescribed");

/// The properties common to the bodies of an entry of [[bodies]] or [[fill]].
struct EntrySpec {
  int shape = 0, material = 0;
  int kind = 0;                                // index into Case::kind_names
  double density = 1;                          // relative to the fluid's (lattice)
  rigid::Vec3 velocity = rigid::Vec3::Zero();  // initial velocity
};

struct BodySpec : EntrySpec {
  int entry = -1;           // its [[bodies]] entry; -1: a [[fill]]
  std::uint64_t point = 0;  // of a file of positions, from 1 on; 0: placed by the case
  rigid::Motion motion = rigid::Motion::free;
  rigid::LockedAxes locked = 0;
  rigid::Pose pose;                          // of the centre of mass
  bool unit = false;                         // the orientation is exactly of unit length, as read from a file
  rigid::Vec3 origin = rigid::Vec3::Zero();  // of the shape, from the centre of mass; `position` places it
  rigid::Vec3 angular_velocity = rigid::Vec3::Zero();

  rigid::Vec3 given_position() const { return pose.to_world(origin); }
};

/// The bodies of one [[bodies]] entry with positions in a file.
struct FiledBodies {
  BodySpec alike;                     // except for what the file gives; of its velocities the largest
  std::optional<rigid::Pose> placed;  // of the file as a whole
  PositionFile positions;
  PositionContents contents;
};

enum class Arrangement { random, simple_cubic, hexagonal };
inline constexpr auto arrangement_names =
    coupler::names_of<Arrangement>("random", "simple-cubic", "hexagonal");

/// A size of bodies in a fill.
struct FillSize {
  int shape;     // index into Case::shapes
  double up_to;  // cumulative share of bodies, by number, up to this size
};

struct FillSpec : EntrySpec {   // the shape is that of the largest size
  std::vector<FillSize> sizes;  // ascending; one if all bodies are alike
  std::int64_t count = 0;       // 0: all sites of an ordered arrangement
  double gap = 0;               // least distance between bounding spheres and to walls
  Arrangement arrangement = Arrangement::random;
  double spacing = 0;    // of sites; 0: the least
  double shift = 0;      // largest displacement from a site
  bool aligned = false;  // else random orientations
  rigid::BoundingBox box{rigid::Vec3::Zero(), rigid::Vec3::Zero()};
  std::uint64_t seed = 1;
  std::int64_t every = 0;  // steps between applications; 0: at the start only

  /// Returns whether the fill is applied again before step `steps_done + 1`.
  bool applies_after(std::int64_t steps_done) const {
    return every > 0 && steps_done > 0 && steps_done % every == 0;
  }
};

/// Bodies of an entry of [[bodies]] that come from another run, where the sizes may be those of a fill.
struct ContinuedSpec : BodySpec {
  std::vector<FillSize> sizes;
};

/// A box that removes free bodies as soon as their centre of mass is inside.
struct OutflowSpec {
  rigid::BoundingBox box{rigid::Vec3::Zero(), rigid::Vec3::Zero()};
};

/// Starts the run from the end of another.
struct StartSpec {
  std::string from;                            // a folder of results or a checkpoint, relative to the case
  rigid::Vec3 position = rigid::Vec3::Zero();  // of the other run's origin; then only its bodies are taken
};

// The sides of the domain and the curved walls in it: domain.boundary and [[walls]].

/// A file of triangles.
struct MeshFile {
  std::string file, contents;  // contents: "1280 triangles in 1 shell", and repairs
};

/// A wall of triangles from a file.
struct MeshWall : rigid::MeshWallSpec, MeshFile {
  std::string table;       // of its motion; "": none
  int table_headings = 0;  // number of heading lines
};

/// A curved wall of the domain, for fluid and bodies alike.
struct CurvedWall {
  std::string name;
  std::variant<rigid::TubeWallSpec, MeshWall> surface;

  const rigid::TubeWallSpec* tube() const { return std::get_if<rigid::TubeWallSpec>(&surface); }
  const MeshWall* mesh() const { return std::get_if<MeshWall>(&surface); }
  /// Returns whether its surface moves as prescribed; that of a tube slides along itself.
  bool moves() const {
    return std::visit([](const auto& wall) { return wall.moves(); }, surface);
  }
  /// Returns the velocities at the origin of its frame.
  rigid::PrescribedMotion::Velocity velocity_at(double time) const {
    return std::visit([&](const auto& wall) { return wall.velocity_at(time); }, surface);
  }
  /// Returns the axis of rotation; of a mesh at the start.
  rigid::Vec3 axis() const {
    return std::visit([](const auto& wall) { return wall.axis; }, surface);
  }
  rigid::Vec3 point_of_axis() const { return mesh() ? mesh()->start.position : tube()->point; }
};

/// The table [contacts]: how bodies collide.
struct ContactSpec {
  std::string backend = "auto", resolver = "sffd";
  rigid::ResolverSettings resolver_settings;
  int substeps = 1;
  double margin = 1.0;
};

/// What was read, for provenance and messages.
struct CaseRecord {
  // text: case.toml as read, then files and --set arguments as comments
  std::string title, text;
  std::vector<std::string> files;      // AttachedFile::fingerprint of each named file, in order
  std::vector<std::string> overrides;  // the --set arguments
  std::filesystem::path directory;
  std::vector<Diagnostic> warnings;     // from reading
  std::map<std::string, Place> places;  // of every key by its path: "fluid.density", "bodies[2].position"

  /// Returns the place of a key or, if it is not in the file, of the table to which it belongs.
  Place place(std::string path) const;
};

/// The materials, shapes and kinds to which the bodies of a case refer.
struct BodyCatalogue {
  // material 0 is "default": that of walls, and of bodies that name none
  std::vector<std::string> shape_names, material_names;
  rigid::ShapeList shapes;                      // each about its centre of mass
  std::map<std::string, MeshFile> meshes;       // of shapes, by their names
  std::vector<rigid::Vec3> shape_origins;       // origins of the case, in the frames of the shapes
  std::vector<rigid::Material> pair_materials;  // material_names.size()^2
  // names of [[bodies]] and [[fill]] entries ("light spheres", by default the shape's name); entries of one
  // name form a kind and have one shape
  std::vector<std::string> kind_names;
  std::vector<int> kind_shapes;
  std::vector<rigid::LockedAxes> kind_locks;            // per kind; empty: no kind has any
  std::map<int, rigid::PrescribedMotion> kind_motions;  // of kinds with a prescribed motion
};

/// The bodies of a case, and how they come and leave.
struct CaseBodies {
  std::vector<BodySpec> bodies;
  std::vector<FiledBodies> filed;
  std::optional<StartSpec> start;
  std::vector<ContinuedSpec> continued;  // of the entries whose bodies come from there; without a place
  std::vector<FillSpec> fills;
  std::vector<OutflowSpec> outflows;

  bool has_bodies() const {
    return !bodies.empty() || !filed.empty() || !fills.empty() || !continued.empty();
  }
  /// Calls f(body, count) for every given body, and once for those of a file, without a position.
  template <class F>
  void for_each_given(F&& f) const {
    for (const BodySpec& body : bodies) f(body, std::uint64_t{1});
    for (const FiledBodies& file : filed) f(file.alike, file.contents.points);
  }
  /// Returns whether a test holds for bodies of any [[bodies]] entry, those of another run included.
  template <class Test>
  bool any_given(Test&& test) const {
    return std::ranges::any_of(bodies, test) || std::ranges::any_of(continued, test) ||
           std::ranges::any_of(filed, [&](const FiledBodies& file) { return test(file.alike); });
  }
  bool has_free_bodies() const {
    const auto free = [](const BodySpec& body) { return body.motion == rigid::Motion::free; };
    return !fills.empty() || any_given(free);
  }
  bool bodies_come() const {
    return std::ranges::any_of(fills, [](const FillSpec& fill) { return fill.every > 0; });
  }
  bool has_sizes() const {  // within a kind
    const auto many = [](const auto& entry) { return entry.sizes.size() > 1; };
    return std::ranges::any_of(fills, many) || std::ranges::any_of(continued, many);
  }
};

struct Case : coupler::FlowSpec, CaseRecord, BodyCatalogue, CaseBodies {
  Units units;

  ContactSpec contacts;
  rigid::Vec3 gravity = rigid::Vec3::Zero();
  rigid::OverTime gravity_over_time;
  rigid::Vec3 gravity_at(double time) const { return gravity_over_time.at(time) * gravity; }

  std::vector<coupler::SpringSpec> springs;
  std::vector<CurvedWall> walls;  // other than the sides of the domain

  std::int64_t steps = 0;
  std::optional<SteadySpec> steady;
  std::int64_t balance_every = 0;  // steps between checks of load balance; 0: none
  OutputSpec output;
  std::vector<QuantitySpec> quantities;

  bool bodies_leave() const {
    return !outflows.empty() || std::ranges::any_of(boundary, &coupler::BoundarySpec::removes_bodies);
  }
  bool has_lubrication() const {
    return fluid && coupling.lubrication && rigid::resolver_model(contacts.resolver).lubricates;
  }
  /// Returns whether bodies or curved walls bound the fluid.
  bool has_surfaces() const { return has_bodies() || !walls.empty(); }
};

/// An entry of [[bodies]] or [[fill]] as a whole; each size of a fill is an entry.
struct Entry : EntrySpec {
  std::string key;  // "bodies[2]", "fill[0]"
  rigid::Motion motion = rigid::Motion::free;
  rigid::Vec3 angular_velocity = rigid::Vec3::Zero();
  std::uint64_t count = 0;  // 0: all sites of a fill

  bool smallest = true, largest = true;  // among the sizes of its fill

  bool is_free() const { return motion == rigid::Motion::free; }
  bool moves() const { return velocity.norm() + angular_velocity.norm() > 0; }
};
std::vector<Entry> entries_of(const Case&);
/// Returns those whose bodies come from another run, each with its smallest shape and without a count.
std::vector<Entry> continued_entries_of(const Case&);

/// Returns the boxes in which bodies may arrive during the run.
std::vector<rigid::BoundingBox> entrances_of(const Case&);

/// Places the `origin` of a body at a point. If this is in the domain, the centre of mass is, too, along
/// periodic axes (shifted by whole periods).
void put_at(BodySpec&, const rigid::Vec3& point, const rigid::Extent&);

/// Returns the largest speed of sides, walls, bodies and initial fluid that a case gives, in lattice units.
double fastest_given(const Case&);

/// Returns the cell Reynolds number u / nu at this speed.
double cell_reynolds(const Case&);

/// Returns the cell Péclet number u / D at this speed; the case must have [heat].
double cell_peclet(const Case&);
/// A least and a largest temperature, less that of reference.
struct TemperatureLimits {
  double least, most;
  double difference() const { return most - least; }
};
/// Returns those that a case gives, including the reference temperature.
TemperatureLimits given_temperatures(const coupler::HeatSpec&);
/// Returns those that fluid can have: as far outside those given as these are apart, since heat that is
/// carried overshoots; where heat has other sources, the range of sums. The case must have [heat].
TemperatureLimits possible_temperatures(const Case&);

/// Returns the path of the key that says how viscous the fluid is; whether that is a viscosity.
const char* viscosity_key(const Case&);
bool gives_viscosity(const Case&);

/// Returns the largest u / nu up to which a model lasted in every scene of the map, at up to 0.1 cells a
/// step.
double measured_reynolds(lbm::Collision);

/// Resolves `fluid.collision = "auto"`: trt, the cheapest, up to its measured limit, regularised above.
void choose_collision(Case&);

/// Returns why the case has its collision model: "given", or the comparison of "auto".
std::string collision_reason(const Case&);

}  // namespace silt
