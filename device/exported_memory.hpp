#pragma once
// Memory of a device that the devices of other processes of this machine may read: what ranks tell one
// another there never crosses the bus. A process sends the name of a place, and the other one opens it.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>

#include "device/device.hpp"

namespace silt {

/// The name of a place in exported memory, valid in all processes.
struct ExportedPlace {
  std::uint64_t machine = 0;  // since it was started
  std::int64_t process = 0;
  std::array<std::byte, 64> piece{};  // a cudaIpcMemHandle_t, or the number of a file
  std::uint64_t bytes = 0;            // of the piece
  std::uint64_t offset = 0;           // of the place in the piece
};

/// Returns memory that passes alone may touch. It is never returned to the device, since others may have it
/// open.
std::pmr::memory_resource* exported_memory(Device);
ExportedPlace place_of(Device, const void* exported);
/// Returns the place as passes of this process see it; null if they cannot.
const void* opened(Device, const ExportedPlace&);

}  // namespace silt
