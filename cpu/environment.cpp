#include "cpu/environment.hpp"

#include <algorithm>
#include <cstdlib>
#include <span>

#include "cpu/isa.hpp"

namespace silt {
namespace {

std::string complaint_of(const char* name, std::span<const std::string_view> known, const char* listed) {
  const char* const found = std::getenv(name);
  if (!found || !*found || std::ranges::find(known, found) != known.end()) return "";
  return "the environment variable " + std::string(name) + " is '" + found + "'; it must be " + listed;
}

}  // namespace

std::string environment_error() {
  constexpr std::string_view caches[] = {"near", "far"};  // last_cache_is_far
  const std::string of_isa = complaint_of("SILT_ISA", isa_names, "portable, avx2 or avx512");
  return of_isa.empty() ? complaint_of("SILT_LAST_CACHE", caches, "near or far") : of_isa;
}

}  // namespace silt
