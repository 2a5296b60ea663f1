// The marking of cells as a card runs it, with plain numbers and teams of threads, against the kernels of the
// processor: the same cells.
#define SILT_BUILD plain
#define SILT_SCALAR
#define SILT_AT_ONCE
#include <gtest/gtest.h>

#include "coupler/mapping/mark_cells.hpp"
#include "rigid/shapes/surface_parts.hpp"
#include "tests/shape_rows.hpp"

namespace silt::coupler {
namespace {

const BitFrame frame({-12, -12, -12}, {25, 25, 25});
const PointInFrame centre{0.137, -0.411, 0.279, {-12, -12, -12}};

/// Returns the cells that mark(words) sets.
template <class Mark>
BitWindow marked(Mark&& mark) {
  BitWindow cells;
  cells.reset(frame);
  mark(cells.words());
  return cells;
}

/// Calls mark(member) for the threads of a team, one after another.
template <class Mark>
void for_members(int size, Mark&& mark) {
  for (int lane = 0; lane < size; ++lane) mark(silt::plain::Team{lane, size});
}

TEST(PlainMarking, GivesTheCellsOfTheKernels) {
  for (const tests::ShapeRow& row : tests::shape_rows()) {
    SCOPED_TRACE(std::string(row.name));
    rigid::SurfaceParts<double> surface;
    surface.reset(std::visit([](const auto& shape) { return rigid::Shape(shape); }, row.cells_wide),
                  rigid::Quat(0.7, 0.3, -0.5, 0.2).normalized());
    const rigid::SurfaceView<double> view = surface.view();
    const BitWindow expected =
        marked([&](std::uint64_t* words) { bit_kernels().mark_parts(frame, centre, view, words); });
    for (const int team : {1, 32})
      EXPECT_EQ(expected, marked([&](std::uint64_t* words) {
                  for_members(team, [&](const silt::plain::Team& member) {
                    for (int p = 0; p < view.count; ++p)
                      rigid::plain::with_kind(view.parts[p].kind, [&](auto kind) {
                        plain::mark_part<kind()>(frame, centre, view.parts[p], view.planes, words, member);
                      });
                  });
                }));
  }
}

TEST(PlainMarking, OfABallGivesTheCellsOfTheKernel) {
  for (const double radius : {0.5, 3.0, 7.3}) {
    const BitWindow expected =
        marked([&](std::uint64_t* words) { bit_kernels().mark_sphere(frame, centre, radius, words); });
    for (const int team : {1, 32})
      EXPECT_EQ(expected, marked([&](std::uint64_t* words) {
                  for_members(team, [&](const silt::plain::Team& member) {
                    plain::mark_sphere(frame, centre, radius, words, member);
                  });
                }));
  }
}

}  // namespace
}  // namespace silt::coupler
