// Runs that go on from a checkpoint, with the case and the files that they began with.
#include <gtest/gtest.h>
#include <mpi.h>

#include <fstream>

#include "rigid/shapes/shape.hpp"
#include "silt/case/case_file.hpp"
#include "silt/results/build_info.hpp"
#include "silt/results/checkpoint.hpp"
#include "tests/adapters/hdf5/scratch.hpp"
#include "tests/errors.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/world.hpp"

namespace silt::testing {
namespace {

using tests::rank;
using tests::ranks;
using tests::Scratch;

Case resumed(const adapters::CheckpointReader& reader, const std::filesystem::path& directory,
             const Overrides& overrides) {
  CaseSource source = read_source(directory);
  return case_to_resume(read_origin(reader), source, overrides);
}

TEST(Resume, AChangedCaseIsNotResumed) {
  const Scratch scratch;
  CaseText text;
  text.fluid.clear();
  const auto directory = scratch / "case";
  if (rank() == 0) {
    std::filesystem::create_directory(directory);
    std::ofstream(directory / "case.toml") << text.text();
  }
  MPI_Barrier(MPI_COMM_WORLD);
  const Case scene = read_case(directory, {"contacts.friction=0.25"});
  Simulation simulation(scene, MPI_COMM_WORLD);
  const auto path = write_checkpoint(simulation, {Quantities(scene)}, scratch.path(),
                                     provenance_of(scene, ranks(), "auto"));
  const adapters::CheckpointReader reader(MPI_COMM_WORLD, path);
  const Case again = resumed(reader, directory, {"run.steps=900"});
  EXPECT_EQ(again.steps, 900);
  EXPECT_EQ(again.pair_materials[0].friction, 0.25) << "--set of the first run is kept";
  EXPECT_TEXT(error_of([&] { resumed(reader, directory, {"contacts.friction=0.5"}); }),
              "start another case from these results ([initial] from)");
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank() == 0) {
    std::string changed = text.text();
    changed.replace(changed.find("radius = 4"), 10, "radius = 3");
    std::ofstream(directory / "case.toml") << changed;
  }
  MPI_Barrier(MPI_COMM_WORLD);
  const std::string error = error_of([&] { resumed(reader, directory, {}); });
  EXPECT_TEXT(error, "has changed");
  EXPECT_TEXT(error, "radius = 4");
}

constexpr const char* tetrahedron_stl = R"(solid rock
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 8 0 vertex 8 0 0 endloop endfacet
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 8 0 0 vertex 0 0 8 endloop endfacet
facet normal 0 0 0 outer loop vertex 8 0 0 vertex 0 8 0 vertex 0 0 8 endloop endfacet
facet normal 0 0 0 outer loop vertex 0 8 0 vertex 0 0 0 vertex 0 0 8 endloop endfacet
endsolid rock
)";

TEST(Resume, ARunGoesOnOnlyWithTheFilesItBeganWith) {
  const tests::Scratch scratch;
  const auto directory = scratch / "case";
  const auto write = [&](const std::string& stl) {
    MPI_Barrier(MPI_COMM_WORLD);
    if (tests::rank() == 0) {
      std::filesystem::create_directory(directory);
      CaseText c;
      c.fluid.clear();
      c.shapes = "[[shapes]]\nname = \"ball\"\ntype = \"polyhedron\"\nfile = \"rock.stl\"\nscale = 0.5\n";
      std::ofstream(directory / "case.toml") << c.text();
      std::ofstream(directory / "rock.stl") << stl;
    }
    MPI_Barrier(MPI_COMM_WORLD);
  };
  write(tetrahedron_stl);
  const Case scene = read_case(directory);
  EXPECT_NEAR(rigid::mass_properties(scene.shapes[0]).volume, 4 * 4 * 4 / 6., 1e-12);
  EXPECT_TEXT(scene.text, "\n# file rock.stl: ");
  Simulation simulation(scene, MPI_COMM_WORLD);
  const auto path = write_checkpoint(simulation, {Quantities(scene)}, scratch.path(),
                                     provenance_of(scene, tests::ranks(), "auto"));
  const adapters::CheckpointReader reader(MPI_COMM_WORLD, path);
  EXPECT_EQ(resumed(reader, directory, {}).files, scene.files);
  std::string changed = tetrahedron_stl;
  changed.replace(changed.find("0 0 8"), 5, "0 0 7");
  while (changed.find("0 0 8") != changed.npos) changed.replace(changed.find("0 0 8"), 5, "0 0 7");
  write(changed);
  const std::string error = error_of([&] { resumed(reader, directory, {}); });
  EXPECT_TEXT(error,
              "a file has changed since the checkpoint was written: it was " + scene.files[0] + "; it is ");
}

/// The others need nothing but what rank 0 has read.
TEST(CaseSource, IsReadOnce) {
  const tests::Scratch scratch;
  const auto directory = scratch / "case";
  CaseSource source;
  if (tests::rank() == 0) {
    std::filesystem::create_directory(directory);
    CaseText c;
    c.shapes = shape_of("ball", "polyhedron", "file = \"rock.stl\"");
    std::ofstream(directory / "case.toml") << c.text();
    std::ofstream(directory / "rock.stl") << tetrahedron_stl;
    source = read_source(directory);
    read_case(source);
    std::filesystem::remove_all(directory);
  }
  broadcast(MPI_COMM_WORLD, source);
  const Case scene = read_case(source);
  EXPECT_NEAR(rigid::mass_properties(scene.shapes[0]).volume, 8 * 8 * 8 / 6., 1e-12);
  ASSERT_EQ(scene.files.size(), 1u);
  EXPECT_TRUE(scene.files[0].starts_with("rock.stl: ")) << scene.files[0];
}

}  // namespace
}  // namespace silt::testing
