// The readers of surfaces: anything but std::invalid_argument is a fault.
#include <cstdint>
#include <stdexcept>

#include "adapters/mesh/read_mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  for (const char* name : {"a.stl", "a.obj", "a.ply"}) try {
      silt::adapters::read_polyhedron(name, {reinterpret_cast<const char*>(bytes), size}, 1);
    } catch (const std::invalid_argument&) {
    }
  return 0;
}
