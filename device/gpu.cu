// What is asked of CUDA besides passes.
#include <cuda_runtime.h>

#include <memory>
#include <new>
#include <string>

namespace silt::cuda {

namespace {
std::string version(int number) {  // 13000 for 13.0
  return std::to_string(number / 1000) + "." + std::to_string(number % 1000 / 10);
}
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
  return std::string(card.name) + ", " + std::to_string(card.totalGlobalMem >> 30) + " GiB, driver for CUDA " +
         version(driver) + ", built with CUDA " + version(runtime);
}

std::shared_ptr<void> zeroed(std::size_t bytes) {
  void* memory = nullptr;
  if (cudaMallocManaged(&memory, bytes) != cudaSuccess) throw std::bad_alloc();
  const std::shared_ptr<void> owned(memory, [](void* p) { cudaFree(p); });
  if (cudaMemset(memory, 0, bytes) != cudaSuccess || cudaDeviceSynchronize() != cudaSuccess)
    throw std::bad_alloc();
  return owned;
}

}  // namespace silt::cuda
