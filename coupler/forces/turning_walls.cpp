#include "coupler/forces/turning_walls.hpp"

#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

using rigid::Vec3;

std::vector<TurningWalls::Impulse> TurningWalls::impulses(const rigid::BodySet& bodies) {
  std::vector<Impulse> all;
  for (std::size_t row = bodies.first_wall(); row < bodies.size(); ++row) {
    const Vec3 &v = bodies.velocity[row], &w = bodies.angular_velocity[row];
    const auto* const mesh = std::get_if<rigid::Mesh>(&world_.shapes[bodies.shape[row]]);
    if (!mesh || w.isZero(0)) continue;
    const rigid::MassProperties& solid = solid_of(bodies.shape[row]);
    const double sign = mesh->hollow ? -1 : 1;  // the solid of a hollow mesh is outside its volume
    const rigid::Mat3 turn = bodies.orientation[row].toRotationMatrix();
    const Vec3 centre = turn * solid.centre, axis = w.normalized();
    const Vec3 momentum = sign * solid.volume * w.cross(v + w.cross(centre));
    const Vec3 couple = sign * w.cross(turn * (solid.inertia * (turn.transpose() * w)));
    const Vec3 pair =
        couple.cross(axis);  // acting half a cell to either side along the axis it is the couple
    all.push_back({bodies.id[row], 0.5 * momentum + pair, centre + 0.5 * axis});
    all.push_back({bodies.id[row], 0.5 * momentum - pair, centre - 0.5 * axis});
  }
  return all;
}

const rigid::MassProperties& TurningWalls::solid_of(std::int32_t shape) {
  const auto known = solids_.find(shape);
  if (known != solids_.end()) return known->second;
  const rigid::Mesh& mesh = std::get<rigid::Mesh>(world_.shapes[shape]);
  return solids_.emplace(shape, mesh.surface->mass_properties()).first->second;
}

}  // namespace silt::coupler
