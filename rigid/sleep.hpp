#pragma once
// Bodies at rest are held: contacts of two of them are neither looked for nor solved, and cost nothing but a
// look at the balance of forces (method.md, S1 to S3).
#include <cstdint>
#include <vector>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/response/contact_resolver.hpp"

namespace silt::rigid {

class Sleep {
 public:
  explicit Sleep(const World& world) : world_(world) {}
  /// Wakes, before contacts are solved, bodies at rest that something comes upon: they take part (S3), here
  /// and as partners on other ranks.
  void wake_what_is_hit(BodySet&, const std::vector<Contact>&, double dt, BodyExchange&);
  /// Finds, after a step, forces still being there, the bodies that wake by them (S2) and those that fall
  /// asleep (S1).
  void look(BodySet&, const std::vector<Contact>&, const StepVelocities&, double dt);

 private:
  bool comes_upon(const BodySet&, const Contact&, double dt) const;
  void find_driven(const BodySet&, const std::vector<Contact>&);
  bool is_quiet(const BodySet&, std::size_t row, const StepVelocities&) const;
  bool is_balanced(BodySet&, std::size_t row, const StepVelocities&, double dt) const;
  double surface_speed(const BodySet&, std::size_t row, const Twist&) const;

  const World& world_;
  std::vector<double> wakefulness_;   // by row
  std::vector<std::uint8_t> driven_;  // by row: touched by what moves by itself
};

}  // namespace silt::rigid
