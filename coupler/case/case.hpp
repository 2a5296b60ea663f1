#pragma once
// A case as data: everything case.toml says, already in lattice units (cell = step = reference density = 1),
// with the conversions kept in `units` for what goes back out. case_file reads it (through adapters/toml),
// case_check judges it. Its sections have headers of their own: what needs one of them includes that one.
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coupler/case/body_spec.hpp"
#include "coupler/case/boundary_spec.hpp"
#include "coupler/case/case_error.hpp"
#include "coupler/case/contact_spec.hpp"
#include "coupler/case/coupling_spec.hpp"
#include "coupler/case/fluid_spec.hpp"
#include "coupler/case/output_spec.hpp"
#include "coupler/case/quantity_spec.hpp"
#include "coupler/case/units.hpp"
#include "rigid/shapes/shape_list.hpp"

namespace silt::coupler {

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
  rigid::ShapeList shapes;                 // each about its centre of mass
  std::vector<rigid::Vec3> shape_origins;  // where the origin is that the case gives each about, in its frame
  std::vector<rigid::Material> pair_materials;  // material_names.size()^2
  std::vector<BodySpec> bodies;
  std::vector<FiledBodies> filed;
  std::vector<FillSpec> fills;
  std::vector<OutflowSpec> outflows;
  std::vector<CurvedWall> walls;  // besides the sides of the domain
  // names of the [[bodies]] and [[fill]] entries ("light spheres", by default the shape's name); entries of
  // one name make one kind, and have one shape
  std::vector<std::string> kind_names;
  std::vector<int> kind_shapes;

  std::int64_t steps = 0;
  std::optional<SteadySpec> steady;
  std::int64_t balance_every = 0;  // steps between two looks at how the work is shared; 0: none
  OutputSpec output;
  std::vector<QuantitySpec> quantities;
  std::vector<Diagnostic> warnings;     // of its readers
  std::map<std::string, Place> places;  // of every key, by its path: "fluid.density", "bodies[2].position"
  /// Where a key stands; if it is not in the file, where the table that would hold it does.
  Place place(std::string path) const;
  bool has_bodies() const { return !bodies.empty() || !filed.empty() || !fills.empty(); }
  /// Calls f(body, count) for every given body, and once for all of a file, of which the position is not
  /// known.
  template <class F>
  void for_each_given(F&& f) const {
    for (const BodySpec& body : bodies) f(body, std::uint64_t{1});
    for (const FiledBodies& file : filed) f(file.alike, file.contents.points);
  }
  template <class Test>
  bool any_given(Test&& test) const {
    bool any = false;
    for_each_given([&](const BodySpec& body, std::uint64_t) { any = any || test(body); });
    return any;
  }
  bool bodies_come() const {
    return std::any_of(fills.begin(), fills.end(), [](const FillSpec& fill) { return fill.every > 0; });
  }
  bool bodies_leave() const {
    return !outflows.empty() || std::any_of(boundary.begin(), boundary.end(),
                                            [](const BoundarySpec& side) { return side.removes_bodies(); });
  }
  bool has_lubrication() const {
    return fluid && coupling.lubrication && rigid::resolver_model(contacts.resolver).lubricates;
  }
  /// Something besides the sides of the domain bounds the fluid.
  bool has_surfaces() const { return has_bodies() || !walls.empty(); }
};

}  // namespace silt::coupler
