// What cells of two levels cost: a cube of finest cells in the middle of a periodic box of coarser ones twice
// as wide, one core.
//
// `share` is what its cells would take on uniform lattices, finest ones in both steps and coarser ones in
// one, over what it takes: the rest is the border, rows that end at it, and blocks. The uniform lattices are
// cubes of as many cells an edge as the finest ones make, taken in turn with it; figures are medians of the
// repetitions, with the lowest and the highest. Sizes are finest cells along an edge of the cube.
//   scripts/bench levels [--quick] [--json FILE]
#include <cstdio>
#include <string>

#include "lbm/levels/levels.hpp"
#include "tests/bench/figures.hpp"
#include "tests/bench/periodic_box.hpp"
#include "tests/bench/work.hpp"
#include "tests/lbm/levelled_cut.hpp"

namespace silt::bench::levels {
namespace {

constexpr lbm::CollisionSpec trt{0.8, 3. / 16, lbm::Collision::trt, {}};

template <class T>
class TwoLevels {
 public:
  explicit TwoLevels(int n) : fluid_(lbm::Domain(cut(n), {}, 1), trt, MPI_COMM_SELF), levels_(fluid_, 1) {}
  void step(int coarse_steps) {
    for (int k = 0; k < 2 * coarse_steps; ++k) {
      levels_.begin_step();
      levels_.stream_collide();
      fluid_.exchange();
      levels_.end_step();
    }
  }

 private:
  static lbm::CutTree cut(int n) {
    const auto level = [&](lbm::Int3 x) {
      for (int d = 0; d < 3; ++d)
        if (x[d] < n / 2 || x[d] >= n / 2 + n) return 1;
      return 0;
    };
    return lbm::testing::LevelledCut({2 * n, 2 * n, 2 * n}, n / 2, level).tree();
  }
  lbm::Fluid<T> fluid_;
  lbm::Levels<T> levels_;
};

template <class T>
void measure(int n, const Options& o, Figures& out) {
  const double fine = double(n) * n * n, coarse = fine - fine / 8;
  TwoLevels<T> two(n);
  auto uniform = periodic_box<T>({2 * n, 2 * n, 2 * n}, trt);
  const int steps = std::max(1, int((o.quick ? 2e6 : 3e7) / (2 * fine + coarse))),
            alone = std::max(2, steps / 4 * 2);
  Spread share;
  for (int r = 0; r <= (o.quick ? 3 : 9); ++r) {
    const double one = seconds([&] { step(uniform, alone); }) / (alone * 8 * fine);
    const double both = seconds([&] { two.step(steps); }) / steps;
    if (r > 0) share.add((2 * fine + coarse) * one / both);
  }
  const char* precision = sizeof(T) == 4 ? "single" : "double";
  printf("%s %3d^3 finest cells in %d^3 places: share %.2f (%.2f to %.2f)\n", precision, n, 2 * n,
         share.middle(), share.lowest(), share.highest());
  out.figures[std::string("levels.") + precision + ".share_" + std::to_string(n)] = share.middle();
  out.table.push_back(Json::object({{"precision", precision},
                                    {"cells_an_edge", n},
                                    {"share", share.middle()},
                                    {"share_lowest", share.lowest()},
                                    {"share_highest", share.highest()}}));
}

}  // namespace

void run(const Options& o) {
  require_no_others(o);
  Figures out;
  for (const int n : o.quick ? std::vector{32, 48} : std::vector{32, 48, 64, 96}) {
    measure<float>(n, o, out);
    measure<double>(n, o, out);
  }
  out.write(o.json);
}

}  // namespace silt::bench::levels
