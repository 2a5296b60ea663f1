#pragma once
// The steps from the bytes of a mesh file to a closed, oriented surface. A soup has triangles as the file
// lists them, without connectivity. Faults throw std::invalid_argument.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rigid/shapes/triangle_mesh.hpp"

namespace silt::adapters {

using Triangle = rigid::TriangleMesh::Triangle;

struct Soup {
  std::vector<rigid::Vec3> points;
  std::vector<Triangle> triangles;
  bool is_single = false;  // coordinates have single precision
};

/// Reads all solids of an STL file. It is binary if its length fits its number of triangles (some binary
/// files begin with "solid", too), otherwise text if it begins with "solid" and has no control characters.
/// Normals are ignored, since the order of the corners determines them.
Soup stl_triangles(std::string_view bytes);

/// Reads the lines `v` and `f` of a Wavefront OBJ file: vertex numbers from 1, or negative from the end, with
/// or without /texture/normal. Refuses free-form surfaces, skips other lines. Coordinates are double.
Soup obj_triangles(std::string_view text);

/// Reads a PLY file, text or binary of either byte order: x, y, z of the element `vertex`, vertex_indices (or
/// vertex_index) of `face`, and triangle strips of `tristrips`; skips all else.
Soup ply_triangles(std::string_view bytes);

/// Collects polygons before all points are known, and triangulates them.
class Polygons {
 public:
  /// `number` identifies the face in messages: its line or position.
  void add(const std::vector<std::uint32_t>& corners, std::size_t number);
  /// Adds the triangles to a soup: a fan for a convex polygon, otherwise by ear clipping in its plane
  /// (G. Meisters, Am. Math. Mon. 82 (1975) 648). Refuses a face with less than three corners, with missing
  /// or non-finite corners, or that crosses itself; messages have `what` before its number.
  void cut_into(Soup&, const std::string& what) const;

 private:
  struct Face {
    std::size_t begin, number;  // begin: in corners_
  };
  std::vector<std::uint32_t> corners_;
  std::vector<Face> faces_;
};

/// Removes points without a triangle.
void remove_unused(Soup&);

struct WeldCounts {  // numbers of removed triangles
  std::size_t degenerate = 0;
  std::size_t duplicate = 0;  // of groups of which one stays
  std::size_t thin = 0;       // of groups of which none stays: they enclose no volume
};

/// Merges points closer than `distance`, and chains of such, into the lexicographically first; removes unused
/// points, and triangles that become degenerate or coincide. Independent of the order of the points.
WeldCounts weld(Soup&, double distance);

struct SurfaceCounts {
  std::size_t turned = 0;   // triangles whose orientation was reversed
  std::size_t shells = 0;   // pieces connected by edges
  std::size_t hollows = 0;  // shells that bound a cavity
};

/// Orients all triangles counter-clockwise seen from outside: consistently within a shell, shells outward,
/// and inward inside an odd number of other shells. Shells must not intersect (not tested). Refuses an edge
/// without exactly two triangles, and a shell that is one-sided or has no volume.
SurfaceCounts close(Soup&, double scale);

// ---- words and numbers in texts from any program ----

/// Removes and returns the next word, up to white space; "" at the end of the text.
std::string_view next_word(std::string_view& text);

/// Parses a number: decimal, with an exponent after E or D (Fortran), or hexadecimal with 0x. "nan" and
/// "-1.#IND" give NaN, infinities an infinity, any other word nothing.
std::optional<double> number_in(std::string_view word);

/// Describes a word that is no finite number: "'1,5' (a decimal comma: write a point)".
std::string shown_word(std::string_view word);

/// Removes the byte order mark of UTF-8.
std::string_view without_mark(std::string_view bytes);

/// Throws std::invalid_argument, with what they are and a remedy, for bytes that are no mesh file: none, a
/// web page, a pointer of Git LFS, an archive, text in UTF-16.
void refuse_foreign(std::string_view bytes);

}  // namespace silt::adapters
