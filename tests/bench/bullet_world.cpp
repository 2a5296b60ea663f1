// The only file of the benchmarks that sees Bullet's headers.
#include "tests/bench/silt_world.hpp"

#include <btBulletDynamicsCommon.h>

#ifndef BT_USE_DOUBLE_PRECISION
#error "build against bullet-float64"
#endif

namespace silt::bench {

namespace {

btVector3 to_bullet(const rigid::Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

std::unique_ptr<btCollisionShape> bullet_shape(const rigid::Shape& shape) {
  if (const auto* sphere = std::get_if<rigid::Sphere>(&shape))
    return std::make_unique<btSphereShape>(sphere->radius);
  if (const auto* cylinder = std::get_if<rigid::Cylinder>(&shape))
    return std::make_unique<btCylinderShapeZ>(
        btVector3(cylinder->radius, cylinder->radius, cylinder->half_length));
  return std::make_unique<btBoxShape>(to_bullet(std::get<rigid::Box>(shape).half_edges));
}

/// Room for every contact of the bed in the pool: beyond it Bullet allocates one by one.
btDefaultCollisionConstructionInfo pools(std::size_t bodies) {
  btDefaultCollisionConstructionInfo info;
  info.m_defaultMaxPersistentManifoldPoolSize = static_cast<int>(12 * bodies);
  info.m_defaultMaxCollisionAlgorithmPoolSize = static_cast<int>(12 * bodies);
  return info;
}

}  // namespace

struct BulletWorld::Parts {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher;
  btDbvtBroadphase broad_phase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world;
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;

  explicit Parts(std::size_t count)
      : configuration(pools(count)),
        dispatcher(&configuration),
        world(&dispatcher, &broad_phase, &solver, &configuration) {}
  ~Parts() {
    for (auto& body : bodies) world.removeRigidBody(body.get());
  }

  void add(btCollisionShape* shape, const rigid::Pose& pose, double mass) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, inertia);
    const auto& q = pose.orientation;
    info.m_startWorldTransform =
        btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), to_bullet(pose.position));
    // Bullet multiplies what two bodies bring
    info.m_friction = std::sqrt(Bed::friction);
    info.m_restitution = std::sqrt(Bed::restitution);
    bodies.push_back(std::make_unique<btRigidBody>(info));
    bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(bodies.back().get());
  }

  void add_wall(const rigid::Vec3& lower, const rigid::Vec3& upper) {
    shapes.push_back(std::make_unique<btBoxShape>(to_bullet(0.5 * (upper - lower))));
    add(shapes.back().get(), {0.5 * (lower + upper), rigid::Quat::Identity()}, 0);
  }
};

BulletWorld::BulletWorld(const Bed& bed) : parts_(std::make_unique<Parts>(bed.bodies.size())) {
  parts_->world.setGravity(btVector3(0, 0, -Bed::gravity));
  for (const rigid::Shape& shape : bed.shapes) parts_->shapes.push_back(bullet_shape(shape));
  for (const Bed::Body& body : bed.bodies)
    parts_->add(parts_->shapes[body.shape].get(), body.pose,
                Bed::density * rigid::mass_properties(bed.shapes[body.shape]).volume);
  constexpr double thick = 5;
  const rigid::Vec3 outside = rigid::Vec3::Constant(thick);
  for (int side = 0; side < 5; ++side) {
    rigid::Vec3 lower = -outside, upper = bed.size + outside;
    const int axis = side / 2;
    if (side % 2)
      lower[axis] = bed.size[axis];
    else
      upper[axis] = 0;
    parts_->add_wall(lower, upper);
  }
}

BulletWorld::~BulletWorld() = default;

void BulletWorld::step(double dt) {
  parts_->world.stepSimulation(dt, 0);
}

int BulletWorld::contacts() const {
  int points = 0;
  for (int i = 0; i < parts_->dispatcher.getNumManifolds(); ++i)
    points += parts_->dispatcher.getManifoldByIndexInternal(i)->getNumContacts();
  return points;
}

std::vector<rigid::Pose> BulletWorld::poses() const {
  std::vector<rigid::Pose> poses;
  for (std::size_t i = 0; i + 5 < parts_->bodies.size(); ++i) {
    const btTransform& t = parts_->bodies[i]->getWorldTransform();
    const btVector3& x = t.getOrigin();
    const btQuaternion q = t.getRotation();
    poses.push_back({{x.x(), x.y(), x.z()}, {q.w(), q.x(), q.y(), q.z()}});
  }
  return poses;
}

}  // namespace silt::bench
