#pragma once
// Which build of the contact kernels runs here. All builds round alike (no contraction), so the choice never
// changes a result. The bodies' own copy of what lbm/ has: neither folder sees the other.

namespace silt::rigid {

enum class Isa { portable, avx2, avx512 };
/// The widest one this machine has; the environment variable SILT_ISA may name a lesser one.
Isa chosen_isa();

}  // namespace silt::rigid
