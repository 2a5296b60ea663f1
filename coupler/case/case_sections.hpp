#pragma once
// The readers of the sections of a case file, in the order read_case calls them. Each reads its keys from the
// root table and leaves what it found in the Case or in the sections of it that it names; errors go to the
// reader's context.
#include "coupler/case/boundary_spec.hpp"
#include "coupler/case/case_reader.hpp"
#include "coupler/case/output_spec.hpp"
#include "coupler/case/quantity_spec.hpp"
#include "rigid/shapes/polyhedron_mesh.hpp"
#include "rigid/shapes/shape_list.hpp"

namespace silt::coupler {

struct Case;

// read_domain.cpp
void read_units(TableReader& root, Case&);   // first: everything after it converts
void read_domain(TableReader& root, Case&);  // [domain]
void read_fluid(TableReader& root, Case&);   // [fluid], [coupling], [gravity]

// read_shapes.cpp
void read_shapes(TableReader& root, Case&);  // [[shapes]]
/// Reads one of orientation = [w, x, y, z], axis_angle = { axis, degrees }, axis = where the shape's z axis
/// points.
rigid::Quat read_orientation(TableReader&);
/// Reads a tube of the given radius or diameter.
rigid::Tube read_tube(TableReader&);

// read_walls.cpp
void read_walls(TableReader& root, const std::vector<std::string>& material_names,
                std::vector<CurvedWall>&);  // [[walls]]; after the materials
/// Reads `axis`: "x", "y", "z" or a direction, made a unit vector; `what` says of what.
rigid::Vec3 read_axis(TableReader&, std::string_view what);

// read_mesh_wall.cpp
/// Reads a wall of type "mesh" without its name and material; without a surface if its file is no good
/// (reported).
MeshWall read_mesh_wall(TableReader&);
/// Reads the shape of a body of type "mesh"; a sphere if its file is no good (reported).
rigid::Shape read_mesh_body(TableReader&);
/// Reads the polyhedron of a file; none if it is no good (reported).
std::shared_ptr<const rigid::PolyhedronMesh> read_polyhedron_file(TableReader&);

// read_bodies.cpp
void read_contacts(TableReader& root, Case&);  // [contacts], [[materials]], [[material_pairs]]
void read_bodies(TableReader& root, Case&);    // [[bodies]]
void read_fills(TableReader& root, Case&);     // [[fill]]
void read_outflows(TableReader& root, Case&);  // [[outflow]]

// read_output.cpp
/// What a quantity may refer to.
struct QuantityScope {
  std::array<int, 3> cells;  // of the domain
  std::vector<std::string> kind_names;
  std::vector<CurvedWall> walls;
};
void read_run(TableReader& root, std::int64_t& steps, std::optional<SteadySpec>&,
              std::int64_t& balance_every);                                                 // [run]
void read_output(TableReader& root, const std::array<int, 3>& cells, OutputSpec&);          // [output]
void read_quantities(TableReader& root, const QuantityScope&, std::vector<QuantitySpec>&);  // [[quantities]]

/// Returns the index into the names of materials, 0 ("default") without the key.
int read_material_name(TableReader&, const std::vector<std::string>& material_names);

/// Returns the index of a name in a list; reports "unknown <what> '<name>'; did you mean ..." and gives -1 if
/// it is not there.
int index_of(TableReader&, std::string_view key, const std::string& name,
             const std::vector<std::string>& names, std::string_view what);

/// Reads the corners of `box`; the whole domain, of so many cells, without it.
void read_box(TableReader&, const std::array<int, 3>& cells, rigid::Vec3& lower, rigid::Vec3& upper);

}  // namespace silt::coupler
