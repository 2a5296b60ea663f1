#include "coupler/mapping/mesh_distances.hpp"

#include <algorithm>
#include <bit>

#include "coupler/mapping/bit_kernel.hpp"
#include "lbm/walls/cut_links.hpp"

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

void MeshDistances::find(const rigid::Mesh& mesh, const BlockMap& map, const BodyMask& mask) {
  mesh_ = &mesh, map_ = &map, mask_ = &mask;
  find_near_cells();
  PlacedMesh& placed = placed_.at(*mesh.surface, mask.pose, mask.reflection);
  const Int3 low = map.box.lower - mask.shift + mask.frame().low, high = low + mask.frame().size;
  mesh_kernels().cut_links(placed.near(Vec3(low.x, low.y, low.z), Vec3(high.x, high.y, high.z)), low, view());
}

void MeshDistances::find_near_cells() {
  const BitFrame& f = mask_->frame();
  const Int3 n = map_->box.size;
  near_.reset(f), fluid_.reset(f);
  bit_kernels().widen(f, mask_->bits.words(), near_.words());
  fill_rows(fluid_, n, 0,
            [&](int x, int y, int z) { return ~map_->solid.from(x, y, z) & cells_between(x, 0, n.x); });
  before_.resize(f.words());
  std::uint32_t count = 0;
  for (std::size_t k = 0; k < f.words(); ++k) {
    near_.words()[k] &= fluid_.words()[k];
    before_[k] = count;
    count += std::uint32_t(std::popcount(near_.words()[k]));
  }
  least_.assign(std::size_t(count) * lbm::D3Q19::directions, LinkDistances::none);
}

LinkDistances MeshDistances::view() {
  return {mask_->frame(), mask_->bits.words(), near_.words(), before_.data(), least_.data()};
}

template <class T>
void MeshDistances::set(Int3 corner, const std::uint32_t* place, std::size_t count, T* q) {
  looked_up_.resize(std::max(looked_up_.size(), count));
  mesh_kernels().look_up(view(), corner, place, count, looked_up_.data());
  for (std::size_t k = 0; k < count; ++k)
    q[k] = T(looked_up_[k] != LinkDistances::none
                 ? double(looked_up_[k]) / double(cell_units)
                 : by_nearest_points(corner + lbm::place_cell(place[k]), lbm::place_direction(place[k])));
}
template void MeshDistances::set(Int3, const std::uint32_t*, std::size_t, float*);
template void MeshDistances::set(Int3, const std::uint32_t*, std::size_t, double*);

double MeshDistances::by_nearest_points(Int3 cell, int direction) const {
  const auto from_surface = [&](Int3 x) {
    const Vec3 in_world = mask_->arm(map_->box.lower + x) + mask_->pose.position;
    return mesh_->surface->nearest(mask_->pose.to_body(mask_->reflection.point(in_world))).distance;
  };
  const double near = from_surface(cell), far = from_surface(cell + lbm::D3Q19::c[direction]);
  return near + far > 0 ? near / (near + far) : 0;
}

}  // namespace silt::coupler
