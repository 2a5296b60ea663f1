#pragma once
// The choice of the build of hot kernels, of the fluid and of the bodies, that runs on this machine. All
// builds round alike (no contraction), so the choice never changes a result.
#include <array>
#include <string_view>

namespace silt {

/// Instruction sets, each wider than the one before.
enum class Isa { portable, avx2, avx512 };
inline constexpr std::array<std::string_view, 3> isa_names = {"portable", "avx2", "avx512"};

/// Returns the widest one this machine has; the environment variable SILT_ISA may name a lesser one.
Isa chosen_isa();
inline std::string_view instruction_set() {
  return isa_names[static_cast<std::size_t>(chosen_isa())];
}

/// Returns the one that runs here of the three builds of a kernel (a pointer) or of a struct of kernels.
template <class Build>
Build chosen(Build portable, Build avx2, Build avx512) {
  const Isa isa = chosen_isa();
  return isa == Isa::avx512 ? avx512 : isa == Isa::avx2 ? avx2 : portable;
}

// SILT_BUILDS declares functions of a kernel for all builds; SILT_CHOSEN takes the one that runs here.
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

/// Returns whether the last cache answers so late that its data is worth fetching ahead of use, which never
/// changes a result either. On an Intel Xeon of 2023 it takes 18 to 30 % off a step with many bodies in a
/// fluid, on an AMD EPYC of 2019 it adds 2 to 6 %. SILT_LAST_CACHE=near or far overrules it.
bool last_cache_is_far();

/// Makes results too small for a normal number zero, for this thread from now on (they are slow, and mean
/// nothing in populations). Does nothing where the machine has no such mode.
void flush_denormals_to_zero();

}  // namespace silt
