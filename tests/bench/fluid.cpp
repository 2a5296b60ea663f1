// The fluid alone, one core and two, against what the machine can do: the paper's Tables I and III.
//
// Everything that is compared is measured in turn in one run; figures are medians of the repetitions, with
// the lowest and the highest. Production is trt; `regularised_over_trt` is its speed over that of the model
// regularised at a low viscosity. `share` is production over the in-place bandwidth bound (bound.hpp) of the
// same working set; production's time includes its ghost layers, the bound and the textbook kernels have
// none. GFlop/s count the operations of production's cell (work.hpp) for every kernel, those of the bound its
// own. Two ranks: the same box for each, against the bound of both at the same time; their efficiency is that
// share over the share of one rank alone, taken in turn. Sizes are cells an edge.
//   scripts/bench fluid [--quick] [--json FILE]       (mpirun -n 2: without, the figures of two ranks are
//   left out)
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>

#include "tests/bench/bound.hpp"
#include "tests/bench/periodic_box.hpp"
#include "tests/bench/wait_asleep.hpp"
#include "tests/bench/work.hpp"
#include "tests/lbm/fluid_cells.hpp"

namespace silt::bench::fluid {
namespace {

struct Variant {
  const char* name;
  Layout layout;
  Effort effort;
};
constexpr Variant variants[] = {
    {"straightforward, array of structures", Layout::array_of_structures, Effort::straightforward},
    {"straightforward, structure of arrays", Layout::structure_of_arrays, Effort::straightforward},
    {"optimised, array of structures", Layout::array_of_structures, Effort::optimised},
    {"optimised, structure of arrays", Layout::structure_of_arrays, Effort::optimised}};

/// A kernel of Table I on a periodic cube.
template <class T>
class Textbook {
 public:
  Textbook(int n, const Variant& v, double relaxation_time)
      : variant_(v), arrays_{n, nullptr, nullptr, T(1 / relaxation_time)} {
    for (auto& p : populations_) p.assign(arrays_.cells() * lbm::D3Q19::directions, T(0));
  }
  /// Without the ghost layer.
  void collide() {
    arrays_.from = populations_[now_].data(), arrays_.to = populations_[1 - now_].data();
    pull_and_relax<T>()(arrays_, variant_.layout, variant_.effort);
    now_ = 1 - now_;
  }
  void fill_ghosts() {
    const int n = arrays_.n;
    const auto wrapped = [n](int x) { return (x + n) % n; };
    for (int z = -1; z <= n; ++z)
      for (int y = -1; y <= n; ++y)
        for (int x = -1; x <= n; ++x)
          for (int i = 0; i < lbm::D3Q19::directions; ++i)
            leaving(x, y, z, i) = leaving(wrapped(x), wrapped(y), wrapped(z), i);
  }
  /// Returns the population that has left a cell along i, or is to leave it at the start.
  T& leaving(int x, int y, int z, int i) {
    const std::ptrdiff_t cell = arrays_.cell(x, y, z);
    return populations_[now_][variant_.layout == Layout::array_of_structures
                                  ? cell * lbm::D3Q19::directions + i
                                  : cell + i * arrays_.cells()];
  }

