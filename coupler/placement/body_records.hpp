#pragma once
// The bodies of a case as what the rigid bodies are made of: shapes on their centres of mass, and records.
#include <vector>

#include "coupler/case/case.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

struct Case;

/// A shape about its centre of mass, and what follows from it.
struct CentredShape {
  rigid::Shape shape;
  double volume = 0, bounding_radius = 0;
  rigid::Mat3 inertia = rigid::Mat3::Zero();  // of unit density
};
std::vector<CentredShape> centred_shapes(const Case&);

/// Returns a body as a record: the pose is that of its centre of mass, not wrapped; in a fluid of density 1
/// it has buoyancy.
rigid::BodyRecord body_record(rigid::BodyId, const BodySpec&, const CentredShape&, bool in_fluid);

}  // namespace silt::coupler
