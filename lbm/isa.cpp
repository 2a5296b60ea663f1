#include "lbm/isa.hpp"

#include <cstdlib>
#include <string_view>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace silt::lbm {

Isa chosen_isa() {
  static const Isa chosen = [] {
    Isa best = Isa::portable;
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2"))
      best = Isa::avx2;
    if (best == Isa::avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512cd"))
      best = Isa::avx512;
    if (const char* wanted = std::getenv("SILT_ISA")) {
      const std::string_view name = wanted;
      if (name == "portable") best = Isa::portable;
      if (name == "avx2" && best == Isa::avx512) best = Isa::avx2;
    }
#endif
    return best;
  }();
  return chosen;
}

void flush_denormals_to_zero() {
#if defined(__x86_64__)
  _mm_setcsr(_mm_getcsr() | 0x8040);  // FTZ and DAZ
#endif
}

}  // namespace silt::lbm