 private:
  Variant variant_;
  TwoArrays<T> arrays_;
  std::vector<T> populations_[2];
  int now_ = 0;
};

constexpr lbm::CollisionSpec trt{0.8, 3. / 16, lbm::Collision::trt, {}};
constexpr lbm::CollisionSpec bgk{0.8, 3. / 16, lbm::Collision::bgk, {}};
constexpr lbm::CollisionSpec regularised{0.51, 3. / 16, lbm::Collision::regularised, {}, 0.1};

/// The textbook kernels and production have to compute the same flow before their times mean anything.
template <class T>
void require_same_flow(const Variant& variant) {
  constexpr int n = 12, steps = 5;
  auto fluid = periodic_box<T>({n, n, n}, bgk);
  Textbook<T> book(n, variant, bgk.relaxation_time);
  const auto for_cells = [&](auto&& f) {
    for (int z = 0; z < n; ++z)
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) f(lbm::Int3{x, y, z});
  };
  for_cells([&](lbm::Int3 x) {
    const double k = 2 * M_PI / n, u = 0.05;
    lbm::testing::set_equilibrium(
        fluid, 0, x, 0.01 * std::sin(k * x.z),
        {u * std::sin(k * x.y), u * std::cos(k * x.z), u * std::sin(k * (x.x + x.y))});
  });
  const auto wrapped = [](lbm::Int3 x) { return lbm::Int3{(x.x + n) % n, (x.y + n) % n, (x.z + n) % n}; };
  for_cells([&](lbm::Int3 x) {
    for (int i = 0; i < lbm::D3Q19::directions; ++i) {
      const lbm::Int3 from = wrapped(x - lbm::D3Q19::c[i]);
      book.leaving(from.x, from.y, from.z, i) = fluid.arriving(0, x, i);
    }
  });
  for (int t = 0; t < steps; ++t) {
    step(fluid);
    book.fill_ghosts();
    book.collide();
  }
  double worst = 0;
  for_cells([&](lbm::Int3 x) {
    for (int i = 0; i < lbm::D3Q19::directions; ++i) {
      const lbm::Int3 from = wrapped(x - lbm::D3Q19::c[i]);
      worst = std::max(worst, std::fabs(double(book.leaving(from.x, from.y, from.z, i)) -
                                        double(fluid.arriving(0, x, i))));
    }
  });
  if (!(worst < 50 * 0.05 * std::numeric_limits<T>::epsilon()))
    throw std::runtime_error(std::string(variant.name) + ": not the flow of production, off by " +
                             std::to_string(worst));
}

template <class T>
constexpr const char* precision = sizeof(T) == 4 ? "single" : "double";
constexpr const char *production_name = "production, in place", *bound_name = "bound",
                     *regularised_name = "production, regularised";

/// Prints a row and adds it to the table.
template <class T>
void report(Figures& out, const std::string& kernel, int n, int ranks, const Spread& mlups,
            const Spread& bound, double peak) {
  const double flops = kernel == bound_name ? lbm::D3Q19::directions : flops_per_cell;
  const double gflops = mlups.middle() * flops * 1e-3;
  const double gbytes = mlups.middle() * bytes_per_cell<T> * 1e-3;
  const Spread share = ratio(mlups, bound);
  printf(
      "%s %3d^3 %d core%s  %-38s %6.1f MLUPS (%.1f to %.1f)  %5.1f GB/s  %5.1f GFlop/s, %2.0f %% of peak  "
      "share %.2f (%.2f to %.2f)\n",
      precision<T>, n, ranks, ranks > 1 ? "s" : " ", kernel.c_str(), mlups.middle(), mlups.lowest(),
      mlups.highest(), gbytes, gflops, 100 * gflops / (ranks * peak), share.middle(), share.lowest(),
      share.highest());
  out.table.push_back(Json::object({{"kernel", kernel},
                                    {"precision", precision<T>},
                                    {"cells_an_edge", n},
                                    {"ranks", ranks},
                                    {"mlups", mlups.middle()},
                                    {"mlups_lowest", mlups.lowest()},
                                    {"mlups_highest", mlups.highest()},
                                    {"gbytes_per_second", gbytes},
                                    {"gflops", gflops},
                                    {"share_of_peak", gflops / (ranks * peak)},
                                    {"share_of_bound", share.middle()}}));
}

struct Plan {
  std::vector<int> sizes;  // cells an edge; the first is the one that counts
  int repetitions;
  double updates;  // millions of cells updated in a sample of a fast kernel
};

/// Even and odd steps alike.
int steps_of(int n, double millions) {
  return 2 * std::max(1, int(std::lround(millions * 1e6 / (2.0 * n * n * n))));
}

template <class T>
void one_core(int n, const Plan& plan, double peak, Figures& out) {
  const double cells = double(n) * n * n;
  auto fluid = periodic_box<T>({n, n, n}, trt), other = periodic_box<T>({n, n, n}, regularised);
  Bound<T> bound(fluid.blocks()[0].box().cells());
  std::vector<Textbook<T>> books;
  for (const Variant& v : variants) books.emplace_back(n, v, bgk.relaxation_time);
  Spread production, other_model;
  std::vector<Spread> textbook(std::size(variants));
  const int fast = steps_of(n, plan.updates), slow = std::max(1, fast / 8);
  for (int r = 0; r <= plan.repetitions; ++r) {  // the first one warms up
    if (r == 1) {
      production = other_model = {};
      bound.forget();
    }
    bound.sample(fast, [] {});
    production.add(fast * cells * 1e-6 / seconds([&] { step(fluid, fast); }));
    other_model.add(fast * cells * 1e-6 / seconds([&] { step(other, fast); }));
    for (std::size_t k = 0; k < books.size() && r % 2 == 1; ++k)  // they are slow: in fewer repetitions
      textbook[k].add(slow * cells * 1e-6 / seconds([&] {
                        for (int t = 0; t < slow; ++t) books[k].collide();
                      }));
  }
  for (std::size_t k = 0; k < books.size(); ++k)
    report<T>(out, variants[k].name, n, 1, textbook[k], bound.best(), peak);
  report<T>(out, production_name, n, 1, production, bound.best(), peak);
  report<T>(out, regularised_name, n, 1, other_model, bound.best(), peak);
  report<T>(out, bound_name, n, 1, bound.best(), bound.best(), peak);
  const std::string key = std::string("fluid.") + precision<T>;
  const double share = ratio(production, bound.best()).middle();
  if (n == plan.sizes[0]) {
    out.figures[key + ".share"] = share;
    out.figures[key + ".mlups"] = production.middle();
    out.figures[key + ".regularised_over_trt"] = ratio(production, other_model).middle();
  }
  if (n == plan.sizes[1]) out.figures[key + ".share_80"] = share;
}

/// Blocks of n^3, one a rank, on so many ranks of the world, and the bound of all of them at the same time.
template <class T>
class Side {
 public:
  Side(int n, int ranks, MPI_Comm comm)
      : cells_(double(n) * n * n * ranks),
        ranks_(ranks),
        comm_(comm),
        fluid_(periodic_box<T>({n, n, n * ranks}, trt, ranks, comm)),
        bound_(std::ptrdiff_t(n) * n * n) {}
  void sample(int steps) {
    const auto together = [&] { MPI_Barrier(comm_); };
    bound_.sample(steps, together);
    together();
    mlups_.add(steps * cells_ * 1e-6 / seconds([&] {
                 step(fluid_, steps);
                 together();
               }));
  }
  void forget() {
    mlups_ = {};
    bound_.forget();
  }
  int ranks() const { return ranks_; }
  const Spread& mlups() const { return mlups_; }
  /// Returns the bound of all ranks together. Collective.
  Spread bound() const {
    Spread total = bound_.best();
    MPI_Allreduce(MPI_IN_PLACE, total.samples.data(), int(total.samples.size()), MPI_DOUBLE, MPI_SUM, comm_);
    return total;
  }

