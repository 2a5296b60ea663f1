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

#include "coupler/spec/flow_spec.hpp"
#include "coupler/spec/spring_spec.hpp"
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

// The bodies: [[bodies]], [[fill]] and [[outflow]].

inline constexpr auto motion_names = coupler::names_of<rigid::Motion>("free", "fixed", "prescribed");

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
  BodySpec alike;                     // but for what the file says; velocities that it says: the largest
  std::optional<rigid::Pose> placed;  // of the file as a whole
  PositionFile positions;
  PositionContents contents;
};

enum class Arrangement { random, simple_cubic, hexagonal };
inline constexpr auto arrangement_names =
    coupler::names_of<Arrangement>("random", "simple-cubic", "hexagonal");

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

  /// Says whether the fill is applied again before the step that follows so many.
  bool applies_after(std::int64_t steps_done) const {
    return every > 0 && steps_done > 0 && steps_done % every == 0;
  }
};

/// Bodies of an entry of [[bodies]] that come from another run, where the sizes may be those of a fill.
struct ContinuedSpec : BodySpec {
  std::vector<FillSize> sizes;
};

/// A box out of which free bodies are taken as soon as their centre of mass is in it.
struct OutflowSpec {
  rigid::BoundingBox box{rigid::Vec3::Zero(), rigid::Vec3::Zero()};
};

/// The run begins with the end of another one.
struct StartSpec {
  std::string from;  // a folder of results, or a checkpoint; from the folder of the case
};

// The sides of the domain and the curved walls in it: domain.boundary and [[walls]].

/// A wall of triangles from a file.
struct MeshWall : rigid::MeshWallSpec {
  std::string file, contents;  // contents: "1280 triangles in 1 shell", and what was mended
  std::string table;           // of its motion; "" without one
  int table_headings = 0;      // its lines of headings
};

/// A curved wall of the domain, for fluid and bodies alike.
struct CurvedWall {
  std::string name;
  std::variant<rigid::TubeWallSpec, MeshWall> surface;

  const rigid::TubeWallSpec* tube() const { return std::get_if<rigid::TubeWallSpec>(&surface); }
  const MeshWall* mesh() const { return std::get_if<MeshWall>(&surface); }
  /// Says whether its surface moves, as prescribed; that of a tube slides along itself.
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
  rigid::Vec3 point_of_axis() const { return mesh() ? mesh()->start.position : tube()->point; }
};

/// The table [contacts] says how bodies collide.
struct ContactSpec {
  std::string backend = "auto", resolver = "sffd";
  rigid::ResolverSettings resolver_settings;
  int substeps = 1;
  double margin = 1.0;
};

struct Case : coupler::FlowSpec {
  // text: case.toml as read, then each file and each --set as a comment, for provenance
  std::string title, text;
  std::vector<std::string> files;      // that the case names: AttachedFile::fingerprint of each, in its order
  std::vector<std::string> overrides;  // the --set arguments
  std::filesystem::path directory;
  Units units;

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
  std::vector<ContinuedSpec> continued;  // of the entries whose bodies come from there; without a place
  std::vector<FillSpec> fills;
  std::vector<OutflowSpec> outflows;
  std::vector<coupler::SpringSpec> springs;
  std::vector<CurvedWall> walls;  // besides the sides of the domain
  // names of the [[bodies]] and [[fill]] entries ("light spheres", by default the shape's name); entries of
  // one name make one kind, and have one shape
  std::vector<std::string> kind_names;
  std::vector<int> kind_shapes;
  std::vector<rigid::LockedAxes> kind_locks;            // of the bodies of a kind; empty: none has any
  std::map<int, rigid::PrescribedMotion> kind_motions;  // of kinds whose bodies move by a function of time

  std::int64_t steps = 0;
  std::optional<SteadySpec> steady;
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
    return !outflows.empty() || std::ranges::any_of(boundary, &coupler::BoundarySpec::removes_bodies);
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

/// Returns the boxes in which bodies may come in while the run goes on.
std::vector<rigid::BoundingBox> entrances_of(const Case&);

/// Puts a body where the case says it is: its `origin` at a point. Where that is in the domain, the centre of
/// mass is too along the periodic axes, a whole number of periods away.
void put_at(BodySpec&, const rigid::Vec3& point, const rigid::Extent&);

/// Returns the largest speed that a case gives anything: sides, bodies, the fluid at the start; lattice
/// units.
double fastest_given(const Case&);

/// Returns the cell Reynolds number u / nu at that speed.
double cell_reynolds(const Case&);

/// Returns the path of the key that says how viscous the fluid is; whether that is a viscosity.
const char* viscosity_key(const Case&);
bool gives_viscosity(const Case&);

/// Returns the largest u / nu up to which a model lasted in every scene of the map, at up to 0.1 cells a
/// step.
double measured_reynolds(lbm::Collision);

/// Resolves `fluid.collision = "auto"`: trt, the cheapest, up to what was measured, regularised above.
void choose_collision(Case&);

/// Returns why the case has its collision model: "given", or what "auto" compared.
std::string collision_reason(const Case&);

}  // namespace silt
