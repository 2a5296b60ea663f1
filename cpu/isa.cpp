#include "cpu/isa.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace silt {

namespace {

/// The features of x86-64-v4 and -v3, for which CMakeLists.txt builds kernels.
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
  const char* const wanted = std::getenv("SILT_ISA");
  for (const Isa isa : {Isa::portable, Isa::avx2})
    if (wanted && wanted == isa_names[static_cast<std::size_t>(isa)]) return isa;
  return Isa::avx512;
}

std::string complaint_of(const char* name, std::span<const std::string_view> known, const char* listed) {
  const char* const found = std::getenv(name);
  if (!found || !*found || std::ranges::find(known, found) != known.end()) return "";
  return "the environment variable " + std::string(name) + " is '" + found + "'; it must be " + listed;
}

}  // namespace

Isa chosen_isa() {
  static const Isa chosen = std::min(widest_isa(), wanted_isa());
  return chosen;
}

bool last_cache_is_far() {
  const char* const told = std::getenv("SILT_LAST_CACHE");
  for (const std::string_view known : {"near", "far"})
    if (told && told == known) return known == "far";
#if defined(__x86_64__)
  return !__builtin_cpu_is("amd") || widest_isa() == Isa::avx512;  // AMD with AVX-512: not measured
#else
  return true;
#endif
}

void flush_denormals_to_zero() {
#if defined(__x86_64__)
  _mm_setcsr(_mm_getcsr() | 0x8040);  // FTZ and DAZ
#elif defined(__aarch64__)
  constexpr std::uint64_t flush_to_zero = 1u << 24;  // arguments and results
  __builtin_aarch64_set_fpcr64(__builtin_aarch64_get_fpcr64() | flush_to_zero);
#endif
}

std::string environment_error() {
  constexpr std::string_view caches[] = {"near", "far"};  // last_cache_is_far
  const std::string of_isa = complaint_of("SILT_ISA", isa_names, "portable, avx2 or avx512");
  return of_isa.empty() ? complaint_of("SILT_LAST_CACHE", caches, "near or far") : of_isa;
}

}  // namespace silt
