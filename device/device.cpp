#include "device/device.hpp"

#include <new>

namespace silt {

#if defined(SILT_CUDA)
namespace cuda {  // gpu.cu
std::string unusable();
std::string description();
std::string choose(int rank, int ranks);
std::shared_ptr<void> zeroed(std::size_t bytes);
std::pmr::memory_resource* memory();
std::pmr::memory_resource* message_memory();
}  // namespace cuda
#endif

std::string unusable(Device device) {
  if (device != Device::gpu) return "";
#if defined(SILT_CUDA)
  return cuda::unusable();
#else
  return "this program was built without CUDA; configure it with -D SILT_WITH_CUDA=ON where nvcc is, or use "
         "run.device = \"cpu\"";
#endif
}

std::string description([[maybe_unused]] Device device) {
#if defined(SILT_CUDA)
  if (device == Device::gpu) return cuda::description();
#endif
  return "";
}

std::string choose([[maybe_unused]] Device device, [[maybe_unused]] int rank, [[maybe_unused]] int ranks) {
#if defined(SILT_CUDA)
  if (device == Device::gpu) return cuda::choose(rank, ranks);
#endif
  return "";
}

std::pmr::memory_resource* memory_of([[maybe_unused]] Device device) {
#if defined(SILT_CUDA)
  if (device == Device::gpu) return cuda::memory();
#endif
  return std::pmr::new_delete_resource();
}

std::pmr::memory_resource* message_memory([[maybe_unused]] Device device) {
#if defined(SILT_CUDA)
  if (device == Device::gpu) return cuda::message_memory();
#endif
  return std::pmr::new_delete_resource();
}

std::shared_ptr<void> zeroed_on_gpu([[maybe_unused]] std::size_t bytes) {
#if defined(SILT_CUDA)
  return cuda::zeroed(bytes);
#else
  throw std::bad_alloc();
#endif
}

}  // namespace silt
