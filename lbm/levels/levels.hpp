#pragma once
// Coarser levels around the finest cells: each level is a fluid with cells twice as wide and steps twice as
// long as the next finer one. Also holds the borders between them.
#include <memory>
#include <vector>

#include "lbm/fluid.hpp"
#include "lbm/heat/temperature.hpp"
#include "lbm/levels/level_border.hpp"

namespace silt::lbm {

/// Returns the spec of the fluid `levels` levels coarser: velocities and pressures keep their values.
CollisionSpec coarser(CollisionSpec, int levels);
HeatSpec coarser(HeatSpec, int levels);

template <class T>
class Levels {
 public:
  /// Takes the finest fluid, whose tree of cuts has leaves of this number of coarser levels. All fluids start
  /// at rest. `heat`: the temperature that the finest fluid carries; those of coarser fluids are made here,
  /// with its sides. Refers to both. Fluids take arrays of `before`, if given (Fluid).
  Levels(Fluid<T>& finest, int coarser_levels, Temperature<T>* heat = nullptr,
         const Levels* before = nullptr);

  int count() const { return int(coarser_.size()) + 1; }
  Fluid<T>& fluid(int level) { return level == 0 ? finest_ : *coarser_[level - 1]; }
  const Fluid<T>& fluid(int level) const { return level == 0 ? finest_ : *coarser_[level - 1]; }

  /// Returns the temperature of a level; null: none.
  Temperature<T>* heat(int level) {
    return level == 0 ? heat_ : heat_ ? coarser_heat_[level - 1].get() : nullptr;
  }
  const Temperature<T>* heat(int level) const { return const_cast<Levels*>(this)->heat(level); }

  /// Sets the number of passes done, in finest steps.
  void set_passes(std::int64_t done);

  /// Call before the pass of the finest fluid. Collides each level whose step begins now, coarser levels
  /// first, so that a level's packets are ready for the two steps that the next finer level takes meanwhile.
  void begin_step();
  /// Call after a part of a block of the finest fluid has collided, if it collides by parts.
  void after_part(int block, int part) {
    if (!borders_.empty()) at_border(0, [&](auto& border) { border.after_part(block, part); });
  }
  /// Does the pass of the finest fluid, for callers with no other work in it.
  void stream_collide() { pass_over(0); }
  /// Returns the wall time in seconds that passes of each level have taken on this rank.
  const std::vector<double>& seconds() const { return seconds_; }
  void set_seconds(std::vector<double> seconds) { seconds_ = std::move(seconds); }
  /// Call after the exchange of the finest fluid.
  void end_step() { end_pass(0); }

 private:
  bool is_coarsest(int level) const { return level == count() - 1; }
  /// Calls act(border) for the border between a level and the next, of the fluid and of the temperature.
  template <class Act>
  void at_border(int level, Act&& act) {
    act(borders_[level]);
    if (heat_) act(heat_borders_[level]);
  }
  void begin_pass(int level);
  void pass_over(int level);
  void end_pass(int level);

  Fluid<T>& finest_;
  std::vector<std::unique_ptr<Fluid<T>>> coarser_;
  std::vector<LevelBorder<Fluid<T>>> borders_;  // between a level and the next
  Temperature<T>* heat_;
  std::vector<std::unique_ptr<Temperature<T>>> coarser_heat_;
  std::vector<LevelBorder<Temperature<T>>> heat_borders_;
  std::vector<double> seconds_;
};

/// Copies the state of `from` to `to`, which have two cuts of one domain; a cell may change its level by one.
/// Collective, between steps of the coarsest level.
template <class T>
void move_populations(const Levels<T>& from, Levels<T>& to);

}  // namespace silt::lbm
