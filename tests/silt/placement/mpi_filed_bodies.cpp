// Bodies whose positions stand in files: as if the case listed them, on any ranks; what is wrong with a file
// every rank says alike, with the point.
#include "silt/placement/given_bodies.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdio>

#include "adapters/hdf5/body_series.hpp"
#include "coupler/spec/counter_random.hpp"
#include "parallel/collectives.hpp"
#include "silt/case/case_file.hpp"
#include "tests/adapters/hdf5/scratch.hpp"
#include "tests/silt/placement/placed.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

using namespace coupler;

using rigid::Vec3;
using tests::alone;
using tests::rank;
using tests::ranks;
using tests::Scratch;

constexpr int points = 60;

/// Apart from each other, in no order, some at the rims of blocks.
Vec3 point(int i) {
  const int k = 37 * i % 64;
  return {4.0 + 8 * (k % 4), 4.0 + 8 * (k / 4 % 4) + 0.1 * std::sin(i), 5.0 + 7 * (k / 16)};
}

std::string csv_line(const Vec3& x) {
  char line[128];
  std::snprintf(line, sizeof line, "%.17g, %.17g,%.17g\n", x[0], x[1], x[2]);
  return line;
}

std::string csv_of(int n) {
  std::string text = "x, y, z\n\n# the last ones are on top\n";
  for (int i = 0; i < n; ++i) text += csv_line(point(i));
  return text;
}

/// Writes a file as rank 0.
void write(const std::filesystem::path& path, const std::string& text) {
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank() == 0) std::ofstream(path, std::ios::binary) << text;
  MPI_Barrier(MPI_COMM_WORLD);
}

/// Writes the positions of all bodies at one time as a run leaves them.
void write_series(const std::filesystem::path& path) {
  adapters::BodySeries series(MPI_COMM_WORLD, path, {}, {});
  series.append(0, 0, rank() == 0 ? points : 0, [](std::size_t i) {
    adapters::BodyRow row{};
    row.id = i;
    for (int d = 0; d < 3; ++d) row.position[d] = point(int(i))[d];
    return row;
  });
}

CaseText text_of(const std::string& positions) {
  CaseText c;
  c.shapes = sphere_of("ball", 6) + sphere_of("dot", 1);
  c.bodies = body_of("ball", 1, "positions = " + positions) + fill_of("dot", 1, 20, "");
  return c;
}

std::string listed() {
  std::string list;
  for (int i = 0; i < points; ++i) list += (i ? ", [" : "[[") + csv_line(point(i)) + "]";
  return list + "]";
}

Case read(const Scratch& scratch, const CaseText& text, const Overrides& overrides = {}) {
  write(scratch / "case.toml", text.text());
  return read_case(scratch.path(), overrides);
}

std::uint64_t filed_hash(const Case& setup, MPI_Comm comm) {
  std::uint64_t sum = 0;
  place(setup, comm).for_each([&](rigid::BodyId id, const BodySpec& body) {
    std::uint64_t h = mixed(id + 1000 * body.shape);
    for (int d = 0; d < 3; ++d) h = mixed(h + std::bit_cast<std::uint64_t>(body.pose.position[d]));
    sum += h;
  });
  parallel::sum_over_ranks(comm, std::span(&sum, 1));
  return sum;
}

TEST(FiledBodies, AreThoseThatACaseWouldList) {
  const Scratch scratch;
  write(scratch / "cloud.csv", csv_of(points));
  write_series(scratch / "cloud.h5");
  const std::uint64_t expected = alone([&] { return filed_hash(text_of(listed()).read(), MPI_COMM_SELF); });
  for (const char* name : {"\"cloud.csv\"", "\"cloud.h5:/bodies/position\""})
    for (const char* blocks : {"\"auto\"", "[8, 32, 5]", "[3, 7, 32]"}) {
      const Case setup = read(scratch, text_of(name), {std::string("domain.blocks=") + blocks});
      EXPECT_EQ(count_given(setup), std::uint64_t(points));
      EXPECT_EQ(fault_of(setup, MPI_COMM_WORLD), "");
      EXPECT_EQ(filed_hash(setup, MPI_COMM_WORLD), expected) << name << ", blocks " << blocks;
    }
}

