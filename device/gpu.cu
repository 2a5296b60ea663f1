// The CUDA calls other than passes.
#define SILT_BUILD gpu
#include <cuda_runtime.h>

#include <array>
#include <cstring>
#include <memory>
#include <memory_resource>
#include <new>
#include <string>

#include "device/for_each.hpp"
#include "device/untouched_pool.hpp"

namespace silt::cuda {

namespace {
std::string version(int number) {  // 13000 for 13.0
  return std::to_string(number / 1000) + "." + std::to_string(number % 1000 / 10);
}

using Allocate = cudaError_t(void**, std::size_t);
cudaError_t allocate_managed(void** memory, std::size_t bytes) {
  return cudaMallocManaged(memory, bytes);
}
cudaError_t allocate_own(void** memory, std::size_t bytes) {
  return cudaMalloc(memory, bytes);
}
cudaError_t allocate_pinned(void** memory, std::size_t bytes) {
  return cudaMallocHost(memory, bytes);
}

template <Allocate take, cudaError_t give_back(void*)>
class Memory final : public std::pmr::memory_resource {
  void* do_allocate(std::size_t bytes, std::size_t) override {
    void* memory = nullptr;
    if (take(&memory, bytes) != cudaSuccess) throw std::bad_alloc();
    return memory;
  }
  void do_deallocate(void* memory, std::size_t, std::size_t) override { give_back(memory); }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }
};
}  // namespace

std::string unusable() {
  int count = 0;
  const cudaError_t found = cudaGetDeviceCount(&count);
  if (found == cudaSuccess && count > 0) return "";
  const std::string why = found == cudaSuccess ? "" : std::string(" (") + cudaGetErrorString(found) + ")";
  return "no graphics processor was found" + why + "; look at nvidia-smi, or use run.device = \"cpu\"";
}

std::string choose(int rank, int ranks) {
  int count = 1, card = 0, is_shared = 0;
  if (cudaGetDeviceCount(&count) != cudaSuccess || cudaSetDevice(card = rank % count) != cudaSuccess ||
      cudaDeviceGetAttribute(&is_shared, cudaDevAttrMpsEnabled, card) != cudaSuccess || ranks <= count ||
      is_shared)
    return "";
  return std::to_string(ranks) + " ranks share " + std::to_string(count) +
         " graphics processor(s) in turn, which takes up to four times as long; start NVIDIA's MPS server "
         "before: nvidia-cuda-mps-control -d";
}

std::string description() {
  cudaDeviceProp card;
  int driver = 0, runtime = 0, chosen = 0;
  if (cudaGetDevice(&chosen) != cudaSuccess || cudaGetDeviceProperties(&card, chosen) != cudaSuccess ||
      cudaDriverGetVersion(&driver) != cudaSuccess || cudaRuntimeGetVersion(&runtime) != cudaSuccess)
    return "";
  return std::string(card.name) + ", " + std::to_string(card.totalGlobalMem >> 30) +
         " GiB, driver for CUDA " + version(driver) + ", built with CUDA " + version(runtime);
}

/// Memory whose pages migrate to where they are used.
std::pmr::memory_resource* managed() {
  static Memory<allocate_managed, cudaFree> managed;
  return &managed;
}
std::pmr::memory_resource* memory() {
  static auto* const pool = new UntouchedPool(managed());  // outlives all arrays
  return pool;
}
/// Pinned memory, from and to which the card copies, and from which MPI sends.
std::pmr::memory_resource* message_memory() {
  static Memory<allocate_pinned, cudaFreeHost> pinned;
  return &pinned;
}
std::pmr::memory_resource* own_memory() {
  static Memory<allocate_own, cudaFree> own;
  return &own;
}

/// Memory that other processes may open by its name; the name stays zero if they cannot.
void* exported(std::size_t bytes, std::array<std::byte, 64>& name) {
  void* const memory = own_memory()->allocate(bytes);
  cudaIpcMemHandle_t handle;
  static_assert(sizeof handle == sizeof name);
  if (cudaIpcGetMemHandle(&handle, memory) == cudaSuccess) std::memcpy(&name, &handle, sizeof handle);
  cudaGetLastError();  // forgets an error
  return memory;
}
const void* opened(const std::array<std::byte, 64>& name) {
  cudaIpcMemHandle_t handle;
  std::memcpy(&handle, &name, sizeof handle);
  void* memory = nullptr;
  const cudaError_t found = cudaIpcOpenMemHandle(&memory, handle, cudaIpcMemLazyEnablePeerAccess);
  cudaGetLastError();  // forgets an error
  return found == cudaSuccess ? memory : nullptr;
}

void copy_in_turn(void* to, const void* from, std::size_t bytes) {
  gpu::check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDefault));
}
void clear_in_turn(void* memory, std::size_t bytes) {
  gpu::check(cudaMemsetAsync(memory, 0, bytes));
}

std::shared_ptr<void> zeroed(std::size_t bytes) {
  const std::shared_ptr<void> owned(managed()->allocate(bytes), [](void* p) { cudaFree(p); });
  if (cudaMemset(owned.get(), 0, bytes) != cudaSuccess || cudaDeviceSynchronize() != cudaSuccess)
    throw std::bad_alloc();
  return owned;
}

}  // namespace silt::cuda
