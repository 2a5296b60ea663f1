// The fluid alone, one core and two, against what the machine can do: the paper's Tables I and III.
//
// Everything that is compared is measured in turn in one run; figures are medians of the repetitions, with
// the lowest and the highest. `share` is production over the in-place bandwidth bound (bound.hpp) of the same
// working set; production's time includes its ghost layers, the bound and the textbook kernels have none.
// Sizes are cells an edge.
//   scripts/bench fluid [--quick] [--json FILE]       (mpirun -n 2: without, the figures of two ranks are
//   left out)
#include <mpi.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <thread>

#include "lbm/fluid.hpp"
#include "lbm/isa.hpp"
#include "tests/bench/bound.hpp"

namespace silt::bench {
namespace {

/// Additions and multiplications of a cell in lbm/stream_collide_kernel.cpp, each expression once.
constexpr double flops_per_cell = 140;
constexpr double values_per_cell = 2 * lbm::directions;  // read and written

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
    for (auto& p : populations_) p.assign(arrays_.cells() * lbm::directions, T(0));
  }
  /// Without the ghost layer.
  void collide() {
    arrays_.from = populations_[now_].data(), arrays_.to = populations_[1 - now_].data();
    pull_and_relax(arrays_, variant_.layout, variant_.effort);
    now_ = 1 - now_;
  }
  void fill_ghosts() {
    const int n = arrays_.n;
    const auto wrapped = [n](int x) { return (x + n) % n; };
    for (int z = -1; z <= n; ++z)
      for (int y = -1; y <= n; ++y)
        for (int x = -1; x <= n; ++x)
          for (int i = 0; i < lbm::directions; ++i)
            leaving(x, y, z, i) = leaving(wrapped(x), wrapped(y), wrapped(z), i);
  }
  /// What has left a cell along i, or is to leave it at the start.
  T& leaving(int x, int y, int z, int i) {
    const std::ptrdiff_t cell = arrays_.cell(x, y, z);
    return populations_[now_][variant_.layout == Layout::array_of_structures ? cell * lbm::directions + i
                                                                             : cell + i * arrays_.cells()];
  }

 private:
  Variant variant_;
  TwoArrays<T> arrays_;
  std::vector<T> populations_[2];
  int now_ = 0;
};

template <class T>
lbm::Fluid<T> periodic_box(lbm::Int3 cells, bool bgk, int ranks, MPI_Comm comm) {
  const std::array<lbm::SideCondition, 6> periodic{};
  return lbm::Fluid<T>(lbm::Domain(cells, periodic, std::nullopt, ranks), {0.8, 3. / 16, bgk, {}}, comm);
}

template <class T>
void step(lbm::Fluid<T>& fluid) {
  fluid.stream_collide();
  fluid.exchange();
}

