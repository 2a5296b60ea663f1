#pragma once
// Triangles as a file has them: nothing is known of how they hang together. From the bytes of a file to a
// closed surface that knows its outside, step by step. What is wrong is said by std::invalid_argument.
#include <array>
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
  bool is_single = false;  // coordinates are in single precision
};

/// Reads an STL file, all its solids together. It is binary if its length is the one its count of triangles
/// asks for (some binary files begin with "solid" as well), else text if it begins with "solid" and holds no
/// control characters. The normals in it are not read: the order of the corners says the same.
Soup stl_triangles(std::string_view bytes);

/// Reads the lines `v` and `f` of a Wavefront OBJ file: corners by their numbers, from 1, or back from the
/// last one, with or without /texture/normal. All other lines are skipped but those of free-form surfaces,
/// which are refused. Numbers are double, which Debian's tinyobjloader's are not.
Soup obj_triangles(std::string_view text);

/// Reads x, y, z of the element `vertex` of a PLY file, and the lists vertex_indices (or vertex_index) of
/// `face`, polygons, and of `tristrips`, strips of triangles; text or binary, of either end; all else is
/// skipped. Nothing is allocated for what a header only claims.
Soup ply_triangles(std::string_view bytes);

/// Faces of any number of corners, gathered before all points are known, become triangles.
class Polygons {
 public:
  /// `number` says which one it is: its line or its place.
  void add(const std::vector<std::uint32_t>& corners, std::size_t number);
  /// Adds the triangles of all to a soup: of convex ones a fan, of others by cutting off ears in the plane of
  /// the face (G. Meisters, Am. Math. Mon. 82 (1975) 648). Refuses a face of less than three corners, of
  /// corners that are not there or not finite, or that crosses itself; `what` stands before its number.
  void cut_into(Soup&, const std::string& what) const;

 private:
  struct Face {
    std::size_t begin, number;  // begin: in corners_
  };
  std::vector<std::uint32_t> corners_;
  std::vector<Face> faces_;
};

/// Leaves out points that no triangle has.
void leave_out_unused(Soup&);

struct WeldCounts {  // triangles left out
  std::size_t degenerate = 0;
  std::size_t duplicate = 0;  // of which one stays
  std::size_t thin = 0;       // of which none stays: they enclose nothing
};

/// Points closer than `distance` (and chains of such) become the first of them in lexicographic order, points
/// that no triangle has are left out, and so are triangles that lose a corner by it and coincident ones. What
/// comes out does not depend on the order of the points.
WeldCounts weld(Soup&, double distance);

struct SurfaceCounts {
  std::size_t turned = 0;   // triangles that were the other way about
  std::size_t shells = 0;   // pieces that hang together by edges
  std::size_t hollows = 0;  // of these, those that bound a hollow of another
};

/// Turns triangles so that the whole is counter-clockwise seen from outside: within a shell as its neighbours
/// are, shells outward, but inward where an odd number of others is around them. Shells must not cut one
/// another, which is not looked for. Refuses an edge that belongs to one triangle only or to more than two,
/// and a shell that has one side only or no volume; messages tell points over `scale`.
SurfaceCounts close(Soup&, double scale);

// ---- the words and numbers of the texts that programs of all kinds write ----

/// Takes the next word, which ends at white space, off a text; "" at its end.
std::string_view next_word(std::string_view& text);

/// Reads the number that a word is: decimal, with an exponent after E or D (Fortran), or hexadecimal with 0x.
/// Words for no number ("nan", "-1.#IND") give NaN, those for infinity that, all others nothing.
std::optional<double> number_in(std::string_view word);

/// Returns what to say of a word that is no finite number: "'1,5' (a decimal comma: write a point)".
std::string shown_word(std::string_view word);

/// Takes the byte order mark of UTF-8 off.
std::string_view without_mark(std::string_view bytes);

/// Throws std::invalid_argument for bytes that are none of a surface: none at all, a page of the web, a
/// pointer of Git LFS, an archive, text in UTF-16. It says what they are and what to do.
void refuse_foreign(std::string_view bytes);

}  // namespace silt::adapters
