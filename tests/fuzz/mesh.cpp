// The readers of surfaces: anything but std::invalid_argument or a closed surface is a fault.
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "adapters/mesh/read_mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string input(reinterpret_cast<const char*>(bytes), size);
  for (const char* name : {"a.stl", "a.obj", "a.ply"}) try {
      silt::adapters::read_polyhedron(name, input, 1);
      const auto read = silt::adapters::read_mesh(name, input, 1);
      if (!(read.surface->mass_properties().volume > 0)) std::abort();
    } catch (const std::invalid_argument&) {
    }
  return 0;
}
