#pragma once
// A bed in Bullet's own world.
#include <memory>
#include <vector>

#include "tests/bench/bed.hpp"

namespace silt::bench {

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

}  // namespace silt::bench
