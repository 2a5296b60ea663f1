#pragma once
// Selects the build of the hot kernels. All builds round alike (no contraction): results never change.
#include <array>
#include <string>
#include <string_view>

namespace silt {

/// Instruction sets, in ascending order of vector width.
enum class Isa { portable, avx2, avx512 };
inline constexpr std::array<std::string_view, 3> isa_names = {"portable", "avx2", "avx512"};

/// Returns the widest set of this machine, or a lesser one named by the environment variable SILT_ISA.
Isa chosen_isa();
inline std::string_view instruction_set() {
  return isa_names[static_cast<std::size_t>(chosen_isa())];
}

/// Returns the build for this machine of a kernel (a pointer) or of a struct of kernels.
template <class Build>
Build chosen(Build portable, Build avx2, Build avx512) {
  const Isa isa = chosen_isa();
  return isa == Isa::avx512 ? avx512 : isa == Isa::avx2 ? avx2 : portable;
}

// SILT_BUILDS declares functions of a kernel for all builds; SILT_CHOSEN selects the build for this machine.
#define SILT_BUILDS(...) \
  namespace portable {   \
  __VA_ARGS__            \
  }                      \
  namespace avx2 {       \
  __VA_ARGS__            \
  }                      \
  namespace avx512 {     \
  __VA_ARGS__            \
  }
#define SILT_CHOSEN(...) ::silt::chosen(portable::__VA_ARGS__, avx2::__VA_ARGS__, avx512::__VA_ARGS__)

/// Returns whether the latency of the last-level cache is so high that prefetching pays; it never changes a
/// result. On an Intel Xeon of 2023 prefetching takes 18 to 30 % off a step with many bodies in a fluid, on
/// an AMD EPYC of 2019 it adds 2 to 6 %. SILT_LAST_CACHE=near or far overrules the choice.
bool last_cache_is_far();

/// Flushes denormal results to zero on this thread from now on: they are slow and irrelevant in populations.
/// Does nothing on machines without such a mode.
void flush_denormals_to_zero();

/// Returns a message for an invalid value, which would otherwise have no effect; "" if all are valid.
std::string environment_error();

}  // namespace silt
