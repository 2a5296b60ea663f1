#pragma once
// The sections of a case file: their readers, in the order read_case calls them, and their judges. A reader
// takes its keys from the root table and leaves what it found in the Case or in the sections of it that it
// names; errors go to its context.
#include <array>
#include <string>
#include <vector>

#include "rigid/bodies/prescribed_motion.hpp"
#include "rigid/shapes/polyhedron_mesh.hpp"
#include "rigid/shapes/shape_fwd.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_file.hpp"
#include "silt/case/case_reader.hpp"

namespace silt {

inline constexpr const char* no_free_bodies = "no body of the case is free to move; remove it";

/// Warns of the keys of a table that do nothing in the case, as their rows say.
template <class... Keys>
void look_for_idle_keys(Diagnostics& findings, const std::string& table, const std::tuple<Keys...>& keys) {
  const auto judge = [&](const auto& key, const auto& rule) {
    if constexpr (requires { rule.in; })
      if (rule.in(findings.setup)) findings.idle(table + key.name, rule.text);
  };
  std::apply([&](const auto&... key) { ((judge(key, key.rule), judge(key, key.second_rule)), ...); }, keys);
}

// domain.cpp
std::vector<KeySection> domain_sections();
void read_domain(TableReader& root, Case&);  // [units], [domain]; first: everything after it converts

/// Returns x, on the upper side of the domain where it is beyond that by no more than domain.size may be.
double snapped(double x, int cells);
rigid::Vec3 snapped(const rigid::Vec3& x, const std::array<int, 3>& cells);

// fluid.cpp
std::vector<KeySection> fluid_sections();
void read_fluid(TableReader& root, Case&);  // [fluid], [coupling], [gravity]

// driving.cpp
KeySection over_time_section();
/// Reads how something changes over time; steady without the key.
rigid::OverTime read_over_time(TableReader& parent, const char* key);

// contacts.cpp
std::vector<KeySection> contact_sections();
void read_contacts(TableReader& root, Case&);  // [contacts], [[material_pairs]]
/// Warns of pairs of materials of which no two things meet; after the bodies and walls.
void look_for_idle_pairs(TableReader& root, const Case&);

// walls.cpp
struct ReadMotion {
  rigid::PrescribedMotion motion;
  rigid::Vec3 axis = rigid::Vec3::UnitZ();  // that it turns about
  std::string table;                        // the name of its file; "" without one
  int table_headings = 0;
};
/// Reads how a wall or a body moves over time.
ReadMotion read_motion(TableReader&);
std::vector<KeySection> wall_sections();
void read_walls(TableReader& root, Case&);  // [[walls]]; after the materials
/// Reads the shape of a body of type "mesh"; a sphere if its file is no good (reported).
rigid::Shape read_mesh_body(TableReader&);
/// Reads the polyhedron of a file; none if it is no good (reported).
std::shared_ptr<const rigid::PolyhedronMesh> read_polyhedron_file(TableReader&);

// shapes.cpp
std::vector<KeySection> shape_sections();
void read_shapes(TableReader& root, Case&);  // [[shapes]]
inline constexpr std::tuple orientation_keys{
    HandKey{"orientation", "[x, y, z], [w, x, y, z], table", "1", "none",
            "from the frame of the shape or file to that around it: where its z axis points, a quaternion, "
            "or a turn, see below"}};
/// Reads orientation = [x, y, z], where the shape's z axis points, [w, x, y, z] or { axis, degrees }.
rigid::Quat read_orientation(TableReader&);
/// Reads the radius of a tube.
rigid::Tube read_tube(TableReader&);

// bodies.cpp
std::vector<KeySection> body_sections();
void read_bodies(TableReader& root, Case&);  // [[bodies]], [[fill]], [[outflow]]

// fill_sizes.cpp: the sizes of a [[fill]] whose bodies differ, a distribution of diameters as a list of a
// few, which every rank knows. A diameter is that of the sphere of a body's volume.
/// This share of the bodies, by number, has this diameter (cells).
struct SizeShare {
  double diameter, share;
};
KeySection fill_size_section();
/// Reads the table `diameter` of a fill: none without it, or where it is wrong (reported). A continuous
/// distribution is cut into strips between diameters of equal ratios; all bodies of one have the diameter of
/// their mean volume.
std::vector<SizeShare> read_fill_sizes(TableReader& fill);
/// Gives the fills, and the bodies that continue another run, the shapes of their sizes, which are added to
/// those of the case: one list each. The largest takes the place of the shape that was given, where no other
/// body has that.
void set_fill_sizes(Case&, const std::vector<std::vector<SizeShare>>& of_fills,
                    const std::vector<std::vector<SizeShare>>& of_continued);

// springs.cpp
std::vector<KeySection> spring_sections();
void read_springs(TableReader& root, Case&);         // [[springs]]; after the bodies
void find_spring_faults(const Case&, Diagnostics&);  // too stiff for a step

// coarsening.cpp
std::vector<KeySection> coarsening_sections();
void read_coarsening(TableReader& root, Case&);  // [coarsening]; after the bodies, whose sizes it asks for
/// Says whether a box of fine cells covers the domain; with coarser cells.
bool keeps_all_fine(const Case&);

// output.cpp, quantities.cpp
std::vector<KeySection> output_sections(), quantity_sections();
void read_output(TableReader& root, Case&);      // [run], [output]
void read_quantities(TableReader& root, Case&);  // [[quantities]]; last: they name bodies and walls

/// Returns the indices of the names that a key lists, of those that are known.
std::vector<int> read_names(TableReader&, const char* key, const std::vector<std::string>& known,
                            std::string_view what);

/// Returns the index of the name that a key gives, if it is there, and known.
std::optional<int> read_name(TableReader&, const char* key, const std::vector<std::string>& names,
                             std::string_view what);

/// Reads the name of an entry of a list, or takes the fallback, and adds it to those before, from which it
/// must differ.
std::string read_new_name(TableReader&, std::vector<std::string>& names, std::string_view what,
                          const std::string& fallback = "");

/// Calls read(name, file) for the file that a key names; what is wrong with it is reported.
template <class Read>
void with_file(TableReader& table, std::string_view key, bool of_positions, Read&& read) {
  const auto name = table.string(key);
  if (!name) return;
  ReadContext& context = table.context();
  try {
    const AttachedFile& file = context.source->file_named(*name, of_positions);
    context.files.push_back(file.fingerprint);
    read(*name, file);
  } catch (const std::invalid_argument& error) {
    table.fail(key, "{}: '{}': {}", table.path(key), *name, error.what());
  }
}

struct MotionFile {
  std::vector<rigid::MotionRow> rows;  // in lattice units
  int headings = 0;                    // lines
};

/// Reads lines of seven numbers (csv_reader.hpp), in the units of the case: time, displacement x, y, z,
/// rotation vector x, y, z (radian). std::invalid_argument says which line is wrong; times must grow and
/// there must be two lines or more.
MotionFile read_motion_file(const std::string& text, const Units&);

// The judges of a case: they report to the Diagnostics what is wrong or doubtful, and what cures it.
void find_domain_faults(const Case&, Diagnostics&);  // cells, blocks, sides, inlets and outlets
void find_fluid_faults(const Case&, Diagnostics&);  // relaxation time, viscosity, cell Reynolds number, start
void find_contact_faults(const Case&, Diagnostics&);  // coefficients, margin, lubrication
void find_run_faults(const Case&, Diagnostics&);  // length, what becomes steady, output of what is not there
void find_density_faults(const Case&, Diagnostics&);   // of fluid and bodies, and slips of units in them
void find_quantity_faults(const Case&, Diagnostics&);  // what the case has not, or the run is too short for
void find_wall_faults(const Case&, Diagnostics&);      // room, periodic borders, speed
void find_body_faults(const Case&, Diagnostics&);      // sizes, backend, room in fills
void find_turnover_faults(const Case&, Diagnostics&);  // bodies that come and go
void find_driving_faults(const Case&, Diagnostics&);  // gravity, body force, and the speeds that come of them
void find_coarsening_faults(const Case&,
                            Diagnostics&);           // sizes and intervals that coarser cells do not divide
void find_idle_sections(const Case&, Diagnostics&);  // that do nothing in the case

}  // namespace silt
