#pragma once
// The device `host` emulates the worst case of a graphics processor, for tests: passes and copies run only
// when the program waits for them, and the device's own memory is accessible only to them.
#include <functional>
#include <memory_resource>

namespace silt {

/// Defers work to the next wait, after all work deferred before.
void defer_work(std::function<void()>);
void run_deferred_work();

std::pmr::memory_resource* own_memory_of_host();

}  // namespace silt
