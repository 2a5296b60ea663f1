#pragma once
// Stops a run whose bodies gain energy though nothing drives them: contacts may only take it.
//
// Compared are the kinetic energy of the free bodies and their potential energy in gravity with what they
// were at the start, less what bodies that came brought, with what those that left took. What is allowed
// beyond that is what collisions of several bodies in one step and the correction of overlaps do in a sound
// run, and far below what an unsound one has some tens of steps after its onset. The sums over the ranks are
// started at the end of a step and waited for at the end of the next one. Lattice units.
#include <cstdint>

#include "parallel/sums_under_way.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/math/fixed_point.hpp"

namespace silt::coupler {

struct Case;
struct Scene;

/// Where a body is, counting the periods it has crossed.
rigid::Vec3 unwrapped(const rigid::BodySet&, std::size_t row, const rigid::Vec3& period);

/// Returns the kinetic energy of a free body and its potential energy in gravity, zero at the domain's
/// corner; a number out of all proportion is cut off, so that sums of them stay in range.
rigid::FixedSum mechanical_energy(const Case&, const rigid::BodySet&, std::size_t row);

class EnergyGuard {
 public:
  /// Steps between two looks: they cost a few per cent of a step without contacts. A scene that goes to
  /// pieces sooner is stopped by how far its bodies move.
  static constexpr std::int64_t interval = 50;
  /// Allowed gain: this share of the largest kinetic energy of the run so far, besides the energy that lifts
  /// every body by its bounding radius.
  static constexpr double share_of_motion = 0.1;

  /// Scenes with a fluid, with bodies of prescribed motion or with walls that move are not watched: there
  /// energy comes from outside.
  explicit EnergyGuard(const Case&);
  /// Starts a look at the state after a step; `brought`: the energy of the bodies that came less that of
  /// those that left, on this rank. The first one tells what there was at the start. Collective, but waits
  /// for nobody.
  void look(const Scene&, rigid::FixedSum brought, std::int64_t step);
  /// Throws CommonGuardStop if the look under way, if any, finds too much. Collective.
  void finish(const Case&);
  /// A program has done something to the bodies: the next look is the first of a new start.
  void start_anew() { fresh_ = true; }

 private:
  bool watched_;
  bool fresh_ = true, first_ = true;  // of the next look; of the one under way
  struct Sums {
    parallel::WideSum energy, kinetic, lift;  // lift: by each body's bounding radius
  };
  parallel::SumsUnderWay<Sums> sums_;
  std::int64_t step_ = 0, start_step_ = 0;
  double start_ = 0, largest_kinetic_ = 0;
};

}  // namespace silt::coupler
