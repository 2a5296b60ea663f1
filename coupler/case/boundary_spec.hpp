#pragma once
// The sides of the domain and the curved walls in it: domain.boundary and [[walls]] of a case.
#include <string>
#include <variant>

#include "coupler/case/name_table.hpp"
#include "rigid/bodies/walls.hpp"

namespace silt::coupler {

enum class Side { x_low, x_high, y_low, y_high, z_low, z_high };
inline constexpr auto side_names = names_of<Side>("x-low", "x-high", "y-low", "y-high", "z-low", "z-high");

enum class BoundaryKind { periodic, no_slip, moving, free_slip, velocity_inlet, pressure_outlet };
inline constexpr auto boundary_names =
    names_of<BoundaryKind>("periodic", "no-slip", "moving", "free-slip", "velocity-inlet", "pressure-outlet");

/// What becomes of a body beyond a side that is open to bodies: it is taken out, or the run stops.
enum class Leaving { remove, stop };
inline constexpr auto leaving_names = names_of<Leaving>("remove", "stop");

struct BoundarySpec {
  BoundaryKind kind = BoundaryKind::periodic;
  rigid::Vec3 velocity = rigid::Vec3::Zero();  // moving walls and inlets
  double density = 1;                          // outlets
  bool solid_for_bodies = true;                // a half-space for bodies (every kind but periodic)
  Leaving leaving = Leaving::remove;           // of a side that is not solid for them
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
  std::variant<rigid::TubeSpec, MeshWall> surface;

  const rigid::TubeSpec* tube() const { return std::get_if<rigid::TubeSpec>(&surface); }
  const MeshWall* mesh() const { return std::get_if<MeshWall>(&surface); }
  /// Whether its surface moves, as prescribed; that of a tube slides along itself.
  bool moves() const {
    if (mesh()) return mesh()->motion.moves();
    return tube()->angular_velocity != 0 || tube()->velocity != 0;
  }
};

}  // namespace silt::coupler