/// The textbook kernels and production have to compute the same flow before their times mean anything.
template <class T>
void require_same_flow(const Variant& variant) {
  constexpr int n = 12, steps = 5;
  auto fluid = periodic_box<T>({n, n, n}, true, 1, MPI_COMM_SELF);
  Textbook<T> book(n, variant, 0.8);
  const auto for_cells = [&](auto&& f) {
    for (int z = 0; z < n; ++z)
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) f(lbm::Int3{x, y, z});
  };
  for_cells([&](lbm::Int3 x) {
    const double k = 2 * M_PI / n, u = 0.05;
    fluid.set_equilibrium(0, x, 0.01 * std::sin(k * x.z),
                          {u * std::sin(k * x.y), u * std::cos(k * x.z), u * std::sin(k * (x.x + x.y))});
  });
  const auto wrapped = [](lbm::Int3 x) { return lbm::Int3{(x.x + n) % n, (x.y + n) % n, (x.z + n) % n}; };
  for_cells([&](lbm::Int3 x) {
    for (int i = 0; i < lbm::directions; ++i) {
      const lbm::Int3 from = wrapped(x - lbm::c[i]);
      book.leaving(from.x, from.y, from.z, i) = fluid.arriving(0, x, i);
    }
  });
  for (int t = 0; t < steps; ++t) step(fluid), book.fill_ghosts(), book.collide();
  double worst = 0;
  for_cells([&](lbm::Int3 x) {
    for (int i = 0; i < lbm::directions; ++i) {
      const lbm::Int3 from = wrapped(x - lbm::c[i]);
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

template <class T>
double peak_gflops() {
  Spread rate;
  T sink;
  for (int r = 0; r < 5; ++r) {
    double flops = 0;
    const double t = seconds([&] { flops = add_and_multiply(&sink, 2'000'000); });
    rate.add(flops / t * 1e-9);
  }
  return rate.highest();
}

/// Prints a row and adds it to the table.
template <class T>
void report(Figures& out, const char* kernel, int n, int ranks, const Spread& mlups, const Spread& bound,
            double peak) {
  const double gflops = mlups.middle() * flops_per_cell * 1e-3;
  const double gbytes = mlups.middle() * values_per_cell * sizeof(T) * 1e-3;
  const Spread share = ratio(mlups, bound);
  printf(
      "%s %3d^3 %d core%s  %-38s %6.1f MLUPS (%.1f to %.1f)  %5.1f GB/s  %5.1f GFlop/s, %2.0f %% of peak  "
      "share %.2f (%.2f to %.2f)\n",
      precision<T>, n, ranks, ranks > 1 ? "s" : " ", kernel, mlups.middle(), mlups.lowest(), mlups.highest(),
      gbytes, gflops, 100 * gflops / (ranks * peak), share.middle(), share.lowest(), share.highest());
  out.table.push_back(adapters::Json::object({{"kernel", kernel},
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
  auto fluid = periodic_box<T>({n, n, n}, false, 1, MPI_COMM_SELF);
  Bound<T> bound(fluid.blocks()[0].box().cells());
  std::vector<Textbook<T>> books;
  for (const Variant& v : variants) books.emplace_back(n, v, 0.8);
  Spread production;
  std::vector<Spread> textbook(std::size(variants));
  const int fast = steps_of(n, plan.updates), slow = steps_of(n, plan.updates / 8);
  for (int r = 0; r <= plan.repetitions; ++r) {  // the first one warms up
    if (r == 1) production = {}, textbook.assign(std::size(variants), {}), bound.forget();
    bound.sample(fast, [] {});
    production.add(fast * cells * 1e-6 / seconds([&] {
                     for (int t = 0; t < fast; ++t) step(fluid);
                   }));
    for (std::size_t k = 0; k < books.size() && r % 3 <= 1; ++k)  // they are slow: in fewer repetitions
      textbook[k].add(slow * cells * 1e-6 / seconds([&] {
                        for (int t = 0; t < slow; ++t) books[k].collide();
                      }));
  }
  for (std::size_t k = 0; k < books.size(); ++k)
    report<T>(out, variants[k].name, n, 1, textbook[k], bound.best(), peak);
  report<T>(out, "production, in place", n, 1, production, bound.best(), peak);
  report<T>(out, "bound", n, 1, bound.best(), bound.best(), peak);
  const std::string key = std::string("fluid.") + precision<T>;
  const double share = ratio(production, bound.best()).middle();
  if (n == plan.sizes[0])
    out.figures[key + ".share"] = share, out.figures[key + ".mlups"] = production.middle();
  if (n == plan.sizes[1]) out.figures[key + ".share_80"] = share;
}

/// Blocks of n^3 on each of all ranks against the bound of all of them at the same time. Returns the
/// efficiency.
template <class T>
double all_ranks(int n, int ranks, const Plan& plan, double peak, bool loud, Figures& out) {
  const double cells = double(n) * n * n * ranks;
  auto fluid = periodic_box<T>({n, n, n * ranks}, false, ranks, MPI_COMM_WORLD);
  Bound<T> bound(std::ptrdiff_t(n) * n * n);
  const auto together = [] { MPI_Barrier(MPI_COMM_WORLD); };
  const int fast = steps_of(n, plan.updates);
  Spread production;
  for (int r = 0; r <= plan.repetitions; ++r) {
    if (r == 1) production = {}, bound.forget();
    bound.sample(fast, together);
    together();
    production.add(fast * cells * 1e-6 / seconds([&] {
                     for (int t = 0; t < fast; ++t) step(fluid);
                     together();
                   }));
  }
  Spread total = bound.best();
  MPI_Allreduce(MPI_IN_PLACE, total.samples.data(), int(total.samples.size()), MPI_DOUBLE, MPI_SUM,
                MPI_COMM_WORLD);
  if (loud) report<T>(out, "production, in place", n, ranks, production, total, peak);
  return ratio(production, total).middle();
}

/// A barrier that leaves the machine to those who still work.
void wait_asleep() {
  MPI_Request request;
  MPI_Ibarrier(MPI_COMM_WORLD, &request);
  for (int done = 0; !done; MPI_Test(&request, &done, MPI_STATUS_IGNORE))
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

void run(const Options& o, int rank, int ranks) {
  require_no_others(o);
  lbm::flush_denormals_to_zero();
  const bool loud = rank == 0;
  const Plan plan = o.quick ? Plan{{48, 32, 16}, 3, 1} : Plan{{160, 80, 40}, 7, 25};
  Figures out;
  double peak[2] = {1, 1};
  if (loud) {
    for (const Variant& v : variants) require_same_flow<float>(v), require_same_flow<double>(v);
    peak[0] = peak_gflops<float>(), peak[1] = peak_gflops<double>();
    printf("%s, peak %.0f GFlop/s single, %.0f double\n", lbm::instruction_set(), peak[0], peak[1]);
    for (const int n : plan.sizes)
      one_core<float>(n, plan, peak[0], out), one_core<double>(n, plan, peak[1], out);
  }
  wait_asleep();
  if (ranks > 1) {
    const int n = plan.sizes[0], small = plan.sizes[1];
    const double single = all_ranks<float>(n, ranks, plan, peak[0], loud, out);
    all_ranks<double>(n, ranks, plan, peak[1], loud, out);
    all_ranks<float>(small, ranks, plan, peak[0], loud, out);
    all_ranks<double>(small, ranks, plan, peak[1], loud, out);
    if (ranks == 2) out.figures["fluid.two_rank_efficiency"] = single;
  }
  if (loud) out.write(o.json);
}

}  // namespace
}  // namespace silt::bench

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  setvbuf(stdout, nullptr, _IOLBF, 0);
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  try {
    silt::bench::run(silt::bench::options_of(argc, argv), rank, ranks);
  } catch (const std::exception& e) {
    fprintf(stderr, "%s\n", e.what());
    MPI_Abort(MPI_COMM_WORLD, 2);
  }
  MPI_Finalize();
}
