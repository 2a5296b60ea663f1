#include "rigid/math/isa.hpp"

#include <cstdlib>
#include <string_view>

namespace silt::rigid {

Isa chosen_isa() {
  static const Isa chosen = [] {
    Isa best = Isa::portable;
#if defined(__x86_64__)
    const auto level = [](bool v3, bool v4) { return v4 ? Isa::avx512 : v3 ? Isa::avx2 : Isa::portable; };
    const bool v3 =
        __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
    best = level(v3, v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
                         __builtin_cpu_supports("avx512cd"));
    const char* wanted = std::getenv("SILT_ISA");
    const std::string_view name = wanted ? wanted : "";
    if (name == "portable") best = Isa::portable;
    if (name == "avx2" && best == Isa::avx512) best = Isa::avx2;
#endif
    return best;
  }();
  return chosen;
}

}  // namespace silt::rigid
