#pragma once
// A bed in rigid/, on one rank.
#include <memory>
#include <vector>

#include "adapters/automatic/collision_factory.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/collision/detect_contacts.hpp"
#include "rigid/rigid_step.hpp"
#include "tests/bench/bed.hpp"

namespace silt::bench {

/// A bed in Bullet's own world (bullet_world.cpp).
class BulletWorld {
 public:
  explicit BulletWorld(const Bed&);
  ~BulletWorld();
  void step(double dt);
  int contacts() const;                    // points its solver was given
  std::vector<rigid::Pose> poses() const;  // in the bed's order

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

inline rigid::World world_of(const Bed& bed) {
  rigid::World world;
  world.shapes.assign(bed.shapes.begin(), bed.shapes.end());
  for (const rigid::Shape& shape : bed.shapes) world.bounding_radii.push_back(rigid::bounding_radius(shape));
  world.materials = {{Bed::restitution, Bed::friction}};
  world.material_count = 1;
  world.gravity = {0, 0, -Bed::gravity};
  return world;
}

inline rigid::BodySet bodies_of(const Bed& bed, rigid::World& world) {
  using namespace rigid;
  std::vector<MassProperties> masses;
  for (const Shape& shape : bed.shapes) masses.push_back(mass_properties(shape));
  BodySet bodies;
  for (std::size_t i = 0; i < bed.bodies.size(); ++i) {
    const auto& [shape, pose] = bed.bodies[i];
    BodyRecord r;
    r.id = i;
    r.shape = shape;
    r.mass = Bed::density * masses[shape].volume;
    Eigen::Map<Mat3>{r.inertia_B} = Bed::density * masses[shape].inertia;
    Eigen::Map<Vec3>{r.position} = pose.position;
    r.orientation[0] = pose.orientation.w();
    Eigen::Map<Vec3>{r.orientation + 1} = pose.orientation.vec();
    bodies.add(r);
  }
  std::array<WallSpec, 6> walls;
  for (int side = 0; side < 5; ++side) walls[side].solid = true;
  add_walls(bodies, world, {bed.size, {}}, walls);
  return bodies;
}

class SiltWorld {
 public:
  SiltWorld(const Bed& bed, int sweeps)
      : world_(world_of(bed)), bodies_(bodies_of(bed, world_)), exchange_({bed.size, {}}) {
    rigid::ResolverSettings settings;
    settings.max_sweeps = sweeps;
    resolver_ = rigid::make_resolver("sffd", settings);
    step_ = std::make_unique<rigid::RigidStep>(world_, *backend_, *resolver_, exchange_);
  }
  rigid::RigidStepReport step(double dt) { return (*step_)(bodies_, dt); }
  const rigid::RigidClock::Seconds& seconds() const { return step_->clock().seconds(); }
  std::vector<rigid::Pose> poses() const {
    std::vector<rigid::Pose> poses;
    for (std::size_t row = 0; row < bodies_.owned; ++row) poses.push_back(bodies_.pose(row));
    return poses;
  }

 private:
  rigid::World world_;
  rigid::BodySet bodies_;
  rigid::BodyExchange exchange_;
  std::unique_ptr<rigid::CollisionBackend> backend_ = adapters::make_backend("auto");
  std::unique_ptr<rigid::ContactResolver> resolver_;
  std::unique_ptr<rigid::RigidStep> step_;
};

struct Overlap {
  double deepest = 0;  // m
  double mean = 0;     // m: all overlaps' sum over the number of bodies
};

/// Measures the overlaps of the bodies of a bed, wherever another code has put them.
class MeasureOverlap {
 public:
  explicit MeasureOverlap(const Bed& bed)
      : world_(world_of(bed)), bodies_(bodies_of(bed, world_)), exchange_({bed.size, {}}) {}
  Overlap operator()(const std::vector<rigid::Pose>& poses) {
    for (std::size_t row = 0; row < poses.size(); ++row) bodies_.set_pose(row, poses[row]);
    detect_(world_, bodies_, exchange_, *backend_, 0, contacts_);
    Overlap overlap;
    for (const rigid::Contact& c : contacts_) {
      overlap.deepest = std::max(overlap.deepest, -c.gap);
      overlap.mean += std::max(0.0, -c.gap) / static_cast<double>(poses.size());
    }
    return overlap;
  }

 private:
  rigid::World world_;
  rigid::BodySet bodies_;
  rigid::BodyExchange exchange_;
  std::unique_ptr<rigid::CollisionBackend> backend_ = adapters::make_backend("auto");
  rigid::DetectContacts detect_;
  std::vector<rigid::Contact> contacts_;
};

}  // namespace silt::bench
