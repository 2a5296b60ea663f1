#pragma once
// The readers of the sections of a case file, in the order read_case calls them. Each reads its keys from the
// root table and leaves what it found in the Case; errors go to the reader's context.
#include "coupler/case/case.hpp"
#include "coupler/case/case_reader.hpp"

namespace silt::coupler {

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
void read_walls(TableReader& root, Case&);  // [[walls]]; after the materials

// read_bodies.cpp
void read_contacts(TableReader& root, Case&);  // [contacts], [[materials]], [[material_pairs]]
void read_bodies(TableReader& root, Case&);    // [[bodies]]
void read_fills(TableReader& root, Case&);     // [[fill]]

// read_output.cpp
void read_run(TableReader& root, Case&);         // [run]
void read_output(TableReader& root, Case&);      // [output]
void read_quantities(TableReader& root, Case&);  // [[quantities]]

/// Returns the index into Case::material_names, 0 ("default") without the key.
int read_material_name(TableReader&, const Case&);

/// Returns the index of a name in a list; reports "unknown <what> '<name>'; did you mean ..." and gives -1 if
/// it is not there.
int index_of(TableReader&, std::string_view key, const std::string& name,
             const std::vector<std::string>& names, std::string_view what);

/// Reads the corners of `box`; the whole domain without it.
void read_box(TableReader&, const Case&, rigid::Vec3& lower, rigid::Vec3& upper);

}  // namespace silt::coupler