/// Bodies are placed by the origin of the shape or by its centre of mass, which a given turn puts 1 to the
/// side.
TEST(FiledBodies, ArePlacedByTheirOriginOrCentre) {
  const Scratch scratch;
  write(scratch / "cloud.csv", csv_line({8, 9, 10}));
  CaseText text;
  text.shapes = shape_of("off", "polyhedron",
                         "vertices = [[0, -1, -1], [0, 1, -1], [0, -1, 1], [0, 1, 1], [2, -1, -1], [2, 1, "
                         "-1], [2, -1, 1], [2, 1, 1]]");
  for (const bool centre : {false, true})
    for (const char* position : {"positions = \"cloud.csv\"", "position = [8, 9, 10]"}) {
      text.bodies = body_of("off", 1,
                            std::string(position) + "\norientation = { axis = [0, 0, 1], degrees = 90 }" +
                                (centre ? "\norigin = \"centre\"" : ""));
      const Case setup = read(scratch, text);
      place(setup, MPI_COMM_WORLD).for_each([&](rigid::BodyId, const BodySpec& body) {
        EXPECT_LT((body.pose.position - Vec3(8, centre ? 9 : 10, 10)).norm(), 1e-12) << position;
        EXPECT_LT((body.given_position() - Vec3(8, 9, 10)).norm(), 1e-12) << position;
      });
    }
}

/// A file as a whole: its bodies go with it, turned and on their way; fixed ones take no velocity.
TEST(FiledBodies, AreShiftedAndTurnedTogether) {
  const Scratch scratch;
  write(scratch / "bed.csv", "x,y,z,velocity.x,velocity.y,velocity.z\n4, 9, 10, 0.01, 0, 0\n");
  CaseText text = text_of(
      R"({ file = "bed.csv", position = [20, 1, 2], orientation = { axis = [0, 0, 1], degrees = 90 } })");
  for (const bool fixed : {false, true}) {
    if (fixed)
      text.bodies =
          body_of("ball", 1, "motion = \"fixed\"\n" + text.bodies.substr(text.bodies.find("positions")));
    const Case setup = read(scratch, text);
    EXPECT_EQ(fault_of(setup, MPI_COMM_WORLD), "");
    place(setup, MPI_COMM_WORLD).for_each([&](rigid::BodyId id, const BodySpec& body) {
      if (id != 1) return;
      EXPECT_LT((body.pose.position - Vec3(20 - 9, 1 + 4, 2 + 10)).norm(), 1e-12);
      EXPECT_LT((body.pose.orientation * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-12);
      EXPECT_LT((body.velocity - (fixed ? Vec3::Zero() : Vec3(0, 0.01, 0))).norm(), 1e-15);
    });
  }
}

TEST(FiledBodies, InSmallRoundsAndWithOthers) {
  const Scratch scratch;
  write(scratch / "cloud.csv", csv_of(points - 1));
  write(scratch / "one.csv", csv_line(point(points - 1)));  // fewer points than ranks
  CaseText text = text_of("\"cloud.csv\"");
  text.bodies = body_of("ball", 1, "position = [16, 31.9, 29]") + text.bodies +
                body_of("ball", 1, "positions = \"one.csv\"");
  const Case setup = read(scratch, text);
  const lbm::Domain domain = make_domain(setup, ranks());
  for (const std::size_t at_once : {1, 7, 1000}) {
    Surroundings around(setup, domain, MPI_COMM_WORLD, 2);
    std::vector<GivenBody> bodies;
    add_filed_bodies(setup, around, bodies, at_once);
    std::uint64_t own[2] = {0, 0};
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const GivenBody& body = bodies[k];
      EXPECT_TRUE(k == 0 || bodies[k - 1].id < body.id);
      EXPECT_EQ(body.own, around.is_here(body.spec.pose.position));
      EXPECT_EQ(body.spec.pose.position, point(int(body.id) - 2)) << "ids: first those that the case lists";
      EXPECT_EQ(entry_of(setup, body.id), int(body.id) == points + 1 ? 2 : 1);
      if (body.own) own[0] += 1, own[1] += body.id;
    }
    parallel::sum_over_ranks(MPI_COMM_WORLD, std::span(own));
    EXPECT_EQ(own[0], std::uint64_t(points));
    EXPECT_EQ(own[1], std::uint64_t(points) * (points + 3) / 2);
  }
}

