#pragma once
// The device `host` emulates the worst case of a graphics processor, for tests: passes and copies run only
// when the program waits for them, the device's own memory is accessible only to them, and pages of memory
// for both processors are counted when the program touches them after passes have run.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <type_traits>

namespace silt {

/// Defers run(work) to the next wait, after all work deferred before, and copies the bytes of `work`.
void defer_work(void (*run)(const void* work), const void* work, std::size_t bytes);
/// Defers work(), which is copied as a graphics processor copies the arguments of a launch.
template <class Work>
void defer_work(const Work& work) {
  static_assert(std::is_trivially_copyable_v<Work> && alignof(Work) <= alignof(std::max_align_t));
  defer_work([](const void* of) { (*static_cast<const Work*>(of))(); }, &work, sizeof work);
}
void run_deferred_work();

/// The size of a page of these memories in bytes: large, since locking many small pages takes long.
inline constexpr std::size_t host_page = std::size_t{2} << 20;
std::pmr::memory_resource* own_memory_of_host();
std::pmr::memory_resource* shared_memory_of_host();
std::shared_ptr<void> zeroed_on_host(std::size_t bytes);
std::uint64_t pages_touched_on_host();
/// Allocates a piece of memory that other processes may open by its name (device/exported_memory.hpp).
void* exported_on_host(std::size_t bytes, std::array<std::byte, 64>& name);
/// Returns a piece of another process; null if there is none.
const void* opened_on_host(std::int64_t process, const std::array<std::byte, 64>& name, std::size_t bytes);

}  // namespace silt
