#include "coupler/mapping/placed_mesh.hpp"

#include <algorithm>

namespace silt::coupler {

using lbm::Int3;
using rigid::Vec3;

/// A triangle meets no plane if its corners lie strictly between the same two planes.
template <class Number>
void SortedByPlanes::sort(std::span<const rigid::TriangleMesh::Triangle> triangles,
                          const std::vector<Corner>& corners, std::size_t count, Number&& number) {
  constexpr std::size_t part = 1024;  // triangles per part
  constexpr std::uint64_t of_x = Corner::of_x, of_y = of_x << Corner::field, of_z = of_y << Corner::field;
  lists_.resize(std::max(lists_.size(), 4 * (count + 1)));
  parts_.clear();
  for (std::size_t first = 0; first < count; first += part) {
    const std::size_t end = std::min(first + part, count);
    std::uint32_t* list[4];
    std::size_t found[4] = {};
    for (std::size_t k = 0; k < 4; ++k) list[k] = lists_.data() + 4 * first + k * (end - first);
    for (std::size_t n = first; n < end; ++n) {
      const auto& t = triangles[number(n)];
      const std::uint64_t a = corners[t[0]].between, b = corners[t[1]].between, c = corners[t[2]].between;
      const std::uint64_t apart = (a ^ b) | (b ^ c) | ((a | b | c) & Corner::is_whole);
      const unsigned x = (apart & of_x) != 0, y = (apart & of_y) != 0, z = (apart & of_z) != 0;
      const unsigned takes[] = {x, y, z, y & z};
      for (int k = 0; k < 4; ++k) {
        list[k][found[k]] = std::uint32_t(number(n));
        found[k] += takes[k];
      }
    }
    TrianglesByPlanes& sorted = parts_.emplace_back();
    for (int d = 0; d < 3; ++d) sorted.in_plane[d] = {list[d], found[d]};
    sorted.on_x_axis = {list[3], found[3]};
  }
}

void PlacedMesh::place(const rigid::TriangleMesh& mesh, const rigid::Pose& pose,
                       const Reflection& reflection) {
  if (mesh_ == &mesh && pose_ == pose && reflection_ == reflection) return;
  mesh_ = &mesh, pose_ = pose, reflection_ = reflection, all_sorted_ = false;
  position_ = reflection.point(pose.position), turn_ = pose.orientation.toRotationMatrix();
  for (int d = 0; d < 3; ++d) turn_.row(d) *= reflection.of_vector(d);
  corner_.resize(mesh.vertices().size());
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> turn = turn_;
  mesh_kernels().place_corners(mesh.vertices().data()->data(), corner_.size(), turn.data(), position_.data(),
                               corner_.data());
  if (2 * mesh.radius() >= Corner::distinct)  // lattice points are ambiguous: use all triangles
    for (Corner& corner : corner_) corner.between |= Corner::is_whole;
}

rigid::BoundingBox PlacedMesh::box() const {
  const rigid::BoundingBox& own = mesh_->box();
  return rigid::BoundingBox::around(position_ + turn_ * (0.5 * (own.lower + own.upper)),
                                    turn_.cwiseAbs() * (0.5 * (own.upper - own.lower)));
}

TriangleView PlacedMesh::near(const Vec3& low, const Vec3& high) {
  static_assert(sizeof(rigid::TriangleMesh::Triangle) == sizeof(std::uint32_t[3]));
  const auto view = [&](const SortedByPlanes& sorted) {
    return TriangleView{reinterpret_cast<const std::uint32_t(*)[3]>(mesh_->triangles().data()),
                        corner_.data(), sorted.parts()};
  };
  const rigid::BoundingBox whole = box();
  if ((whole.lower.array() >= low.array()).all() && (whole.upper.array() <= high.array()).all()) {
    if (!all_sorted_)
      of_all_.sort(mesh_->triangles(), corner_, mesh_->triangles().size(), [](std::size_t k) { return k; });
    all_sorted_ = true;
    return view(of_all_);
  }
  const rigid::Mat3 to_body = turn_.transpose();
  const Vec3 slack = Vec3::Constant(1e-3);  // cells, for rounding to units and the rotated box
  const Vec3 middle = to_body * (0.5 * (low + high) - position_);
  const Vec3 half = to_body.cwiseAbs() * (0.5 * (high - low) + slack);
  near_.clear();
  mesh_->for_near({middle - half, middle + half}, [&](std::uint32_t triangle) { near_.push_back(triangle); });
  of_near_.sort(mesh_->triangles(), corner_, near_.size(), [&](std::size_t k) { return near_[k]; });
  return view(of_near_);
}

namespace {

/// Returns a word whose bit k tells whether an odd number of bits up to k is set.
std::uint64_t parity_up_to(std::uint64_t bits) {
  for (int shift = 1; shift < 64; shift *= 2) bits ^= bits << shift;
  return bits;
}

/// Turns bits where rows change sides into bits of cells inside.
void fill(BitWindow& window, bool hollow) {
  const BitFrame& f = window.frame();
  const std::uint64_t width = f.row_bits();
  for (int z = 2; z < f.size.z - 2; ++z)
    for (int y = 2; y < f.size.y - 2; ++y) {
      const std::size_t row = f.row(f.low.y + y, f.low.z + z);
      std::uint64_t before = 0;  // all ones: the last word ended inside
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

void PlacedMesh::mark(bool hollow, Int3 low, BitWindow& window) {
  const BitFrame& f = window.frame();
  const double before_rows = std::min<double>(box().lower[0], low.x);  // triangles before a row count, too
  const Vec3 first(before_rows, low.y, low.z), last(low.x + f.size.x, low.y + f.size.y, low.z + f.size.z);
  mesh_kernels().mark_changes(near(first, last), f, low, window.words());
  fill(window, hollow);
}

}  // namespace silt::coupler
