#pragma once
// The device `host` behaves as a graphics processor may at its worst, so that tests see what would fail
// there: it does its passes and copies only when somebody waits for them, and what it calls its own memory
// can be read and written by these alone.
#include <functional>
#include <memory_resource>

namespace silt {

/// Does this at the next wait, after all that was put off before.
void put_off(std::function<void()>);
void do_what_was_put_off();

std::pmr::memory_resource* own_memory_of_host();

}  // namespace silt
