// The fluid on a device, alone with walls, an outlet, levels and messages, and with layers of moving bodies
// (layers.hpp): its bits against those of the processor's kernels, its speed, the share of the speed at which
// the device's memory copies, and the time of each stage. On a machine without a graphics processor the
// device is the host, for a look.
//   scripts/bench device [--quick] [--json FILE]
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>

#include "cpu/isa.hpp"
#include "device/device.hpp"
#include "lbm/exchange/slot_exchange.hpp"
#include "tests/bench/figures.hpp"
#include "tests/bench/moving_layers.hpp"
#include "tests/bench/periodic_box.hpp"
#include "tests/lbm/levelled_cut.hpp"
#include "tests/lbm/levelled_flow.hpp"

namespace silt::bench {

void copy_on_gpu(void* to, const void* from, std::int64_t bytes);  // device_copy.cu

namespace {

/// Boxes of fluid, of one level or three: between moving walls, or with a stream from an inlet to an outlet.
lbm::testing::LevelledCut cut_in(lbm::Int3 cells, int levels) {
  return lbm::testing::LevelledCut(cells, 16, [cells, levels](lbm::Int3 x) {
    const auto inside = [&](int margin) {
      for (int d = 0; d < 3; ++d)
        if (x[d] < margin || x[d] >= cells[d] - margin) return false;
      return true;
    };
    return levels == 1 ? 0 : inside(32) ? 0 : inside(16) ? 1 : 2;
  });
}
std::array<lbm::SideCondition, 6> sides_of(bool open) {
  using lbm::SideKind;
  std::array<lbm::SideCondition, 6> sides;
  if (open) sides[0] = {SideKind::bounce, {0.03, 0, 0}, 0}, sides[1] = {SideKind::pressure, {}, 1e-3};
  if (open) sides[2].kind = sides[3].kind = SideKind::free_slip;
  sides[4] = {SideKind::bounce, {0.03, 0.01, 0}, 0};
  sides[5].kind = SideKind::bounce;
  return sides;
}

/// Returns the populations that arrive in the cells of a stirred box after some steps.
template <class T>
std::vector<T> stirred(Device device, const lbm::CollisionSpec& spec, int levels, bool open) {
  const lbm::Int3 n = levels == 1 ? lbm::Int3{64, 48, 32} : lbm::Int3{96, 80, 80};
  lbm::testing::LevelledFlow<T> flow(cut_in(n, levels).tree(), sides_of(open), spec, levels - 1,
                                     MPI_COMM_SELF, device);
  flow.set([&](const lbm::testing::Vector& x, double& rho, lbm::testing::Vector& u, auto&) {
    rho = 1e-3 * std::sin(x[0] + 2 * x[1]);
    u = {0.01 * std::sin(0.3 * x[2]), 0.02 * std::cos(0.2 * x[0]), 0};
  });
  flow.step(levels == 1 ? 21 : 12);
  std::vector<T> all;
  flow.for_all([&](lbm::Fluid<T>& fluid, int b, lbm::Int3 x, auto&, int) {
    for (int i = 0; i < lbm::D3Q19::directions; ++i) all.push_back(fluid.arriving(b, x, i));
  });
  return all;
}

template <class T>
const char* const precision_of = sizeof(T) == 4 ? "single" : "double";

template <class T, class Values>
void tell(const std::string& name, const Values& here, const Values& there, Figures& out) {
  std::int64_t unlike = here.size() != there.size();
  for (std::size_t k = 0; k < std::min(here.size(), there.size()); ++k)
    unlike += std::memcmp(&here[k], &there[k], sizeof here[k]) != 0;
  const std::string key = std::string(precision_of<T>) + "." + name;
  printf("bits %s: %lld of %zu numbers differ\n", key.c_str(), static_cast<long long>(unlike), here.size());
  out.figures["device.unlike." + key] = double(unlike);
}

/// The totals of rows of cells, long and short.
template <class T>
std::vector<std::int64_t> totals(Device device) {
  const lbm::Int3 n{100, 48, 16};
  lbm::Fluid<T> fluid(lbm::Domain(n, {}, std::nullopt, 1), {0.6, 3. / 16}, MPI_COMM_SELF, device);
  lbm::for_cells({}, n, [&](lbm::Int3 x) {
    lbm::testing::set_equilibrium(fluid, 0, x, 1e-3 * std::sin(x.x + 2.0 * x.y),
                                  {0.01 * std::sin(0.3 * x.z), 0.02 * std::cos(0.2 * x.x), 0});
  });
  std::pmr::vector<lbm::LocalRows> rows(memory_of(device));
  for (int z = 0; z < n.z; ++z)
    rows.push_back({{0, 0, z}, n.x, n.y}), rows.push_back({{z, z, z}, 1 + 2 * z, 1});
  std::pmr::vector<lbm::CellTotals> found(rows.size(), memory_of(device));
  fluid.totals(0, rows, found.data());
  std::vector<std::int64_t> all;
  for (const lbm::CellTotals& t : found) {
    all.insert(all.end(),
               {t.mass, t.momentum[0], t.momentum[1], t.momentum[2], t.energy, t.energy_rest, t.sound});
    for (const double x : {t.speed_squared, t.least_deviation, t.most_deviation})
      all.push_back(std::bit_cast<std::int64_t>(x));
  }
  return all;
}

/// The state of a case after some steps of layers in motion: links are mapped, and cells refilled.
template <class T>
std::vector<std::uint64_t> state_of(Device device, const Layers& layers) {
  Simulation simulation =
      silt::testing::simulation_of(layers.text(), MPI_COMM_SELF,
                                   {"run.device=" + std::string(device_names[int(device)]),
                                    std::string("fluid.precision=") + precision_of<T>});
  for (int t = 0; t < 30; ++t) simulation.step();
  return {simulation.hash()};
}

template <class T>
void compare_bodies(Device device, Figures& out) {
  for (const char* body : {"d6", "d10", "box", "star"})
    for (const char* scheme : {"bounce-back", "cli", "parabolic", "multireflection"}) {
      const Layers layers{'b', body, 48, scheme, "implicit", 0.03};
      tell<T>(std::string("bodies.") + body + "." + scheme, state_of<T>(Device::cpu, layers),
              state_of<T>(device, layers), out);
    }
}

template <class T>
void compare(Device device, Figures& out) {
  const auto both = [&](const std::string& name, const lbm::CollisionSpec& spec, int levels, bool open) {
    tell<T>(name, stirred<T>(Device::cpu, spec, levels, open), stirred<T>(device, spec, levels, open), out);
  };
  for (const auto& [model, tau] :
       {std::pair(lbm::Collision::trt, 0.6), std::pair(lbm::Collision::regularised, 0.51)})
    for (const double force : {0., 1e-5})
      both(std::string(model_of(model).name) + (force != 0 ? ".force" : ""),
           {tau, 3. / 16, model, {force, 0, 0}, 0.1}, 1, false);
  both("outlet", {0.6, 3. / 16}, 1, true);
  both("levels", {0.6, 1. / 6, lbm::Collision::trt, {1e-5, 0, 0}}, 3, false);
  both("levels.outlet", {0.6, 1. / 6}, 3, true);
  tell<T>("totals", totals<T>(Device::cpu), totals<T>(device), out);
}

/// Messages of the ghost layer of a block of n^3 cells, to this rank itself: packed, sent, taken apart, in
/// memory that devices share or through the processor.
template <class T>
void messages(Device device, int n, bool shared, Figures& out) {
  const std::string name = shared ? "messages.shared" : "messages";
  lbm::SlotExchange<T> slots(MPI_COMM_SELF, 7, device,
                             shared ? lbm::ranks_that_share(MPI_COMM_SELF, device) : std::vector<int>());
  std::pmr::vector<T> from(std::size_t(5) * n * n * n, memory_of(device)), to(from.size(), memory_of(device));
  for (std::size_t k = 0; k < from.size(); ++k) from[k] = T(k % 8191);
  const std::pmr::vector<const T*> sources({from.data()}, memory_of(device));
  const std::pmr::vector<T*> targets({to.data()}, memory_of(device));
  std::vector<T> expected(from.size());
  for (int i = 0; i < 5; ++i)
    for (int axis = 0; axis < 3; ++axis)
      for (int y = 0; y < n; ++y) {  // a row of a face: along y, x, x
        const int stride = axis == 0 ? n : 1, row = axis == 0 ? n * n * y : axis == 1 ? n * n * y + n : n * y;
        const lbm::SlotRun run{0, std::uint32_t(i * n * n * n + row), stride, std::uint32_t(n)};
        slots.sent(0).add(run), slots.received(0).add(run);
        for (int x = 0; x < n; ++x) expected[run.first + x * stride] = from[run.first + x * stride];
      }
  Spread rate;
  for (int r = 0; r < 9; ++r) {
    const double t = seconds([&] { slots.start(sources), slots.finish(sources, targets); });
    if (r > 1) rate.add(double(slots.message_bytes()) / t);
  }
  tell<T>(name, expected, std::vector<T>(to.begin(), to.end()), out);
  printf("%s of a block of %d^3: %.2f GB/s\n", name.c_str(), n, rate.middle() * 1e-9);
  out.figures["device." + name + "." + precision_of<T> + ".bytes_a_second"] = rate.middle();
}

/// A cube of finest cells in the middle of coarser ones: updates of cells in a second.
template <class T>
void measure_levels(Device device, int n, Figures& out) {
  const lbm::CutTree tree = cut_in({n, n, n}, 3).tree();
  lbm::testing::LevelledFlow<T> flow(tree, {}, {0.8, 1. / 6}, 2, MPI_COMM_SELF, device);
  double updates = 0;  // in a finest step
  for (int level = 0; level < 3; ++level)
    for (const auto& block : flow.levels.fluid(level).blocks())
      updates += double(block.box().cells()) / (1 << level);
  const int steps = device == Device::gpu ? 40 : 4;
  flow.step(4);
  Spread mlups;
  for (int r = 0; r < 5; ++r) mlups.add(steps * updates / seconds([&] { flow.step(steps); }) * 1e-6);
  const char* const precision = precision_of<T>;
  printf("%s, three levels in %d^3: %.0f MLUPS (%.0f to %.0f)\n", precision, n, mlups.middle(),
         mlups.lowest(), mlups.highest());
  out.figures[std::string("device.levels.") + precision + "." + std::to_string(n) + ".mlups"] =
      mlups.middle();
}

/// Moving spheres in a box: cells updated in a second, the seconds of each stage, bytes over the bus and
/// pages touched in a step. For the device `host` its time over that of the kernels.
void measure_bodies(Device device, const Layers& layers, Figures& out) {
  MovingLayers scene(layers, {"run.device=" + std::string(device_names[int(device)])});
  const lbm::Int3 n = layers.cells();
  const double cells = double(n.x) * n.y * n.z;
  const BusBytes before = scene.simulation().bus_bytes_in_steps();
  constexpr int turns = 3, steps = 2 * round_of_mapping;
  for (int r = 0; r < turns; ++r) scene.take_turn(steps);
  const BusBytes bus = scene.simulation().bus_bytes_in_steps() - before;
  const double mlups = cells / scene.whole().middle() * 1e-6;
  const std::size_t bodies = scene.simulation().bodies().owned;
  const double bytes = double(bus.to_device + bus.from_device) / (turns * steps) / double(bodies),
               pages = double(bus.pages) / (turns * steps);
  printf(
      "layers %c of %s in %d x %d x %d: %.0f MLUPS, %.0f links, %zu bodies, %.0f bytes a body and step over "
      "the bus, %.1f pages touched a step;",
      layers.name, layers.body.c_str(), n.x, n.y, n.z, mlups, scene.links(), bodies, bytes, pages);
  for (int k = 0; k < int(coupler::Stage::count); ++k)
    if (const double ms = scene.seconds_of(coupler::Stage(k)) * 1e3; ms > 0.005)
      printf(" %s %.2f ms", std::string(coupler::stage_names[k]).c_str(), ms);
  printf("\n");
  const std::string key = std::string("device.bodies.") + layers.name + "." + layers.body;
  out.figures[key + ".mlups"] = mlups;
  out.figures[key + ".bytes"] = bytes, out.figures[key + ".pages"] = pages;
  if (device != Device::host) return;
  MovingLayers kernels(layers);
  for (int r = 0; r < turns; ++r) kernels.take_turn(steps);
  const double over_kernels = scene.whole().middle() / kernels.whole().middle();
  out.figures[key + ".over_kernels"] = over_kernels;
  printf("  over the kernels: %.2f\n", over_kernels);
}

/// Bytes a second, read and written, in copying.
double copying(Device device, [[maybe_unused]] std::int64_t bytes) {
  if (device != Device::gpu) return 0;
  Spread rate;
#if defined(SILT_CUDA)
  const auto memory = zeroed_on(Device::gpu, std::size_t(2 * bytes));
  char* const from = static_cast<char*>(memory.get());
  for (int r = 0; r < 12; ++r) {
    const double t = seconds([&] { copy_on_gpu(from + bytes, from, bytes); });
    if (r > 1) rate.add(2. * double(bytes) / t);
  }
#endif
  return rate.middle();
}

template <class T>
void measure(Device device, int n, double copied, Figures& out) {
  lbm::Fluid<T> fluid(lbm::Domain({n, n, n}, {}, std::nullopt, 1), {0.8, 3. / 16}, MPI_COMM_SELF, device);
  const double cells = double(n) * n * n;
  const int steps = device == Device::gpu ? 40 : 2;
  step(fluid, 4);
  Spread mlups;
  for (int r = 0; r < 5; ++r) mlups.add(steps * cells / seconds([&] { step(fluid, steps); }) * 1e-6);
  const char* const precision = precision_of<T>;
  const double share =
      copied > 0 ? mlups.middle() * 1e6 * 2 * lbm::D3Q19::directions * sizeof(T) / copied : 0;
  printf("%s %d^3: %.0f MLUPS (%.0f to %.0f), %.2f of copying\n", precision, n, mlups.middle(),
         mlups.lowest(), mlups.highest(), share);
  const std::string key = std::string("device.") + precision + "." + std::to_string(n);
  out.figures[key + ".mlups"] = mlups.middle();
  if (copied > 0) out.figures[key + ".share"] = share;
}

void run(const Options& o) {
  require_no_others(o);
  const std::string why = unusable(Device::gpu);
  const Device device = why.empty() ? Device::gpu : Device::host;
  printf("%s\n", why.empty() ? description(device).c_str() : ("the host: " + why).c_str());
  Figures out;
  compare<float>(device, out);
  compare<double>(device, out);
  compare_bodies<float>(device, out);
  compare_bodies<double>(device, out);
  const bool small = o.quick || device != Device::gpu;
  const double copied = copying(device, std::int64_t{1} << (o.quick ? 26 : 32));
  if (copied > 0) printf("copying: %.0f GB/s\n", copied * 1e-9);
  for (const int n : small ? std::vector{48} : std::vector{128, 256, 384, 512}) {
    measure<float>(device, n, copied, out);
    if (n < 512) measure<double>(device, n, copied, out);
  }
  for (const bool shared : {false, true}) {
    messages<float>(device, small ? 32 : 256, shared, out);
    messages<double>(device, small ? 32 : 256, shared, out);
  }
  measure_levels<float>(device, small ? 96 : 384, out);
  measure_levels<double>(device, small ? 96 : 384, out);
  for (const char name : {'a', 'b'})
    for (const char* body : {"d6", "d10", "d20"})
      measure_bodies(device, {name, body, small ? 48 : 384, "multireflection"}, out);
  out.write(o.json);
}

}  // namespace
}  // namespace silt::bench

/// Without the coupler's start of MPI, which would take all libraries of a run along.
int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  silt::flush_denormals_to_zero();
  try {
    silt::bench::run(silt::bench::options_of(argc, argv));
  } catch (const std::exception& e) {
    fprintf(stderr, "%s\n", e.what());
    MPI_Abort(MPI_COMM_WORLD, 2);
  }
  MPI_Finalize();
}
