#pragma once
// Scenes of coupled benchmarks, after the paper's: layers of equal bodies that move through a periodic box,
// a little out of line. Case A: 6.3 % of the volume is solid, case B: 20.0 % (the paper's 19.8): spheres of
// 6 cells in layers 7 cells apart, 16 and 9 cells beside one another in a layer, or other bodies with all of
// that to their scale. A box is whole periods long, so that the share is the same in all boxes.
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "lbm/blocks/lattice.hpp"

namespace silt::bench {

/// A shape, turned so that none touches the next one in case B, whatever the shifts.
struct LayerBody {
  const char* name;
  double diameter;    // cells, of the sphere of the same volume
  const char* shape;  // lines of [[shapes]]
  const char* turn;   // lines of [[bodies]]
};
inline constexpr LayerBody layer_bodies[] = {
    {"d6", 6, "type = \"sphere\"\ndiameter = 6\n", ""},
    {"d10", 10, "type = \"sphere\"\ndiameter = 10\n", ""},
    {"d20", 20, "type = \"sphere\"\ndiameter = 20\n", ""},
    {"box", 10, "type = \"box\"\nedges = [8.06, 8.06, 8.06]\n",
     "orientation = { axis = [1, 2, 3], degrees = 10 }\n"},
    {"capsule", 10, "type = \"capsule\"\nradius = 3.684\nlength = 7.368\n", "orientation = [1, 1, 0.2]\n"},
    // three capsules crossed at right angles, standing on three of their ends
    {"star", 10,
     "type = \"compound\"\nparts = [{ type = \"capsule\", radius = 2.48, length = 8.69, orientation = [1, 0, "
     "0] }, { type = \"capsule\", radius = 2.48, length = 8.69, orientation = [0, 1, 0] }, { type = "
     "\"capsule\", radius = 2.48, length = 8.69, orientation = [0, 0, 1] }]\n",
     "orientation = { axis = [1, -1, 0], degrees = 54.7356 }\n"}};

inline const LayerBody& layer_body(const std::string& name) {
  for (const LayerBody& body : layer_bodies)
    if (name == body.name) return body;
  throw std::invalid_argument("no body " + name);
}

struct Layers {
  char name = 'a';  // a or b
  std::string body = "d6";
  int edge = 32;  // cells, about
  std::string scheme = "cli", time = "implicit";
  double speed = 0.01;                   // cells a step
  std::array<int, 3> boxes = {1, 1, 1};  // of that edge, beside one another

  /// Returns how often the arrangement is repeated along each axis.
  std::array<int, 3> periods() const {
    const double scale = layer_body(body).diameter / 6, across = (name == 'a' ? 16 : 9) * scale;
    const auto fitting = [&](double period) { return std::max(1, int(std::lround(edge / period))); };
    return {boxes[0] * fitting(across), boxes[1] * fitting(across), boxes[2] * fitting(7 * scale)};
  }
  lbm::Int3 cells() const {
    const double scale = layer_body(body).diameter / 6, across = (name == 'a' ? 16 : 9) * scale;
    const auto [nx, ny, nz] = periods();
    return {int(std::lround(nx * across)), int(std::lround(ny * across)), int(std::lround(nz * 7 * scale))};
  }
  /// So that no direction of the lattice is special. Cells a step.
  std::array<double, 3> velocity() const {
    constexpr double x = 0.6, y = 0.5, z = 0.62;
    const double scale = speed / std::sqrt(x * x + y * y + z * z);
    return {scale * x, scale * y, scale * z};
  }

  /// The text of a case, in single precision.
  std::string text() const {
    const LayerBody& kind = layer_body(body);
    return "title = \"layers of bodies\"\n[units]\nsystem = \"lattice\"\n[domain]\nsize = " +
           list(cells().x, cells().y, cells().z) +
           "\nboundary = \"periodic\"\n[fluid]\nrelaxation_time = 1.2\n[coupling]\nwall_scheme = \"" +
           scheme + "\"\ntime = \"" + time + "\"\n[[shapes]]\nname = \"body\"\n" + kind.shape +
           "[[bodies]]\nshape = \"body\"\ndensity = 1.2\n" + kind.turn +
           "velocity = " + list(velocity()[0], velocity()[1], velocity()[2]) + "\npositions = [" + centres() +
           "]\n[run]\nsteps = 100000\n";
  }

 private:
  template <class T>
  static std::string list(T x, T y, T z) {
    std::string text = "[";
    return text.append(std::to_string(x))
               .append(", ")
               .append(std::to_string(y))
               .append(", ")
               .append(std::to_string(z)) += "]";
  }
  /// Each shifted by up to one cell in its layer, by half to one across.
  std::string centres() const {
    unsigned random = 1;
    const auto shift = [&] {
      return random = random * 1664525u + 1013904223u, (random >> 8) / double(1 << 24);
    };
    const auto [nx, ny, nz] = periods();
    const auto at = [](int i, int n, int cells) { return (i + 0.5) * cells / n; };
    std::string all;
    for (int k = 0; k < nz; ++k)
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) {
          const double x = at(i, nx, cells().x) + shift(), y = at(j, ny, cells().y) + shift();
          all += list(x, y, at(k, nz, cells().z) + 0.5 * (1 + shift())) + ", ";
        }
    return all;
  }
};

}  // namespace silt::bench
