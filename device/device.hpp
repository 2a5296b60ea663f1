#pragma once
// Devices run the passes over cells. All give the same bits.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

// SILT_DEVICES declares functions of passes for the builds of all devices; SILT_ON takes that of one, and
// SILT_OFF_CPU that of one other than `cpu` where this has none.
#define SILT_DEVICES(...) \
  namespace cpu {         \
  __VA_ARGS__             \
  }                       \
  namespace host {        \
  __VA_ARGS__             \
  }                       \
  namespace gpu {         \
  __VA_ARGS__             \
  }
#if defined(SILT_CUDA)
#define SILT_OFF_CPU(device, pass) (device == Device::gpu ? gpu::pass : host::pass)
#else
#define SILT_OFF_CPU(device, pass) host::pass
#endif
#define SILT_ON(device, pass) (device == Device::cpu ? cpu::pass : SILT_OFF_CPU(device, pass))

namespace silt {

/// `cpu`: the vector kernels of the processor. `host`: the passes of a graphics processor, in loops on the
/// processor, an entry at a time: for tests. `gpu`: a graphics processor.
enum class Device : std::uint8_t { cpu, host, gpu };
inline constexpr std::array<std::string_view, 3> device_names = {"cpu", "host", "gpu"};

/// Returns why this program cannot use a device on this machine, and what to do; "" if it can.
std::string unusable(Device);
/// Returns the name of the graphics processor, its memory, its driver and the toolkit; "" for other devices.
std::string description(Device);

/// Takes one of the machine's graphics processors for a rank, of so many on this machine, in turn. Returns
/// what is to be said where ranks share one and no MPS server lets them use it at the same time; else "".
std::string choose(Device, int rank, int ranks);

/// Memory that the processor and the device both read and write, at the price of pages that move to and fro;
/// memory that the processor alone reads and writes, and the device copies from and to; and memory that the
/// device alone does.
std::pmr::memory_resource* memory_of(Device);
std::pmr::memory_resource* message_memory(Device);
std::pmr::memory_resource* own_memory(Device);
/// Copies bytes from or to the device's own memory, in turn with its passes. Returns before it is done.
void copy_in_turn(Device, void* to, const void* from, std::size_t bytes);
/// Sets bytes of the device's own memory to zero in the same way.
void clear_in_turn(Device, void* memory, std::size_t bytes);
/// Returns bytes of zero which the processor and the graphics processor both read and write: pages move to
/// where they are used. Throws std::bad_alloc.
std::shared_ptr<void> zeroed_on_gpu(std::size_t bytes);

/// An array, mostly in such memory, whose new elements hold anything: a device is to write them.
template <class T>
struct UnwrittenElements : std::pmr::polymorphic_allocator<T> {
  using Base = std::pmr::polymorphic_allocator<T>;
  using Base::Base;
  template <class U>
  struct rebind {
    using other = UnwrittenElements<U>;
  };
  UnwrittenElements select_on_container_copy_construction() const { return {}; }
  template <class U, class... From>
  void construct(U* at, From&&... from) {
    if constexpr (sizeof...(From) > 0 || !std::is_trivially_copyable_v<U>)
      Base::construct(at, std::forward<From>(from)...);
  }
};
template <class T>
using DeviceArray = std::vector<T, UnwrittenElements<T>>;

/// Bytes that the processor of this rank wrote for its device to read, and read of what the device wrote.
/// Populations count only if they are in messages.
struct BusBytes {
  std::uint64_t to_device = 0, from_device = 0;
  BusBytes& operator+=(const BusBytes& b) {
    to_device += b.to_device, from_device += b.from_device;
    return *this;
  }
  BusBytes operator-(const BusBytes& b) const {
    return {to_device - b.to_device, from_device - b.from_device};
  }
};
namespace counting {
inline BusBytes on_bus;
template <class Value>
constexpr std::size_t bytes_of(const Value& value) {
  if constexpr (requires { value.data(), value.size(); })
    return value.size() * sizeof(*value.data());
  else
    return sizeof value;
}
}  // namespace counting
inline const BusBytes& bus_bytes() {
  return counting::on_bus;
}
/// Counts values, and those in lists, that go to a device other than `cpu`, and that come from there.
template <class... Values>
void to_device(const Values&... values) {
  counting::on_bus.to_device += (counting::bytes_of(values) + ...);
}
template <class... Values>
void from_device(const Values&... values) {
  counting::on_bus.from_device += (counting::bytes_of(values) + ...);
}

}  // namespace silt
