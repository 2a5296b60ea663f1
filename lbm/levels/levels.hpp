#pragma once
// Coarser cells around the finest: a fluid each level, whose cells are twice as wide and whose steps take
// twice as long as those of the next finer one, and the borders between them.
#include <memory>
#include <vector>

#include "lbm/fluid.hpp"
#include "lbm/levels/level_border.hpp"

namespace silt::lbm {

/// Returns the fluid on a lattice so many levels coarser: velocities and pressures keep their numbers.
CollisionSpec coarser(CollisionSpec, int levels);

template <class T>
class Levels {
 public:
  /// The tree of cuts of the finest fluid has leaves of so many coarser levels; all begin at rest. Refers to
  /// it.
  Levels(Fluid<T>& finest, int coarser_levels);

  int count() const { return int(coarser_.size()) + 1; }
  Fluid<T>& fluid(int level) { return level == 0 ? finest_ : *coarser_[level - 1]; }
  const Fluid<T>& fluid(int level) const { return level == 0 ? finest_ : *coarser_[level - 1]; }

  /// Counts in finest steps.
  void set_passes(std::int64_t done);

  /// Call before the pass of the finest fluid. A level whose step begins now collides, coarser levels first:
  /// what it sends the next finer one is then there for the two steps that this one takes meanwhile.
  void begin_step();
  /// Call when a part of a block of the finest fluid has collided, if you collide it by parts.
  void after_part(int block, int part) {
    if (!borders_.empty()) borders_[0].after_part(block, part);
  }
  /// The pass of the finest fluid, for who does nothing in between.
  void stream_collide() { pass_over(0); }
  /// Returns the seconds that passes of the coarser levels have taken on this rank, by level.
  const std::vector<double>& seconds() const { return seconds_; }
  void set_seconds(std::vector<double> seconds) { seconds_ = std::move(seconds); }
  /// Call after the exchange of the finest fluid.
  void end_step() { end_pass(0); }

 private:
  bool is_coarsest(int level) const { return level == count() - 1; }
  void begin_pass(int level);
  void pass_over(int level);
  void end_pass(int level);

  Fluid<T>& finest_;
  std::vector<std::unique_ptr<Fluid<T>>> coarser_;
  std::vector<LevelBorder<Fluid<T>>> borders_;  // between a level and the next
  std::vector<double> seconds_;
};

/// Collective, between steps of the coarsest: gives the cells of `to` what those of `from` hold, two cuts of
/// one domain. Cells may be of another level there, by one.
template <class T>
void move_populations(const Levels<T>& from, Levels<T>& to);

}  // namespace silt::lbm
