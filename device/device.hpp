#pragma once
// Where the passes over cells of a run are done. All give the same bits.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <string>
#include <string_view>

// The build of a pass for a device other than `cpu`.
#if defined(SILT_CUDA)
#define SILT_ON(device, pass) (device == Device::gpu ? gpu::pass : host::pass)
#else
#define SILT_ON(device, pass) host::pass
#endif

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

/// Memory that the processor and the device both read and write; that for messages stays the processor's.
std::pmr::memory_resource* memory_of(Device);
std::pmr::memory_resource* message_memory(Device);
/// Returns bytes of zero which the processor and the graphics processor both read and write: pages move to
/// where they are used. Throws std::bad_alloc.
std::shared_ptr<void> zeroed_on_gpu(std::size_t bytes);

}  // namespace silt
