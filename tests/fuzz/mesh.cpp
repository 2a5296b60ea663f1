// The reader of STL: anything but std::invalid_argument is a fault.
#include <cstdint>
#include <stdexcept>

#include "adapters/stl/stl_polyhedron.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  try {
    silt::adapters::stl_polyhedron({reinterpret_cast<const char*>(bytes), size}, 1);
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
