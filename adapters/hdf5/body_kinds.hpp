#pragma once
// The kinds of bodies in bodies.h5: name, bounding radius, density, and their surfaces as triangle meshes.
// Layout, K kinds and P convex parts of them in all, in the order of their kinds:
//   /kinds/bounding_radius [K]   density [K]   part_kind [P]      the names are the group's attribute
//   kind_names /kinds/vertex_offset [P+1]     vertex [V][3]     part p has the vertices vertex_offset[p] ..
//   vertex_offset[p+1] /kinds/normal_offset [P+1]     normal [N][3]     ... and normals alike
//   /kinds/triangle_offset [P+1]   triangle [T][3]   triangle_normal [T][3]
// triangle holds vertices, triangle_normal normals of the same part, both counted from the part's first. The
// attributes `unit` and `meaning` of each dataset say it again. scripts/body_series.py reads it.
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace silt::adapters {

namespace hdf5 {
class File;
}

/// TriangleMesh is the closed surface of a piece of a body, in the frame of the body (origin at the
/// centre of mass).
struct TriangleMesh {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<double, 3>> normals;                 // unit, outward
  std::vector<std::array<std::int32_t, 3>> triangles;         // vertices, counter-clockwise seen from outside
  std::vector<std::array<std::int32_t, 3>> triangle_normals;  // of the surface at the triangles' corners
};

/// BodyKind holds what all bodies of a kind share, in the units of the case.
struct BodyKind {
  std::string name;  // "light spheres"
  double bounding_radius = 0, density = 0;
  std::vector<TriangleMesh> parts;
};

/// Writes the group /kinds; throws hdf5::Error where that fails.
void write_kinds(hdf5::File&, std::span<const BodyKind>, const std::string& length_unit,
                 const std::string& density_unit);
/// Returns the number of bytes that the meshes take in the file.
std::uint64_t mesh_bytes(std::span<const BodyKind>);

}  // namespace silt::adapters
