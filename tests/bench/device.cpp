// The fluid alone on a device: its bits against those of the processor's kernels, its speed, and the share of
// the speed at which the device's memory copies. On a machine without a graphics processor the device is the
// host, for a look. It runs for some two minutes by itself, in need of MPI and CUDA's driver alone.
//   scripts/bench device [--quick] [--json FILE]
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>

#include "cpu/isa.hpp"
#include "device/device.hpp"
#include "tests/bench/figures.hpp"
#include "tests/bench/periodic_box.hpp"
#include "tests/bench/spread.hpp"

namespace silt::bench {

void copy_on_gpu(void* to, const void* from, std::int64_t bytes);  // device_copy.cu

namespace {

/// A box between moving walls, stirred: what arrives in its cells after some steps.
template <class T>
std::vector<T> stirred(Device device, lbm::Collision model, double tau, double force) {
  std::array<lbm::SideCondition, 6> sides;
  sides[4] = {lbm::SideKind::bounce, {0.03, 0.01, 0}, 0};
  sides[5].kind = lbm::SideKind::bounce;
  const lbm::Int3 n{64, 48, 32};
  lbm::Fluid<T> fluid(lbm::Domain(n, sides, std::nullopt, 1), {tau, 3. / 16, model, {force, 0, 0}, 0.1},
                      MPI_COMM_SELF, device);
  lbm::for_cells({}, n, [&](lbm::Int3 x) {
    fluid.set_equilibrium(0, x, 1e-3 * std::sin(x.x + 2.0 * x.y),
                          {0.01 * std::sin(0.3 * x.z), 0.02 * std::cos(0.2 * x.x), 0});
  });
  step(fluid, 21);
  std::vector<T> all;
  lbm::for_cells({}, n, [&](lbm::Int3 x) {
    for (int i = 0; i < lbm::directions; ++i) all.push_back(fluid.arriving(0, x, i));
  });
  return all;
}

template <class T>
void compare(Device device, Figures& out) {
  for (const auto& [model, tau] :
       {std::pair(lbm::Collision::trt, 0.6), std::pair(lbm::Collision::regularised, 0.51)})
    for (const double force : {0., 1e-5}) {
      const std::vector<T> here = stirred<T>(Device::cpu, model, tau, force),
                           there = stirred<T>(device, model, tau, force);
      std::int64_t unlike = 0;
      for (std::size_t k = 0; k < here.size(); ++k)
        unlike += std::memcmp(&here[k], &there[k], sizeof(T)) != 0;
      const std::string name = std::string(sizeof(T) == 4 ? "single" : "double") + "." +
                               std::string(model_of(model).name) + (force != 0 ? ".force" : "");
      printf("bits %s: %lld of %zu populations differ\n", name.c_str(), static_cast<long long>(unlike),
             here.size());
      out.figures["device.unlike." + name] = double(unlike);
    }
}

/// Bytes a second, read and written, in copying.
double copying(Device device, [[maybe_unused]] std::int64_t bytes) {
  if (device != Device::gpu) return 0;
  Spread rate;
#if defined(SILT_CUDA)
  const auto memory = zeroed_on_gpu(std::size_t(2 * bytes));
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
  const char* const precision = sizeof(T) == 4 ? "single" : "double";
  const double share = copied > 0 ? mlups.middle() * 1e6 * 2 * lbm::directions * sizeof(T) / copied : 0;
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
  const bool small = o.quick || device != Device::gpu;
  const double copied = copying(device, std::int64_t{1} << (o.quick ? 26 : 32));
  if (copied > 0) printf("copying: %.0f GB/s\n", copied * 1e-9);
  for (const int n : small ? std::vector{48} : std::vector{128, 256, 384, 512}) {
    measure<float>(device, n, copied, out);
    if (n < 512) measure<double>(device, n, copied, out);
  }
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
