#include "coupler/mapping/mesh_cells.hpp"

#include <algorithm>

#include "coupler/mapping/window_rows.hpp"

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

namespace {

/// Bit k of the result: whether an odd number of bits up to k is set.
std::uint64_t parity_up_to(std::uint64_t bits) {
  for (int shift = 1; shift < 64; shift *= 2) bits ^= bits << shift;
  return bits;
}

/// From the cells where rows change sides to those that are inside.
void fill(BitWindow& window, bool hollow) {
  const BitFrame& f = window.frame();
  const std::uint64_t width = f.pitch >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << f.pitch) - 1;
  for (int z = 2; z < f.size.z - 2; ++z)
    for (int y = 2; y < f.size.y - 2; ++y) {
      const std::size_t row = f.row(f.low.y + y, f.low.z + z);
      std::uint64_t before = 0;  // all ones: inside at the end of the last word
      for (int x = 0; x < f.pitch; x += 64) {
        std::uint64_t& word = window.words()[(row + x) >> 6];
        const int at = int(row & 63);
        const std::uint64_t changes = word >> at & width, inside = parity_up_to(changes) ^ before;
        before = inside >> (std::min(f.pitch, 64) - 1) & 1 ? ~std::uint64_t{0} : 0;
        const std::uint64_t marked = (hollow ? ~inside : inside) & cells_between(x, 2, f.size.x - 2);
        word ^= (changes ^ marked) << at;
      }
    }
}

}  // namespace

void mark_mesh(const rigid::Mesh& mesh, PlacedMesh& placed, Int3 low, BitWindow& window) {
  const BitFrame& f = window.frame();
  const Vec3 first(std::min<double>(placed.box().lower[0], low.x), low.y,
                   low.z);  // what is before a row matters
  const Vec3 last(low.x + f.size.x, low.y + f.size.y, low.z + f.size.z);
  mesh_kernels().mark_changes(placed.near(first, last), f, low, window.words());
  fill(window, mesh.hollow);
}

}  // namespace silt::coupler