TEST(FiledBodies, SlicesAreTheWholeFile) {
  const Scratch scratch;
  const std::string lines = csv_of(20);
  for (const std::string& text :
       {lines, lines.substr(0, lines.size() - 1), "1,2,3\r\n4,5,6\r\n" + lines.substr(lines.find('\n')),
        std::string("\xEF\xBB\xBF# five lines\r\rx,y,z\r1,2,3\r4,5,6"),
        std::string("x,y,z\r\n\r\n1,2,3\r\n\r\n"), std::string("1,2,3"), std::string("# nothing\n")}) {
    write(scratch / "a.csv", text);
    const PositionFile file = position_file("a.csv");
    const auto all = read_slice(scratch.path(), file, 0, 1);
    EXPECT_EQ(all.size(), scan(scratch.path(), file).points);
    for (int parts = 2; parts < 40; ++parts) {
      std::vector<double> joined;
      std::uint64_t lines_read = 0;
      for (int part = 0; part < parts; ++part) {
        const auto slice = read_slice(scratch.path(), file, part, parts);
        EXPECT_EQ(slice.fault, "");
        joined.insert(joined.end(), slice.numbers.begin(), slice.numbers.end());
        lines_read += slice.lines;
      }
      EXPECT_EQ(joined, all.numbers) << parts;
      EXPECT_EQ(lines_read, all.lines) << parts;
    }
  }
}

/// Returns what every rank says, the same on each.
std::string fault(const Scratch& scratch, const std::string& name) {
  std::string faults;
  const std::string unread =
      error_of([&] { faults = fault_of(read(scratch, text_of("\"" + name + "\"")), MPI_COMM_WORLD); });
  const std::string said = unread + faults;
  EXPECT_EQ(alone([&] { return std::hash<std::string>()(said); }), std::hash<std::string>()(said)) << said;
  return said;
}

TEST(FiledBodies, FaultsNameTheFileAndThePoint) {
  const Scratch scratch;
  const std::string good = csv_of(30);
  for (const char* bad : {"1, 2", "1, 2, 3, 4", "1, 2, nan", "1, 2, three", "1, 2, 3,"}) {
    write(scratch / "cloud.csv", good + bad + "\n" + csv_line({9, 9, 9}));
    EXPECT_TEXT(fault(scratch, "cloud.csv"), "line 34 of cloud.csv is \"" + std::string(bad) + "\": it ");
    EXPECT_TEXT(fault(scratch, "cloud.csv"),
                "; it must be 3 finite numbers with commas between them: x, y, z");
  }
  for (const char* bad : {"nan, 1, 2", "4;5;6", "4,5,6.O", "\"4,0\",5,6"}) {  // none is taken for headings
    write(scratch / "cloud.csv", bad + good.substr(good.find('\n')));
    EXPECT_TEXT(fault(scratch, "cloud.csv"), "line 1 of cloud.csv is \"" + std::string(bad) + "\"");
  }
  write(scratch / "cloud.csv", good + "1, 2, 40\n");
  EXPECT_TEXT(fault(scratch, "cloud.csv"),
              "bodies[0].positions, point 31 of cloud.csv is [1, 2, 40]; it must lie in the domain");
  write(scratch / "cloud.csv", "x, y, z\n");
  EXPECT_TEXT(fault(scratch, "cloud.csv"), "'cloud.csv': there is no point in it");
  EXPECT_TEXT(fault(scratch, "cloud.txt"), "'cloud.txt': it must be a CSV file");
  EXPECT_TEXT(fault(scratch, "none.csv"), "'none.csv': there is no such file");
  EXPECT_TEXT(fault(scratch, "../cloud.csv"), "it must lie in the directory of the case");
  write_series(scratch / "cloud.h5");
  EXPECT_TEXT(fault(scratch, "cloud.h5"),
              "it must be a CSV file, \"cloud.csv\", or an HDF5 file and a dataset");
  EXPECT_TEXT(fault(scratch, "cloud.h5:/points"), "cloud.h5: has no dataset /points");
  EXPECT_TEXT(fault(scratch, "cloud.h5:/bodies/id"), "dataset /bodies/id is 60; it must be n x 3 numbers");
  const std::string whole = tests::content(scratch / "cloud.h5");
  write(scratch / "cloud.h5", whole.substr(0, whole.size() / 2));
  EXPECT_TEXT(fault(scratch, "cloud.h5:/bodies/position"), "cloud.h5: cannot open the file as HDF5");
}

/// A file that changes after the case was read.
TEST(FiledBodies, AFileThatChangesIsNoticed) {
  const Scratch scratch;
  write(scratch / "cloud.csv", csv_of(30));
  const Case setup = read(scratch, text_of("\"cloud.csv\""));
  ASSERT_EQ(setup.files.size(), 1u);
  EXPECT_TRUE(setup.files[0].starts_with("cloud.csv: ")) << setup.files[0];
  write(scratch / "cloud.csv", csv_of(31));
  EXPECT_TEXT(fault_of(setup, MPI_COMM_WORLD), "cloud.csv has 31 points now, and had 30 a moment ago");
}

}  // namespace
}  // namespace silt::testing
