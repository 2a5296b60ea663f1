#pragma once
// The sections of a case file: their readers, in the order in which read_case calls them, and their checks. A
// reader takes its keys from the root table and leaves what it found in the Case or in the sections of it
// that it names; errors go to its context.
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

/// Warns of keys of a table that have no effect in the case, according to their rows.
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
void read_domain(TableReader& root, Case&);  // [units], [domain]; first, for conversions

/// Returns x, moved to the upper side of the domain if it is beyond it by no more than the tolerance of
/// domain.size.
double snapped(double x, int cells);
rigid::Vec3 snapped(const rigid::Vec3& x, const std::array<int, 3>& cells);

// fluid.cpp
std::vector<KeySection> fluid_sections();
void read_fluid(TableReader& root, Case&);  // [fluid], [coupling], [gravity]

// driving.cpp
KeySection over_time_section();
/// Reads a variation over time; constant without the key.
rigid::OverTime read_over_time(TableReader& parent, const char* key);

// heat.cpp: also reads the thermal keys of sides, bodies and walls
inline constexpr std::tuple side_heat_keys{
    HandKey{"temperature", "number", "K", "insulating", "temperature of the side, in a case with [heat]"},
    HandKey{"heat_flux", "number", "W/m²", "0",
            "heat flux from the side into the fluid, instead of temperature"}};
inline constexpr std::tuple wall_heat_keys{
    HandKey{"temperature", "number", "K", "insulating", "temperature of the surface, in a case with [heat]"}};
inline constexpr std::tuple lump_keys{
    HandKey{"heat_capacity", "number", "J/(kg K)", "none",
            "of the bodies, which then warm and cool as a whole from their temperature on; without it they "
            "keep it"},
    HandKey{"heat_source", "number", "W", "0",
            "heat that each of the bodies produces; needs a heat_capacity"}};
std::vector<KeySection> heat_sections();
void read_heat(TableReader& root, Case&);  // [heat]; after the bodies

// contacts.cpp
std::vector<KeySection> contact_sections();
void read_contacts(TableReader& root, Case&);  // [contacts], [[material_pairs]]
/// Warns of pairs of materials that never meet. Call after bodies and walls were read.
void look_for_idle_pairs(TableReader& root, const Case&);

// walls.cpp
struct ReadMotion {
  rigid::PrescribedMotion motion;
  rigid::Vec3 axis = rigid::Vec3::UnitZ();  // of rotation
  std::string table;                        // name of its file; "": none
  int table_headings = 0;
};
/// Reads the motion of a wall or body over time.
ReadMotion read_motion(TableReader&);
std::vector<KeySection> wall_sections();
void read_walls(TableReader& root, Case&);  // [[walls]]; after the materials
/// Reads the last shape of a case, of type "mesh"; returns a sphere if its file is wrong (reported).
rigid::Shape read_mesh_body(TableReader&, Case&);
/// Reads a polyhedron from a file; null if it is wrong (reported).
std::shared_ptr<const rigid::PolyhedronMesh> read_polyhedron_file(TableReader&);

// shapes.cpp
std::vector<KeySection> shape_sections();
void read_shapes(TableReader& root, Case&);  // [[shapes]]
inline constexpr std::tuple orientation_keys{
    HandKey{"orientation", "[x, y, z], [w, x, y, z], table", "1", "none",
            "rotation from the frame of the shape or file: direction of its z axis, a quaternion, or axis "
            "and angle, see below"}};
/// Reads orientation = [x, y, z], where the shape's z axis points, [w, x, y, z] or { axis, degrees }.
rigid::Quat read_orientation(TableReader&);
/// Reads the radius of a tube.
rigid::Tube read_tube(TableReader&);

// bodies.cpp
std::vector<KeySection> body_sections();
void read_bodies(TableReader& root, Case&);  // [[bodies]], [[fill]], [[outflow]]

