#include "device/device.hpp"

#include <sys/resource.h>

#include <cstring>
#include <new>

#include "device/host_device.hpp"

namespace silt {

namespace cuda {  // gpu.cu
#if defined(SILT_CUDA)
std::string unusable();
std::string description();
std::string choose(int rank, int ranks);
std::shared_ptr<void> zeroed(std::size_t bytes);
std::pmr::memory_resource* memory();
std::pmr::memory_resource* message_memory();
std::pmr::memory_resource* own_memory();
void copy_in_turn(void* to, const void* from, std::size_t bytes);
void clear_in_turn(void* memory, std::size_t bytes);
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
void copy_in_turn(void*, const void*, std::size_t) {}
void clear_in_turn(void*, std::size_t) {}
constexpr auto memory = std::pmr::new_delete_resource, message_memory = memory, own_memory = memory;
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
  if (device == Device::gpu) return cuda::memory();
  return device == Device::host ? shared_memory_of_host() : std::pmr::new_delete_resource();
}

std::pmr::memory_resource* message_memory(Device device) {
  return device == Device::gpu ? cuda::message_memory() : std::pmr::new_delete_resource();
}

std::pmr::memory_resource* own_memory(Device device) {
  if (device == Device::gpu) return cuda::own_memory();
  return device == Device::host ? own_memory_of_host() : std::pmr::new_delete_resource();
}

void copy_in_turn(Device device, void* to, const void* from, std::size_t bytes) {
  if (device == Device::gpu)
    cuda::copy_in_turn(to, from, bytes);
  else if (device == Device::host)
    defer_work([=] { std::memcpy(to, from, bytes); });
}
void clear_in_turn(Device device, void* memory, std::size_t bytes) {
  if (device == Device::gpu)
    cuda::clear_in_turn(memory, bytes);
  else if (device == Device::host)
    defer_work([=] { std::memset(memory, 0, bytes); });
  else
    std::memset(memory, 0, bytes);
}

std::shared_ptr<void> zeroed_on(Device device, std::size_t bytes) {
  return device == Device::gpu ? cuda::zeroed(bytes) : zeroed_on_host(bytes);
}

BusBytes bus_bytes(Device device) {
  BusBytes bytes = counting::on_bus;
  rusage use{};
  if (device == Device::host) bytes.pages = pages_touched_on_host();
  if (device == Device::gpu && getrusage(RUSAGE_SELF, &use) == 0) bytes.pages = std::uint64_t(use.ru_minflt);
  return bytes;
}

}  // namespace silt
