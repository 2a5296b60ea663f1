#pragma once
// Cache lines fetched ahead of use. GCC takes a function that does nothing else for one without effect and
// leaves its calls out: the empty statement is an effect that it keeps.

namespace silt::lbm {

[[gnu::always_inline]] inline void prefetch_to_read(const void* line) {
  __builtin_prefetch(line, 0);
  asm volatile("");
}
[[gnu::always_inline]] inline void prefetch_to_write(const void* line) {
  __builtin_prefetch(line, 1);
  asm volatile("");
}

}  // namespace silt::lbm
