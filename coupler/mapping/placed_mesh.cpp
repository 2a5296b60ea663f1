#include "coupler/mapping/placed_mesh.hpp"

#include <cmath>
#include <numeric>

namespace silt::coupler {

using rigid::Vec3;

void PlacedMesh::place(const rigid::TriangleMesh& mesh, const rigid::Pose& pose) {
  if (mesh_ == &mesh && pose_ == pose) return;
  mesh_ = &mesh, pose_ = pose;
  corner_.resize(mesh.vertices().size()), rough_.resize(3 * mesh.vertices().size());
  for (int d = 0; d < 3; ++d) base_[d] = std::llround(pose.position[d]);
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> turn = pose.orientation.toRotationMatrix();
      mesh_kernels().place_corners(mesh.vertices().data()->data(), corner_.size(), turn.data(),
                                   pose.position.data(), base_.data(), corner_.data(), rough_.data());
}

rigid::BoundingBox PlacedMesh::box() const {
  const rigid::BoundingBox& own = mesh_->box();
  const rigid::Mat3 turn = pose_.orientation.toRotationMatrix();
  return rigid::BoundingBox::around(pose_.position + turn * (0.5 * (own.lower + own.upper)),
                                    turn.cwiseAbs() * (0.5 * (own.upper - own.lower)));
}

TriangleView PlacedMesh::near(const Vec3& low, const Vec3& high) {
  const rigid::Mat3 to_body = pose_.orientation.toRotationMatrix().transpose();
  const Vec3 slack = Vec3::Constant(1e-3);  // cells: of rounding to units and of the turned box
  const Vec3 middle = to_body * (0.5 * (low + high) - pose_.position);
  const Vec3 half = to_body.cwiseAbs() * (0.5 * (high - low) + slack);
  const rigid::BoundingBox all = box();
  near_.clear();
  if ((all.lower.array() >= low.array()).all() && (all.upper.array() <= high.array()).all()) {
    near_.resize(mesh_->triangles().size());
    std::iota(near_.begin(), near_.end(), 0u);
  } else {
    mesh_->for_near({middle - half, middle + half},
                    [&](std::uint32_t triangle) { near_.push_back(triangle); });
  }
  static_assert(sizeof(rigid::TriangleMesh::Triangle) == sizeof(std::uint32_t[3]));
  return {reinterpret_cast<const std::uint32_t(*)[3]>(mesh_->triangles().data()),
          near_.data(),
          near_.size(),
          corner_.data(),
          rough_.data(),
          {base_[0], base_[1], base_[2]}};
}

}  // namespace silt::coupler