 private:
  double cells_;
  int ranks_;
  MPI_Comm comm_;
  lbm::Fluid<T> fluid_;
  Bound<T> bound_;
  Spread mlups_;
};

/// All ranks and the first one alone, in turn.
template <class T>
void all_ranks(int n, int ranks, const Plan& plan, double peak, bool loud, Figures& out) {
  Side<T> all(n, ranks, MPI_COMM_WORLD);
  std::unique_ptr<Side<T>> one;
  if (loud) one = std::make_unique<Side<T>>(n, 1, MPI_COMM_SELF);
  const int steps = steps_of(n, plan.updates);
  for (int r = 0; r <= plan.repetitions; ++r) {  // the first one warms up
    if (r == 1) all.forget();
    if (r == 1 && one) one->forget();
    all.sample(steps);
    if (one) one->sample(steps);
    wait_asleep();
  }
  const Spread bound = all.bound();
  if (!loud) return;
  report<T>(out, production_name, n, ranks, all.mlups(), bound, peak);
  const Spread share = ratio(all.mlups(), bound), alone = ratio(one->mlups(), one->bound());
  const double efficiency = ratio(share, alone).middle(),
               speed_up = ratio(all.mlups(), one->mlups()).middle();
  printf(
      "%s %3d^3 a core: share of the bound on %d cores over that on one %.2f; speed-up %.2f, of the bound "
      "%.2f\n",
      precision<T>, n, ranks, efficiency, speed_up, ratio(bound, one->bound()).middle());
  if (ranks != 2) return;
  const std::string key =
      std::string("fluid.") + precision<T> + (n == plan.sizes[0] ? "" : "_" + std::to_string(n));
  out.figures[key + ".two_rank_share"] = share.middle();
  out.figures[key + ".two_rank_efficiency"] = efficiency;
  out.figures[key + ".two_rank_speed_up"] = speed_up;
  if (key == "fluid.single") out.figures["fluid.two_rank_efficiency"] = efficiency;
}

}  // namespace

void run(const Options& o) {
  require_no_others(o);
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  const bool loud = rank == 0;
  const Plan plan = o.quick ? Plan{{48, 32, 16}, 3, 1} : Plan{{160, 80, 40}, 7, 25};
  Figures out;
  double peak[2] = {1, 1};
  if (loud) {
    for (const Variant& v : variants) require_same_flow<float>(v), require_same_flow<double>(v);
    peak[0] = peak_gflops<float>(), peak[1] = peak_gflops<double>();
    printf("%s, peak %.0f GFlop/s single, %.0f double\n", instruction_set().data(), peak[0], peak[1]);
    for (const int n : plan.sizes)
      one_core<float>(n, plan, peak[0], out), one_core<double>(n, plan, peak[1], out);
  }
  wait_asleep();
  for (int size = 0; size < 2 && ranks > 1; ++size) {
    all_ranks<float>(plan.sizes[size], ranks, plan, peak[0], loud, out);
    all_ranks<double>(plan.sizes[size], ranks, plan, peak[1], loud, out);
  }
  if (loud) out.write(o.json);
}

}  // namespace silt::bench::fluid
