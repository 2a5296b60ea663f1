#pragma once
// The bodies of a case as what the rigid bodies are made of: shapes on their centres of mass, and records.
#include <vector>

#include "rigid/bodies/body_set.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

struct Case;

/// A shape as the case gives it, put on its centre of mass.
struct CentredShape {
  rigid::Shape shape;
  double volume = 0, bounding_radius = 0;
  rigid::Vec3 centre = rigid::Vec3::Zero();   // of mass, in the frame the case gives the shape in
  rigid::Mat3 inertia = rigid::Mat3::Zero();  // of unit density
};
std::vector<CentredShape> centred_shapes(const Case&);

/// The bodies of a case as records: ids from 1 in the order of the case, poses of the centres of mass
/// (unwrapped).
std::vector<rigid::BodyRecord> body_records(const Case&, const std::vector<CentredShape>&);

}  // namespace silt::coupler
