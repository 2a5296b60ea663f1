// Mesh files: what is mended and what is refused.
#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>
#include <string>

#include "adapters/mesh/read_mesh.hpp"
#include "tests/adapters/mesh_texts.hpp"
#include "tests/errors.hpp"

namespace silt::adapters {
namespace {

using rigid::Vec3;

using tests::cube_corner;
using tests::cube_facets;
using tests::cube_triangles;

struct Piece {
  Vec3 at = Vec3::Zero();
  double size = 1;
};

/// Cubes as an OBJ file.
std::string obj_of(const std::vector<Piece>& pieces,
                   const std::vector<std::array<int, 3>>& triangles = cube_triangles()) {
  std::string text = "# cubes\nmtllib none.mtl\n";
  char line[100];
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    for (int i = 0; i < 8; ++i) {
      const Vec3 x = pieces[p].at + pieces[p].size * cube_corner(i);
      std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", x[0], x[1], x[2]);
      text += line;
    }
    for (const auto& t : triangles) {
      std::snprintf(line, sizeof line, "f %d/1/2 %d//3 %d\n", t[0] - 8, t[1] - 8, t[2] - 8);
      text += line;
    }
  }
  return text;
}

std::string ply_binary() {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment a cube\nelement vertex 8\nproperty float x\nproperty "
      "float y\nproperty float z\nproperty uchar red\nelement face 12\nproperty list uchar int "
      "vertex_indices\nend_header\n";
  for (int i = 0; i < 8; ++i) {
    for (int d = 0; d < 3; ++d) tests::put(bytes, float(cube_corner(i)[d]));
    tests::put(bytes, std::uint8_t{255});
  }
  for (const auto& triangle : cube_triangles()) {
    tests::put(bytes, std::uint8_t{3});
    for (const int i : triangle) tests::put(bytes, i);
  }
  return bytes;
}

using tests::error_of;
std::string error_of_obj(const std::string& text) {
  return error_of([&] { read_mesh("a.obj", text, 1); });
}

TEST(ReadMesh, DefectsAreMendedAndCounted) {
  auto triangles = cube_triangles();
  std::swap(triangles[3][0], triangles[3][1]), std::swap(triangles[8][0], triangles[8][1]);
  triangles.push_back(triangles[5]);
  triangles.push_back({0, 0, 1});
  const ReadMesh read = read_mesh("a.obj", obj_of({{}}, triangles), 1);
  EXPECT_EQ(read.closed.turned, 2u);
  EXPECT_EQ(read.welded.duplicate, 1u);
  EXPECT_EQ(read.welded.degenerate, 1u);
  EXPECT_NEAR(read.surface->mass_properties().volume, 1, 1e-15);
  for (auto& t : triangles) std::swap(t[0], t[1]);
  EXPECT_NEAR(read_mesh("a.obj", obj_of({{}}, triangles), 1).surface->mass_properties().volume, 1, 1e-15)
      << "inside out";
}

/// Two triangles back to back that enclose nothing: as a fin on an edge, as a membrane between two cubes,
/// alone; and a cube whose triangles are all there twice, each the other way about.
TEST(ReadMesh, SheetsOfNoThicknessAreLeftOut) {
  const auto read = [](std::vector<std::array<int, 3>> triangles, const char* point) {
    return read_mesh("a.obj", obj_of({{}}, triangles) + point, 1);
  };
  const auto cube = cube_triangles();
  ReadMesh found = read_mesh("a.obj", "v -1 -1 2\n" + obj_of({{}}, cube) + "f 1 -8 -7\nf -8 1 -7\n", 1);
  EXPECT_EQ(found.welded.thin, 2u);
  EXPECT_EQ(found.surface->triangles().size(), 12u);
  EXPECT_NEAR(found.surface->mass_properties().volume, 1, 1e-15);
  found = read_mesh("a.obj", obj_of({{}, {{1, 0, 0}, 1}}), 1);  // the square between them, of four triangles
  EXPECT_EQ(found.welded.thin, 4u);
  EXPECT_EQ(found.closed.shells, 1u);
  EXPECT_NEAR(found.surface->mass_properties().volume, 2, 1e-15);
  found = read_mesh("a.obj", obj_of({{}}) + "v 5 5 5\nv 6 5 5\nv 5 6 5\nf -1 -2 -3\nf -3 -2 -1\n", 1);
  EXPECT_EQ(found.welded.thin, 2u);
  EXPECT_NEAR(found.surface->mass_properties().volume, 1, 1e-15);
  auto doubled = cube;
  for (const auto& [a, b, c] : cube) doubled.push_back({a, c, b});
  found = read(doubled, "");
  EXPECT_EQ(found.welded.duplicate, 12u);
  EXPECT_NEAR(found.surface->mass_properties().volume, 1, 1e-15);
  for (std::size_t missing = 12; missing < 24; ++missing) {  // a patch of any of them
    auto patch = doubled;
    patch.erase(patch.begin() + static_cast<std::ptrdiff_t>(missing), patch.end());
    found = read(patch, "");
    EXPECT_EQ(found.welded.duplicate, missing - 12);
    EXPECT_NEAR(found.surface->mass_properties().volume, 1, 1e-15);
  }
}

/// Two cubes joined by a neck far thinner than a point at a great distance would let corners be.
TEST(ReadMesh, PointsThatNoFaceUsesDoNotCount) {
  const std::string cubes = obj_of({{}, {{1.004, 0, 0}, 1}});
  for (const char* stray : {"", "v 1e5 0 0\n", "v 0 0 -1e9\n"}) {
    const ReadMesh read = read_mesh("a.obj", stray + cubes, 1);
    EXPECT_EQ(read.closed.shells, 2u) << stray;
    EXPECT_NEAR(read.surface->mass_properties().volume, 2, 1e-12) << stray;
  }
}

/// Numbers in single precision are 0.5 apart from 2^22 on.
TEST(ReadMesh, SaysHowFarApartSingleCoordinatesAre) {
  EXPECT_EQ(read_mesh("a.stl", tests::stl_text(cube_facets()), 1).coordinate_step, 0);
  EXPECT_EQ(read_mesh("a.obj", obj_of({{}}), 1).coordinate_step, 0);
  EXPECT_EQ(read_mesh("a.ply", ply_binary(), 3).coordinate_step, 3 * 0x1p-23);
  std::string far = tests::stl_binary(cube_facets());
  for (std::size_t t = 0; t < 12; ++t)
    for (std::size_t k = 3; k < 12; ++k) {
      float x;
      std::memcpy(&x, far.data() + 84 + 50 * t + 4 * k, 4);
      x = 5.2e6f + 8 * x;
      std::memcpy(far.data() + 84 + 50 * t + 4 * k, &x, 4);
    }
  EXPECT_EQ(read_mesh("a.stl", far, 2).coordinate_step, 1);
}

/// A cube in a hollow of a cube, and one beside: outward, inward, outward again.
TEST(ReadMesh, ShellsAreTurnedByWhatIsAroundThem) {
  const ReadMesh read =
      read_mesh("a.obj", obj_of({{{0, 0, 0}, 8}, {{1, 1, 1}, 4}, {{2, 2, 2}, 1}, {{20, 0, 0}, 2}}), 1);
  EXPECT_EQ(read.closed.shells, 4u);
  EXPECT_EQ(read.closed.hollows, 1u);
  EXPECT_NEAR(read.surface->mass_properties().volume, 512 - 64 + 1 + 8, 1e-11);
  EXPECT_TRUE(read.surface->encloses(Vec3(0.5, 4, 4)));
  EXPECT_FALSE(read.surface->encloses(Vec3(1.5, 4, 4)));
  EXPECT_TRUE(read.surface->encloses(Vec3(2.5, 2.5, 2.5)));
}

TEST(ReadMesh, NearlyEqualCornersAreOne) {
  std::string bytes = tests::stl_binary(cube_facets());
  const float off = 1 + 5e-8f * 2;  // of the first corner that is 1
  for (std::size_t at = 84 + 12; at + 4 <= 84 + 48; at += 4) {
    float x;
    std::memcpy(&x, bytes.data() + at, 4);
    if (x != 1) continue;
    std::memcpy(bytes.data() + at, &off, 4);
    break;
  }
  EXPECT_EQ(read_mesh("a.stl", bytes, 1).surface->vertices().size(), 8u);
}

TEST(ReadMesh, WhatCannotBeMendedIsNamedWithItsPlace) {
  auto open = cube_triangles();
  open.pop_back();
  EXPECT_TEXT(error_of_obj(obj_of({{}}, open)), "3 edges, the first from [0, 0, 1]");
  const std::string touching = error_of_obj(obj_of({{}, {{1, 1, 0}, 1}}));
  EXPECT_TEXT(touching, "more than two triangles meet in 1 edge, from [1, 1, 0] to [1, 1, 1]");
  // a Moebius strip doubled to have no rim has one side only: here a projective plane of ten triangles
  std::string plane;
  for (const char* v : {"0 0 0", "1 0 0.3", "0 1 0.7", "1 1 1.1", "0.4 0.5 2", "0.7 0.2 -1"})
    plane += std::string("v ") + v + '\n';
  for (const char* f :
       {"1 2 3", "1 3 4", "1 4 5", "1 5 6", "1 6 2", "2 3 5", "3 4 6", "4 5 2", "5 6 3", "6 2 4"})
    plane += std::string("f ") + f + '\n';
  EXPECT_TEXT(error_of_obj(plane), "one side only");
  EXPECT_TEXT(error_of_obj("v 0 0 0\nf 1 2 3\n"), "line 2");
  EXPECT_TEXT(error_of([] { read_mesh("a.step", "", 1); }), ".stl, .obj or .ply");
  std::string flat = obj_of({{}});
  EXPECT_TEXT(error_of([&] {
                read_mesh("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\nf 1 2 3\nf 1 3 2\n", 1);
              }),
              "lie back to back");
}

/// A header may claim anything: nothing is set aside for it.
TEST(ReadMesh, AHeaderAloneIsNotBelieved) {
  std::string stl(84, '\0');
  const std::uint32_t claimed = 4'000'000'000;
  std::memcpy(stl.data() + 80, &claimed, 4);
  EXPECT_TEXT(error_of([&] { read_mesh("a.stl", stl, 1); }), "cut off");
  for (const char* format : {"ascii", "binary_little_endian"}) {
    const std::string ply = std::string("ply\nformat ") + format +
                            " 1.0\nelement nothing 18446744073709551615\nelement vertex 4000000000\nproperty "
                            "float x\nproperty float y\n"
                            "property float z\n"
                            "element face 4000000000\nproperty list uint int vertex_indices\nend_header\n";
    EXPECT_TEXT(error_of([&] { read_mesh("a.ply", ply, 1); }), "cut off");
  }
}

}  // namespace
}  // namespace silt::adapters
