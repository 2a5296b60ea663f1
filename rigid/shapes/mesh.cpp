#include "rigid/shapes/mesh.hpp"

#include <stdexcept>

namespace silt::rigid {

namespace {

constexpr double boundless = std::numeric_limits<double>::infinity();

}  // namespace

double Mesh::signed_distance(const Vec3& x) const {
  const double distance = surface->nearest(x).distance;
  return contains(x) ? -distance : distance;
}

double Mesh::ray_distance(const Vec3& o, const Vec3& d, double t_max) const {
  const auto hit = surface->first_hit(o, d, t_max);
  return hit ? hit->t : t_max;
}

BoundingBox Mesh::bounding_box(const Pose& pose) const {
  if (hollow) return BoundingBox::everything();
  const Vec3 half = 0.5 * (surface->box().upper - surface->box().lower);
  const Vec3 middle = 0.5 * (surface->box().upper + surface->box().lower);
  const Mat3 turn = pose.orientation.toRotationMatrix();
  return BoundingBox::around(pose.position + turn * middle, turn.cwiseAbs() * half);
}

double Mesh::bounding_radius() const {
  return hollow ? boundless : surface->radius();
}

MassProperties Mesh::mass_properties() const {
  if (hollow) throw std::invalid_argument("a hollow mesh has no mass");
  return surface->mass_properties();
}

double Mesh::least_width() const {
  return hollow ? boundless : (surface->box().upper - surface->box().lower).minCoeff();
}

Mesh Mesh::recentred(const Vec3& centre) const {
  return {std::make_shared<const TriangleMesh>(surface->shifted(-centre)), hollow};
}

}  // namespace silt::rigid
