#pragma once
// The devices that run the passes over cells; all give bitwise the same results.
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

#include "cpu/isa.hpp"

// SILT_DEVICES declares functions of passes for the builds of all devices, those of `host` as kernels for
// each instruction set; SILT_ON selects the function of one device; SILT_OFF_CPU does so for functions that
// `cpu` does not have.
#define SILT_DEVICES(...) \
  namespace cpu {         \
  __VA_ARGS__             \
  }                       \
  namespace gpu {         \
  __VA_ARGS__             \
  }                       \
  SILT_BUILDS(__VA_ARGS__)
#if defined(SILT_CUDA)
#define SILT_OFF_CPU(device, pass) (device == Device::gpu ? gpu::pass : SILT_CHOSEN(pass))
#else
#define SILT_OFF_CPU(device, pass) SILT_CHOSEN(pass)
#endif
#define SILT_ON(device, pass) (device == Device::cpu ? cpu::pass : SILT_OFF_CPU(device, pass))

namespace silt {

/// `cpu`: the vector kernels of the processor. `host`: the passes of a graphics processor as loops on the
/// processor, over vectors of entries, for tests. `gpu`: a graphics processor.
enum class Device : std::uint8_t { cpu, host, gpu };
inline constexpr std::array<std::string_view, 3> device_names = {"cpu", "host", "gpu"};

/// Returns why the program cannot use a device on this machine, with a remedy; "" if it can.
std::string unusable(Device);
/// Returns the name of the graphics processor, its memory, its driver and the toolkit; "" for other devices.
std::string description(Device);

/// Selects a graphics processor for a rank, in turn among the `ranks` ranks of this machine. Returns a
/// warning if ranks share one without an MPS server, which would let them use it simultaneously; else "".
std::string choose(Device, int rank, int ranks);

/// Memory for both processor and device, whose pages migrate between them; memory of the processor, from and
/// to which the device copies; and memory of the device alone.
std::pmr::memory_resource* memory_of(Device);
std::pmr::memory_resource* message_memory(Device);
std::pmr::memory_resource* own_memory(Device);
/// Copies bytes from or to the device's own memory, asynchronously, in order with its passes.
void copy_in_turn(Device, void* to, const void* from, std::size_t bytes);
/// Sets bytes of the device's own memory to zero, asynchronously, in order with its passes.
void clear_in_turn(Device, void* memory, std::size_t bytes);
/// Returns zeroed memory for both processors, whose pages migrate, of a device other than `cpu`. Throws
/// std::bad_alloc.
std::shared_ptr<void> zeroed_on(Device, std::size_t bytes);

/// Allocator of arrays, mostly in such memory, whose new elements are uninitialised, for a device to write.
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

/// Replaces the elements by uninitialised ones, with some room more where the array must move.
template <class T>
void renew(DeviceArray<T>& values, std::size_t count) {
  values.clear();
  if (values.capacity() < count) values.reserve(count + count / 8);
  values.resize(count);
}

/// Bytes that this rank's processor exchanges with its device; populations only in messages. `pages`: those
/// of memory_of() and zeroed_on() that the processor touched after passes had run; on a graphics processor
/// all page faults of the process, of which these are a part.
struct BusBytes {
  std::uint64_t to_device = 0, from_device = 0, pages = 0;
  BusBytes& operator+=(const BusBytes& b) {
    to_device += b.to_device, from_device += b.from_device, pages += b.pages;
    return *this;
  }
  BusBytes operator-(const BusBytes& b) const {
    return {to_device - b.to_device, from_device - b.from_device, pages - b.pages};
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
BusBytes bus_bytes(Device);
/// Count values, and the elements of lists, that go to or come from a device other than `cpu`.
template <class... Values>
void to_device(const Values&... values) {
  counting::on_bus.to_device += (counting::bytes_of(values) + ...);
}
template <class... Values>
void from_device(const Values&... values) {
  counting::on_bus.from_device += (counting::bytes_of(values) + ...);
}

}  // namespace silt
