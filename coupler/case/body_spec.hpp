#pragma once
// The bodies: [[bodies]], [[fill]] and [[outflow]] of a case.
#include <cstdint>
#include <limits>

#include "coupler/case/name_table.hpp"
#include "coupler/case/position_file.hpp"
#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

inline constexpr auto motion_names = names_of<rigid::Motion>("free", "fixed", "prescribed");

struct BodySpec {  // one body
  int shape = 0, material = 0;
  int kind = 0;             // index into Case::kind_names
  int entry = -1;           // which [[bodies]] entry gave it; -1: a [[fill]]
  std::uint64_t point = 0;  // of a file of positions, from 1 on; 0: the case says where it is
  double density = 1;       // relative to the fluid's (lattice)
  rigid::Motion motion = rigid::Motion::free;
  rigid::Pose pose;   // of the centre of mass
  bool unit = false;  // the orientation is of length 1 as it stands, to the last bit: as a file has it
  rigid::Vec3 origin = rigid::Vec3::Zero();  // the point that a position of the case places, from the centre
  rigid::Vec3 velocity = rigid::Vec3::Zero(), angular_velocity = rigid::Vec3::Zero();

  rigid::Vec3 given_position() const { return pose.to_world(origin); }
};

/// Bodies of one [[bodies]] entry whose positions stand in a file.
struct FiledBodies {
  BodySpec alike;  // but for what the file says; velocities that it says: the largest
  PositionFile positions;
  PositionContents contents;
};

enum class Arrangement { random, simple_cubic, hexagonal, layers };
inline constexpr auto arrangement_names =
    names_of<Arrangement>("random", "simple-cubic", "hexagonal", "layers");

struct FillSpec {
  int shape = 0, material = 0, kind = 0;
  std::int64_t count = 0;       // 0: as many as there are sites for, not at random
  double density = 1, gap = 0;  // gap: least distance between bounding spheres' surfaces and to walls
  Arrangement arrangement = Arrangement::random;
  double spacing = 0;  // of sites, not at random; 0: the least
  double shift = 0;    // furthest that a body is moved from its site
  bool random_orientation = true;
  rigid::Vec3 lower = rigid::Vec3::Zero(), upper = rigid::Vec3::Zero();
  std::uint64_t seed = 1;
  rigid::Vec3 velocity = rigid::Vec3::Zero();  // of the bodies when they are placed
  std::int64_t every = 0;                      // steps between two applications; 0: at the start only
  double until = std::numeric_limits<double>::infinity();  // no application after this step

  /// Whether it is applied again before the step that follows so many.
  bool comes_at(std::int64_t steps_done) const {
    return every > 0 && steps_done > 0 && steps_done % every == 0 && static_cast<double>(steps_done) <= until;
  }
};

/// A box out of which free bodies are taken as soon as their centre of mass is in it.
struct OutflowSpec {
  rigid::Vec3 lower = rigid::Vec3::Zero(), upper = rigid::Vec3::Zero();
};

}  // namespace silt::coupler
