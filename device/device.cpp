#include "device/device.hpp"

#include <new>

namespace silt {

namespace cuda {  // gpu.cu
#if defined(SILT_CUDA)
std::string unusable();
std::string description();
std::string choose(int rank, int ranks);
std::shared_ptr<void> zeroed(std::size_t bytes);
std::pmr::memory_resource* memory();
std::pmr::memory_resource* message_memory();
#else
std::string unusable() {
  return "this program was built without CUDA; configure it with -D SILT_WITH_CUDA=ON where nvcc is, or use "
         "run.device = \"cpu\"";
}
std::string description() {
  return "";
}
std::string choose(int, int) {
  return "";
}
std::shared_ptr<void> zeroed(std::size_t) {
  throw std::bad_alloc();
}
constexpr auto memory = std::pmr::new_delete_resource, message_memory = memory;
#endif
}  // namespace cuda

std::string unusable(Device device) {
  return device == Device::gpu ? cuda::unusable() : "";
}

std::string description(Device device) {
  return device == Device::gpu ? cuda::description() : "";
}

std::string choose(Device device, int rank, int ranks) {
  return device == Device::gpu ? cuda::choose(rank, ranks) : "";
}

std::pmr::memory_resource* memory_of(Device device) {
  return device == Device::gpu ? cuda::memory() : std::pmr::new_delete_resource();
}

std::pmr::memory_resource* message_memory(Device device) {
  return device == Device::gpu ? cuda::message_memory() : std::pmr::new_delete_resource();
}

std::shared_ptr<void> zeroed_on_gpu(std::size_t bytes) {
  return cuda::zeroed(bytes);
}

}  // namespace silt
