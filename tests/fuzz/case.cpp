// The reader of cases, and what judges them: anything but CaseError is a fault.
#include <cstdint>

#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace silt;
  try {
    CaseSource source{"seeds/case.toml", {reinterpret_cast<const char*>(bytes), size}, {}};
    require_runnable(read_case(source));
  } catch (const CaseError&) {
  }
  return 0;
}
