#include "coupler/placement/body_records.hpp"

#include "coupler/case/case.hpp"

namespace silt::coupler {

namespace {

using rigid::Vec3;

void store(const Vec3& v, double* to) {
  Eigen::Map<Vec3>{to} = v;
}

}  // namespace

std::vector<CentredShape> centred_shapes(const Case& setup) {
  std::vector<CentredShape> shapes;
  for (const rigid::Shape& shape : setup.shapes) {
    const rigid::MassProperties mass = rigid::mass_properties(shape);
    shapes.push_back({shape, mass.volume, rigid::bounding_radius(shape), mass.inertia});
  }
  return shapes;
}

rigid::BodyRecord body_record(rigid::BodyId id, const BodySpec& body, const CentredShape& shape,
                              bool in_fluid) {
  rigid::BodyRecord r;
  r.id = id;
  r.shape = body.shape, r.material = body.material, r.kind = body.kind;
  r.motion = body.motion;
  r.mass = body.density * shape.volume;
  r.weight_in_fluid = in_fluid ? 1 - 1 / body.density : 1;
  Eigen::Map<rigid::Mat3>{r.inertia_B} = body.density * shape.inertia;
  rigid::Quat q = body.pose.orientation;
  if (!body.unit) q.normalize();
  store(body.pose.position, r.position);
  r.orientation[0] = q.w(), r.orientation[1] = q.x(), r.orientation[2] = q.y(), r.orientation[3] = q.z();
  store(body.velocity, r.velocity);
  store(body.angular_velocity, r.angular_velocity);
  return r;
}

}  // namespace silt::coupler
