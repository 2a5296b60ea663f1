// STL, OBJ and PLY as programs write them: a block of 2 x 3 x 4 is read as one, or the file is refused by a
// message that says what it is.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include "adapters/mesh/read_mesh.hpp"
#include "tests/adapters/mesh_texts.hpp"
#include "tests/errors.hpp"

namespace silt::adapters::dialects {
namespace {

using rigid::Vec3;

struct Dialect {
  std::string name, file, bytes;
  std::string refusal;  // "": it holds the block, of volume 24
};

Vec3 corner(int i) {
  return {i & 1 ? 1.1 : -0.9, i & 2 ? 1.7 : -1.3, i & 4 ? 2.3 : -1.7};
}
const int quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

std::vector<tests::Facet> block() {
  return tests::cube_facets([](const Vec3& x) { return corner(int(x[0] + 2 * x[1] + 4 * x[2])); });
}

std::string replaced(std::string text, const std::string& from, const std::string& to, bool once = false) {
  std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  for (; at != text.npos; at = once ? text.npos : text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

std::string one_case(std::string text, int (*change)(int)) {
  std::transform(text.begin(), text.end(), text.begin(), [&](unsigned char c) { return char(change(c)); });
  return text;
}

std::string text_stl(const char* number = "{} {} {}", const std::string& name = "part") {
  return tests::stl_text(block(), number, name);
}
std::string binary_stl(const std::string& header = "made by a test", std::uint32_t count = 12,
                       bool swapped = false) {
  return tests::stl_binary(block(), header, count, swapped);
}

std::string points_obj(const char* form = "v {} {} {}\n") {
  std::string text;
  for (int i = 0; i < 8; ++i)
    text += fmt::format(fmt::runtime(form), corner(i)[0], corner(i)[1], corner(i)[2]);
  return text;
}
std::string faces_obj(const char* form = "f {} {} {}\n", int from = 1) {
  std::string text;
  for (const auto& [a, b, c] : tests::cube_triangles())
    text += fmt::format(fmt::runtime(form), a + from, b + from, c + from);
  return text;
}
std::string obj() {
  return points_obj() + faces_obj();
}

/// A block with a step in one edge, of ends of six corners: 24 in all.
std::string stepped_obj(const std::string& end) {
  std::string text;
  const double at[6][2] = {{0, 0}, {4, 0}, {4, 1}, {2, 1}, {2, 3}, {0, 3}};  // area 8
  for (int z = 0; z < 2; ++z)
    for (const auto& [x, y] : at) text += fmt::format("v {} {} {}\n", x, y, 3 * z);
  for (int k = 0; k < 6; ++k)
    text += fmt::format("f {} {} {} {}\n", k + 1, (k + 1) % 6 + 1, (k + 1) % 6 + 7, k + 7);
  return text + end;
}

std::string ply_header(const std::string& format, const char* type = "double",
                       const char* faces = "face 12") {
  return fmt::format(
      "ply\nformat {} 1.0\ncomment a block\nelement vertex 8\nproperty {} x\nproperty {} y\nproperty {} "
      "z\nelement {}\nproperty list uchar int vertex_indices\nend_header\n",
      format, type, type, type, faces);
}
std::string text_ply(const char* number = "{} {} {}\n") {
  std::string text = ply_header("ascii") + points_obj(number);
  return text + faces_obj("3 {} {} {}\n", 0);
}
std::string binary_ply(bool swapped) {
  std::string bytes = ply_header(swapped ? "binary_big_endian" : "binary_little_endian", "float");
  for (int i = 0; i < 8; ++i)
    for (int d = 0; d < 3; ++d) tests::put(bytes, float(corner(i)[d]), swapped);
  for (const auto& t : tests::cube_triangles()) {
    tests::put(bytes, std::uint8_t{3});
    for (const int i : t) tests::put(bytes, i, swapped);
  }
  return bytes;
}
/// Strips around the block, and its two ends, parted by -1.
std::string strips_ply() {
  return ply_header("ascii", "double", "tristrips 1") + points_obj("{} {} {}\n") +
         "20 0 4 1 5 3 7 2 6 0 4 -1 0 1 2 3 -1 4 6 5 7\n";
}

std::string unended(std::string text, const std::string& end) {
  text.resize(text.rfind(end));
  return text;
}

std::vector<Dialect> stl_dialects() {
  const std::string text = text_stl(), binary = binary_stl();
  const std::string thin =
      "  facet normal nan nan nan\n    outer loop\n      vertex 1.1 1.7 2.3\n"
      "      vertex 1.1 1.7 2.3\n      vertex 1.1 1.7 -1.7\n    endloop\n  endfacet\n";
  std::string half = replaced(text, "endsolid part\n", "");
  const std::size_t middle = half.find("  facet", half.size() / 2);
  return {
      {"Binary", "a.stl", binary, ""},
      {"BinaryThatBeginsWithSolid", "a.stl", binary_stl("solid exported by a program"), ""},
      {"BinaryWithFacetsInItsHeader", "a.stl", binary_stl("solid a\nfacet normal 0 0 1\n outer loop\n"), ""},
      {"BinaryWithColours", "a.stl", binary_stl("COLOR=\xff\x01\x01\xffMATERIAL="), ""},
      {"BinaryBigEndian", "a.stl", binary_stl("big", 12, true), ""},
      {"BinaryWithALineEndBehind", "a.stl", binary_stl("solid x") + "\r\n", ""},
      {"BinaryWithMoreBehind", "a.stl", binary + std::string(80, 'x'),
       "it has more than its triangles: as a binary file of 12"},
      {"BinaryCutOff", "a.stl", binary.substr(0, 400),
       "cut off: as a binary file of 12 triangles it would have 684 bytes, it has 400"},
      {"BinaryCount0", "a.stl", binary_stl("x", 0),
       "its count of triangles is wrong, or it is cut off: as a binary file of 0 triangles it would have 84 "
       "bytes, it has 684, as of 12"},
      {"Text", "a.stl", text, ""},
      {"TextUpperCase", "A.STL", one_case(text, ::toupper), ""},
      {"TextWithAMark", "a.stl", "\xef\xbb\xbf" + text, ""},
      {"TextWithCarriageReturns", "a.stl", replaced(text, "\n", "\r"), ""},
      {"TextWithBothLineEnds", "a.stl", replaced(text, "\n", "\r\n"), ""},
      {"TextInOneLine", "a.stl", replaced(text, "\n", " "), ""},
      {"TextWithFortransExponents", "a.stl",
       replaced(replaced(text_stl("{:.6E} {:.6E} {:.6E}"), "E+", "D+"), "E-", "D-"), ""},
      {"TextWithHexadecimalNumbers", "a.stl", replaced(text, "vertex 1.1 ", "vertex 0x1.199999999999ap+0 "),
       ""},
      {"TextWithoutAName", "a.stl", text_stl("{} {} {}", ""), ""},
      {"TextOfAnOddName", "a.stl", text_stl("{} {} {}", "endsolid facet normal vertex 1 2 3"), ""},
      {"TextOfTwoSolids", "a.stl",
       half.substr(0, middle) + "endsolid part\n\nsolid other part\n" + half.substr(middle) +
           "endsolid other part\n",
       ""},
      {"TextWithColours", "a.stl", replaced(text, "  endfacet\n", "  endfacet\n  color 0.1 0.2 0.3\n"), ""},
      {"TextWithMicrosoftsNoNumbers", "a.stl",
       replaced(text, "normal 0 0 1", "normal -1.#IND 1.#QNAN 1.#INF"), ""},
      {"TextWithATriangleThatIsALine", "a.stl", replaced(text, "endsolid", thin + "endsolid"), ""},
      {"TextWithAVertexThatIsNone", "a.stl", replaced(text, "vertex 1.1", "vertex nan", true),
       "expected a number, found 'nan'"},
      {"TextWithDecimalCommas", "a.stl", replaced(text, "1.1", "1,1"),
       "found '1,1' (a decimal comma: write a point)"},
      {"TextWithAQuadrangle", "a.stl", replaced(text, "    endloop", "      vertex 0 0 0\n    endloop", true),
       "line 7: the facet has more than three vertices"},
      {"TextCutOffInAFacet", "a.stl", unended(text, "vertex"),
       "expected 'vertex', found the end of the file"},
      {"TextInUtf16", "a.stl", "\xff\xfes" + std::string(1, '\0'), "it is text in UTF-16"},
      {"Empty", "a.stl", "", "it is empty"},
      {"PageOfTheWeb", "a.stl", "\n<!DOCTYPE html><html>404</html>", "it is a page of the web"},
      {"PointerOfGitLfs", "a.stl", "version https://git-lfs.github.com/spec/v1\noid sha256:00\n",
       "a pointer of Git LFS"},
      {"Compressed", "a.stl", "\x1f\x8b\x08", "it is compressed (gzip)"},
      {"Archive", "a.stl", "PK\x03\x04", "a zip archive"},
      {"Step", "a.stl", "ISO-10303-21;\nHEADER;", "it is STEP"},
  };
}

std::vector<Dialect> obj_dialects() {
  const std::string text = obj();
  std::string quads_text = points_obj();
  for (const auto& q : quads)
    quads_text += fmt::format("f {} {} \\\n{} {}\n", q[0] + 1, q[1] + 1, q[2] + 1, q[3] + 1);
  const std::string ends = "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n";
  return {
      {"Obj", "a.obj", text, ""},
      {"ObjWithAMark", "a.obj", "\xef\xbb\xbf" + text, ""},
      {"ObjWithCarriageReturns", "a.obj", replaced(text, "\n", "\r"), ""},
      {"ObjWithBothLineEnds", "a.obj", replaced(text, "\n", "\r\n"), ""},
      {"ObjQuadranglesInTwoLines", "a.obj", quads_text, ""},
      {"ObjWithNormalsAndTextures", "a.obj",
       points_obj() + "vn 0 0 1\nvt 0 0\n" + faces_obj("f {}/1/1 {}//1 {}/1\n"), ""},
      {"ObjCountedBack", "a.obj", points_obj() + faces_obj("f {} {} {}\n", -8), ""},
      {"ObjFacesFirst", "a.obj", faces_obj() + points_obj(), ""},
      {"ObjWithColours", "a.obj", points_obj("v {} {} {} 0.5 0.5 0.5\n") + faces_obj(), ""},
      {"ObjWithFortransExponents", "a.obj",
       replaced(points_obj("v {:.6E} {:.6E} {:.6E}\n"), "E", "D") + faces_obj(), ""},
      {"ObjWithMuchElse", "a.obj",
       "mtllib a.mtl\no part\ng sides\ns off\nusemtl grey\nl 1 2\n" + text + "# end", ""},
      {"ObjWithAPointThatIsNone", "a.obj", "v nan nan nan\n" + points_obj() + faces_obj("f {} {} {}\n", 2),
       ""},
      {"ObjFaceWithAPointThatIsNone", "a.obj", obj() + "v 0 0 nan\nf 1 2 9\n",
       "the face in line 22 has a corner with a coordinate that is not finite"},
      {"ObjConcaveFaces", "a.obj", stepped_obj(ends), ""},
      {"ObjWithDecimalCommas", "a.obj", replaced(text, ".", ","),
       "line 1: expected three numbers, found '-0,9' (a decimal comma"},
      {"ObjFaceThatCrossesItself", "a.obj", stepped_obj("f 1 3 2 6\n" + ends),
       "the face in line 19 crosses itself"},
      {"ObjFaceOfTwoCorners", "a.obj", text + "f 1 2\n", "the face in line 21 has less than three corners"},
      {"ObjCornerThatIsNotThere", "a.obj", text + "f 1 2 9\n",
       "the face in line 21 has a corner that is not one of the 8 points"},
      {"ObjFreeForm", "a.obj", "v 0 0 0\ncstype bezier\nsurf 0 1 0 1 1\n",
       "line 3: it has a free-form surface"},
      {"ObjThatIsStl", "a.obj", text_stl(), "it has 0 triangles and no points"},
      {"ObjPointsOnly", "a.obj", points_obj(), "it has 0 triangles (but points)"},
  };
}

std::vector<Dialect> ply_dialects() {
  const std::string text = text_ply();
  std::string quads_text = ply_header("ascii", "double", "face 6") + points_obj("{} {} {}\n");
  for (const auto& q : quads) quads_text += fmt::format("4 {} {} {} {}\n", q[0], q[1], q[2], q[3]);
  const std::string header = ply_header("ascii"),
                    faces_first =
                        "ply\nformat ascii 1.0\nelement face 12\nproperty list uchar int "
                        "vertex_index\nelement vertex 8\nproperty float x\n"
                        "property float y\nproperty float z\nend_header\n" +
                        faces_obj("3 {} {} {}\n", 0) + points_obj("{} {} {}\n");
  return {
      {"PlyText", "a.ply", text, ""},
      {"PlyWithAMark", "a.ply", "\xef\xbb\xbf" + text, ""},
      {"PlyWithCarriageReturns", "a.ply", replaced(text, "\n", "\r"), ""},
      {"PlyQuadrangles", "a.ply", quads_text, ""},
      {"PlyFacesFirst", "a.ply", faces_first, ""},
      {"PlyStrips", "a.ply", strips_ply(), ""},
      {"PlyLittleEndian", "a.ply", binary_ply(false), ""},
      {"PlyBigEndian", "a.ply", binary_ply(true), ""},
      {"PlyBigEndianWithBothLineEnds", "a.ply",
       replaced(binary_ply(true).substr(0, ply_header("binary_big_endian", "float").size()), "\n", "\r\n") +
           binary_ply(true).substr(ply_header("binary_big_endian", "float").size()),
       ""},
      {"PlyCutOff", "a.ply", binary_ply(true).substr(0, 300), "it is cut off"},
      {"PlyOfAnotherFormat", "a.ply", replaced(text, "ascii", "binary_middle_endian"),
       "its format is 'binary_middle_endian'"},
      {"PlyOfAnotherType", "a.ply", replaced(text, "double x", "half x"), "property 'x' that is not"},
      {"PlyWithoutZ", "a.ply", replaced(text, "property double z\n", ""), "no properties x, y and z"},
      {"PlyPointsOnly", "a.ply",
       header.substr(0, header.find("element face")) + "end_header\n" + points_obj("{} {} {}\n"),
       "it has 0 triangles (but points)"},
      {"PlyThatIsStl", "a.ply", text_stl(), "its first line is not 'ply'"},
  };
}

class MeshDialects : public ::testing::TestWithParam<Dialect> {};
INSTANTIATE_TEST_SUITE_P(Stl, MeshDialects, ::testing::ValuesIn(stl_dialects()),
                         [](const auto& i) { return i.param.name; });
INSTANTIATE_TEST_SUITE_P(Obj, MeshDialects, ::testing::ValuesIn(obj_dialects()),
                         [](const auto& i) { return i.param.name; });
INSTANTIATE_TEST_SUITE_P(Ply, MeshDialects, ::testing::ValuesIn(ply_dialects()),
                         [](const auto& i) { return i.param.name; });

TEST_P(MeshDialects, AreReadOrRefusedByName) {
  const Dialect& dialect = GetParam();
  std::string said;
  try {
    const double volume = read_mesh(dialect.file, dialect.bytes, 1).surface->mass_properties().volume;
    EXPECT_NEAR(volume, 24, 24e-6);
  } catch (const std::invalid_argument& error) {
    said = error.what();
  }
  if (dialect.refusal.empty())
    EXPECT_EQ(said, "");
  else
    EXPECT_TEXT(said, dialect.refusal);
}

}  // namespace
}  // namespace silt::adapters::dialects
