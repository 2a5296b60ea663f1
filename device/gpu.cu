// What is asked of CUDA besides passes.
#include <cuda_runtime.h>

#include <memory>
#include <memory_resource>
#include <new>
#include <string>

namespace silt::cuda {

namespace {
std::string version(int number) {  // 13000 for 13.0
  return std::to_string(number / 1000) + "." + std::to_string(number % 1000 / 10);
}

/// Pages move to where they are used.
class Memory final : public std::pmr::memory_resource {
  void* do_allocate(std::size_t bytes, std::size_t) override {
    void* memory = nullptr;
    if (cudaMallocManaged(&memory, bytes) != cudaSuccess) throw std::bad_alloc();
    return memory;
  }
  void do_deallocate(void* memory, std::size_t, std::size_t) override { cudaFree(memory); }
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

std::string description() {
  cudaDeviceProp card;
  int driver = 0, runtime = 0;
  if (cudaGetDeviceProperties(&card, 0) != cudaSuccess || cudaDriverGetVersion(&driver) != cudaSuccess ||
      cudaRuntimeGetVersion(&runtime) != cudaSuccess)
    return "";
  return std::string(card.name) + ", " + std::to_string(card.totalGlobalMem >> 30) +
         " GiB, driver for CUDA " + version(driver) + ", built with CUDA " + version(runtime);
}

std::pmr::memory_resource* memory() {
  static Memory memory;
  return &memory;
}

std::shared_ptr<void> zeroed(std::size_t bytes) {
  const std::shared_ptr<void> owned(memory()->allocate(bytes), [](void* p) { cudaFree(p); });
  if (cudaMemset(owned.get(), 0, bytes) != cudaSuccess || cudaDeviceSynchronize() != cudaSuccess)
    throw std::bad_alloc();
  return owned;
}

}  // namespace silt::cuda
