#include "rigid/math/isa.hpp"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace silt::rigid {

namespace {

/// The features of x86-64-v4 and -v3, for which CMakeLists.txt builds the kernels.
Isa widest_isa() {
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") || !__builtin_cpu_supports("bmi2"))
    return Isa::portable;
  const bool v4 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                  __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
                  __builtin_cpu_supports("avx512cd");
  return v4 ? Isa::avx512 : Isa::avx2;
#else
  return Isa::portable;
#endif
}

Isa wanted_isa() {
  const char* const variable = std::getenv("SILT_ISA");
  const std::string_view wanted = variable ? variable : "";
  return wanted == "portable" ? Isa::portable : wanted == "avx2" ? Isa::avx2 : Isa::avx512;
}

}  // namespace

Isa chosen_isa() {
  static const Isa chosen = std::min(widest_isa(), wanted_isa());
  return chosen;
}

}  // namespace silt::rigid
