#pragma once
// What the tests of rigid/ share: a small world, bodies put into it, and steps.
#include <memory>

#include "adapters/automatic/collision_factory.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/rigid_step.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::rigid::testing {

inline constexpr double g = 9.81;  // m / s^2
inline const Vec3 down(0, 0, -g);

/// The collision backend of the scenes made from now on.
inline const char* backend_name = "analytic";
/// The broad phase of the scenes.
inline const char* broad_phase_name = "auto";

struct Scene {
  World world;
  BodySet bodies;
  Extent extent;
  ResolverSettings settings;
  std::unique_ptr<ContactResolver> resolver;
  std::unique_ptr<BodyExchange> exchange;
  std::unique_ptr<CollisionBackend> backend = adapters::make_backend(backend_name);
  std::unique_ptr<RigidStep> step;
  RigidStepReport report;
  double deepest = 0;

  Scene(double restitution, double friction, Vec3 size = Vec3::Constant(100.0)) {
    world.materials = {{restitution, friction}};
    world.material_count = 1;
    extent.size = size;
  }
  int shape(Shape s) {
    world.bounding_radii.push_back(bounding_radius(s));
    world.shapes.push_back(std::move(s));
    return static_cast<int>(world.shapes.size()) - 1;
  }
  /// A body of density 1 times `mass` / its volume. Returns its id; ids count up from 0.
  BodyId add(int shape, const Vec3& x, const Vec3& v = Vec3::Zero(), const Vec3& w = Vec3::Zero(),
             double mass = 1) {
    return add_with_id(next_id_++, shape, {x}, v, w, mass);
  }
  BodyId add_with_id(BodyId id, int shape, const Pose& pose, const Vec3& v = Vec3::Zero(),
                     const Vec3& w = Vec3::Zero(), double mass = 1) {
    append(id, shape, pose.position, pose.orientation, mass);
    bodies.reindex();
    bodies.set_velocity(bodies.row_of(id), v, w);
    return id;
  }
  /// At rest. The caller reindexes when all are in.
  void append(BodyId id, int shape, const Vec3& x, const Quat& q, double mass = 1) {
    while (masses_.size() <= static_cast<std::size_t>(shape))
      masses_.push_back(mass_properties(world.shapes[masses_.size()]));
    const MassProperties& p = masses_[shape];
    BodyRecord r;
    r.id = id;
    r.shape = shape;
    r.mass = mass;
    Eigen::Map<Mat3>{r.inertia_B} = p.inertia * (mass / p.volume);
    Eigen::Map<Vec3>{r.position} = x;
    r.orientation[0] = q.w(), r.orientation[1] = q.x(), r.orientation[2] = q.y(), r.orientation[3] = q.z();
    bodies.add(r);
  }
  void floor(const Vec3& velocity = Vec3::Zero()) {
    std::array<WallSpec, 6> walls;
    walls[4].solid = true;
    walls[4].velocity = velocity;
    add_walls(bodies, world, extent, walls);
  }
  void start(std::string_view name = "sffd") {
    set_materials(settings, world);
    resolver = make_resolver(name, settings);
    exchange = std::make_unique<BodyExchange>(extent);
    step = std::make_unique<RigidStep>(world, *backend, *resolver, *exchange,
                                       adapters::make_broad_phase(broad_phase_name));
  }
  void run(int steps, double dt = 1e-3) {
    for (int i = 0; i < steps; ++i) {
      report = (*step)(bodies, dt);
      deepest = std::max(deepest, report.resolver.penetration);
    }
  }
  std::size_t row(BodyId id) const { return bodies.row_of(id); }
  Vec3 x(BodyId id) const { return bodies.position[row(id)]; }
  Vec3 v(BodyId id) const { return bodies.velocity[row(id)]; }
  Vec3 w(BodyId id) const { return bodies.angular_velocity[row(id)]; }
  Vec3 momentum() const {
    Vec3 p = Vec3::Zero();
    for (std::size_t r = 0; r < bodies.owned; ++r) p += bodies.mass[r] * bodies.velocity[r];
    return p;
  }
  Vec3 angular_momentum() const {
    Vec3 l = Vec3::Zero();
    for (std::size_t r = 0; r < bodies.owned; ++r)
      l += bodies.angular_momentum[r] + bodies.mass[r] * bodies.position[r].cross(bodies.velocity[r]);
    return l;
  }
  double kinetic_energy() const {
    double e = 0;
    for (std::size_t r = 0; r < bodies.owned; ++r) e += bodies.kinetic_energy(r);
    return e;
  }

 private:
  BodyId next_id_ = 0;
  std::vector<MassProperties> masses_;  // of the shapes
};

}  // namespace silt::rigid::testing