// fill_sizes.cpp: the sizes of a [[fill]], a distribution of diameters as a short list that every rank has. A
// diameter is that of the sphere with a body's volume.
/// The share of bodies, by number, with a diameter (cells).
struct SizeShare {
  double diameter, share;
};
KeySection fill_size_section();
/// Reads the table `diameter` of a fill; empty without it or if it is wrong (reported). Cuts a continuous
/// distribution into strips of diameters in equal ratios, each with the diameter of its mean volume.
std::vector<SizeShare> read_fill_sizes(TableReader& fill);
/// Adds the shapes of all sizes to the case, and makes the fills and the bodies that continue another run
/// refer to them; the parameters have one list per entry. The largest size replaces the given shape if no
/// other body uses it.
void set_fill_sizes(Case&, const std::vector<std::vector<SizeShare>>& of_fills,
                    const std::vector<std::vector<SizeShare>>& of_continued);

// springs.cpp
std::vector<KeySection> spring_sections();
void read_springs(TableReader& root, Case&);         // [[springs]]; after the bodies
void find_spring_faults(const Case&, Diagnostics&);  // springs too stiff for a step

// coarsening.cpp
std::vector<KeySection> coarsening_sections();
void read_coarsening(TableReader& root, Case&);  // [coarsening]; after the bodies
/// Returns whether boxes of fine cells cover the whole domain; with coarser cells.
bool keeps_all_fine(const Case&);

// output.cpp, quantities.cpp
std::vector<KeySection> output_sections(), quantity_sections();
void read_output(TableReader& root, Case&);      // [run], [output]
void read_quantities(TableReader& root, Case&);  // [[quantities]]; last, as they name bodies and walls

/// Returns the indices of the known names in the list of a key.
std::vector<int> read_names(TableReader&, const char* key, const std::vector<std::string>& known,
                            std::string_view what);

/// Returns the index of the name of a key, if present and known.
std::optional<int> read_name(TableReader&, const char* key, const std::vector<std::string>& names,
                             std::string_view what);

/// Reads the name of an entry, or takes the fallback, and adds it to `names`, which must not contain it.
std::string read_new_name(TableReader&, std::vector<std::string>& names, std::string_view what,
                          const std::string& fallback = "");

/// Calls read(name, file) for the file that a key names; reports errors.
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
  int headings = 0;                    // number of lines
};

/// Reads lines of seven numbers (csv_reader.hpp) in units of the case: time, displacement x, y, z and
/// rotation vector x, y, z (radian). Needs two lines or more with increasing times. Throws
/// std::invalid_argument with the wrong line.
MotionFile read_motion_file(const std::string& text, const Units&);

// Checks of a case: each adds errors and warnings with remedies to Diagnostics.
void find_domain_faults(const Case&, Diagnostics&);  // cells, blocks, sides, inlets and outlets
void find_fluid_faults(const Case&, Diagnostics&);  // relaxation time, viscosity, cell Reynolds number, start
void find_heat_faults(const Case&, Diagnostics&);   // features that exclude heat, cell Péclet number
void find_contact_faults(const Case&, Diagnostics&);  // coefficients, margin, lubrication
void find_run_faults(const Case&, Diagnostics&);  // length, what becomes steady, output of what is not there
void find_density_faults(const Case&, Diagnostics&);   // of fluid and bodies, and mistakes of units
void find_quantity_faults(const Case&, Diagnostics&);  // for what is missing or too short a run
void find_wall_faults(const Case&, Diagnostics&);      // room, periodic borders, speed
void find_body_faults(const Case&, Diagnostics&);      // sizes, backend, room in fills
void find_turnover_faults(const Case&, Diagnostics&);  // bodies that arrive and leave
void find_driving_faults(const Case&, Diagnostics&);   // gravity, body force and resulting speeds
void find_coarsening_faults(const Case&,
                            Diagnostics&);           // sizes and intervals must fit coarse cells
void find_idle_sections(const Case&, Diagnostics&);  // sections without effect

}  // namespace silt
