#pragma once
// The impact phase before the contacts of a step (method.md, C8): propagates impacts through touching bodies,
// which the simultaneous law of sFFD does not (Newton's cradle).
//
// Impacts run in rounds. Of the approaching pairs with e > 0, those collide, all at once, whose e is the
// largest of both bodies; hence colliding pairs with a common body have the same e. Their normal impulses are
// those of a plastic collision (least kinetic energy without approach) times 1 + e; then friction acts with
// given normal impulses. New approaches belong to the next round. The plastic impulses come from sweeps as in
// sffd_resolver.hpp, with masses split over the pairs of the round.
#include <cstdint>
#include <vector>

#include "rigid/math/types.hpp"
#include "rigid/response/contact_resolver.hpp"

namespace silt::rigid {

class ImpactPhase {
 public:
  /// most_sweeps: limit of the normal and of the tangential sweeps of a round, and of the rounds of a step.
  /// Unconverged clusters collide plastically. Pairs below the least restitution take no part.
  explicit ImpactPhase(int most_sweeps, double least_restitution = 0)
      : most_sweeps_(most_sweeps), least_restitution_(least_restitution) {}
  bool takes(const Contact& c) const { return c.restitution > 0 && c.restitution >= least_restitution_; }

  /// Changes velocities.before of every row, and velocities.now of owned rows by the same amount; sets
  /// rebounds and appends to other_impulses. contacts: as for a resolver. Returns this rank's sweeps.
  int operator()(BodySet&, const std::vector<Contact>& contacts, double dt, StepVelocities&, BodyExchange&);

 private:
  struct Body {
    std::size_t row;
    bool moves;  // owned and free
    double inverse_mass;
    Mat3 inverse_inertia;
    int pairs = 0;         // in this round
    bool pushed = false;   // by a pair, since impulses were last applied
    bool changed = false;  // by a pair in this sweep
    Twist start;           // velocities at the start of the round
    Vec3 impulse = Vec3::Zero(), angular_impulse = Vec3::Zero();
  };
  struct ImpactContact {
    std::size_t index;  // of the contact
    std::array<Vec3, 3> direction;
    Vec3 r_a, r_b;
    double gap, friction;
    bool approaching = false;
    double k_n = 0, k_t = 0;  // velocity per unit impulse, with split masses
    std::array<double, 3> impulse{};
    Vec3 given = Vec3::Zero();  // impulse of all rounds so far
  };
  struct Pair {
    std::size_t first, last;  // contacts
    std::size_t a, b;         // indices in bodies_
    double restitution;
    bool collides = false;  // in this round
    bool alone = false;     // the only pair of both bodies in the round: one sweep is exact
  };
  enum class Stage { normal, tangential };

  void collect(const BodySet&, const std::vector<Contact>&);
  std::size_t involve(const BodySet&, std::size_t row);
  bool mark_approaching(double dt);
  double& shared(const Body&, int which);
  void choose_pairs(BodySet&, BodyExchange&);
  void begin_round(BodySet&, BodyExchange&);
  void split_masses(Pair&);
  int sweep_to_rest(BodySet&, BodyExchange&, Stage);
  bool needs_solution(const Pair&, Stage, int sweep);
  bool sweep(Stage, int sweep);
  double solve(const Pair&, Stage);
  void apply_change(const Pair&, const std::vector<std::array<double, 3>>& old);
  void apply();
  void spread_word(BodySet&, BodyExchange&);
  void rebound(BodySet&, BodyExchange&);
  void add_round();
  void store_impacts(const BodySet&, std::size_t contacts, StepVelocities&) const;
  bool has_friction() const;

  int most_sweeps_;
  double least_restitution_;
  bool cut_short_ = false;  // whether the last sweeps reached their limit
  std::vector<Body> bodies_;
  std::vector<Pair> pairs_;
  std::vector<ImpactContact> contacts_;
  std::vector<std::array<double, 3>> old_;  // impulses before a pair is solved
  std::vector<std::int32_t> index_;         // row of the BodySet to index in bodies_; -1: takes no part
  std::vector<double> state_;               // for each row: v, w, and the other shared values
};

/// sffd after an impact phase: contacts do not bounce again, but separate at least as fast as after the
/// impacts, whatever forces act in the step.
class ImpactThenContact : public ContactResolver {
 public:
  ImpactThenContact(const ImpactPhase& impact, std::unique_ptr<ContactResolver> contact)
      : impact_(impact), contact_(std::move(contact)) {}
  std::string_view name() const override { return contact_->name(); }
  double first_kick() const override { return contact_->first_kick(); }
  ResolverStatistics resolve(BodySet&, const std::vector<Contact>&, double dt, StepVelocities&,
                             BodyExchange&) override;

 private:
  ImpactPhase impact_;
  std::unique_ptr<ContactResolver> contact_;
  std::vector<Contact> plastic_;  // the contacts, with zero restitution for those of the impact phase
};

}  // namespace silt::rigid
