#pragma once
// Scenes of coupled benchmarks: a periodic cube with layers of moving spheres of 6 cells, a little out of
// line.
#include <string>

namespace silt::bench {

/// The text of a case: spheres `spacing` cells apart (16: 6 % solid, 9: 19 %) in n^3 cells, single precision.
inline std::string layers_of_spheres(int spacing, int n, const std::string& scheme, const std::string& time) {
  const std::string edge = std::to_string(n);
  std::string text =
      "title = \"layers of spheres\"\n[units]\nsystem = \"lattice\"\n[domain]\nsize = [" + edge + ", " +
      edge + ", " + edge + "]\nboundary = \"periodic\"\n[fluid]\nrelaxation_time = 1.2\n[coupling]\n" +
      "wall_scheme = \"" + scheme + "\"\ntime = \"" + time +
      "\"\n[[shapes]]\nname = \"sphere\"\ntype = \"sphere\"\ndiameter = 6\n[[bodies]]\nshape = \"sphere\"\n" +
      "density = 1.2\nvelocity = [0.006, 0.005, 0.0062]\npositions = [";
  unsigned random = 1;
  const auto shift = [&] {
    return random = random * 1664525u + 1013904223u, (random >> 8) / double(1 << 24);
  };
  for (double z = 4; z + 3.5 < n; z += 7)
    for (double y = spacing / 2.0; y + spacing / 2.0 <= n; y += spacing)
      for (double x = spacing / 2.0; x + spacing / 2.0 <= n; x += spacing)
        text += "[" + std::to_string(x + shift()) + ", " + std::to_string(y + shift()) + ", " +
                std::to_string(z + 0.5 * shift()) + "], ";
  return text + "]\n[run]\nsteps = 1000\n";
}

}  // namespace silt::bench
