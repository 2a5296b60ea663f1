#include "coupler/mapping/mesh_crossings.hpp"

namespace silt::coupler {

using rigid::Vec3;

void PlacedMesh::place(const rigid::TriangleMesh& mesh, const rigid::Pose& pose) {
  mesh_ = &mesh, pose_ = pose;
  corner_.resize(mesh.vertices().size());
  rounded_.assign(mesh.vertices().size(), 0);
}

rigid::BoundingBox PlacedMesh::box() const {
  const rigid::BoundingBox& own = mesh_->box();
  const rigid::Mat3 turn = pose_.orientation.toRotationMatrix();
  return rigid::BoundingBox::around(pose_.position + turn * (0.5 * (own.lower + own.upper)),
                                    turn.cwiseAbs() * (0.5 * (own.upper - own.lower)));
}

const std::vector<std::uint32_t>& PlacedMesh::near(const Vec3& low, const Vec3& high) {
  const rigid::Mat3 to_body = pose_.orientation.toRotationMatrix().transpose();
  const Vec3 slack = Vec3::Constant(1e-3);  // cells: of rounding to units and of the turned box
  const Vec3 middle = to_body * (0.5 * (low + high) - pose_.position);
  const Vec3 half = to_body.cwiseAbs() * (0.5 * (high - low) + slack);
  near_.clear();
  mesh_->for_near({middle - half, middle + half}, [&](std::uint32_t triangle) {
    near_.push_back(triangle);
    round_corners(triangle);
  });
  return near_;
}

void PlacedMesh::round_corners(std::uint32_t triangle) {
  const rigid::Mat3 turn = pose_.orientation.toRotationMatrix();
  for (const std::uint32_t k : mesh_->triangles()[triangle]) {
    if (rounded_[k]) continue;
    rounded_[k] = 1;
    const Vec3 x = pose_.position + turn * mesh_->vertices()[k];
    for (int d = 0; d < 3; ++d) corner_[k][d] = std::llround((x[d] - 0.5) * double(cell_units));
  }
}

}  // namespace silt::coupler
