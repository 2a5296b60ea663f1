#pragma once
// Impacts before the contacts of a step (method.md, C8): how one runs through bodies that touch, which
// the simultaneous law of sFFD does not give (Newton's cradle).
//
// Impacts run in rounds: of the pairs with e > 0 that approach now, those collide, all at once, whose e is
// the largest at either of their bodies; so colliding pairs that have a body in common have the same e. Their
// normal impulses are those of a plastic collision (the least kinetic energy without approach) times 1 + e;
// then friction brakes with these normal impulses given. New approaches are the next round's business. The
// plastic impulses come from sweeps as in sffd_resolver.hpp, masses split over the pairs of the round.
#include <cstdint>
#include <vector>

#include "rigid/math/types.hpp"
#include "rigid/response/contact_resolver.hpp"

namespace silt::rigid {

class ImpactPhase {
 public:
  /// most_sweeps: of the normal and of the tangential impulses of a round, and most rounds of a step.
  /// Impulses of a cluster that they cut short count as plastic. Pairs of a restitution below the least take
  /// no part.
  explicit ImpactPhase(int most_sweeps, double least_restitution = 0)
      : most_sweeps_(most_sweeps), least_restitution_(least_restitution) {}
  bool takes(const Contact& c) const { return c.restitution > 0 && c.restitution >= least_restitution_; }

  /// Changes velocities.before of every row, and velocities.now of owned rows by as much; sets rebounds and
  /// adds to other_impulses. contacts: as for a resolver. Returns how many sweeps this rank took part in.
  int operator()(BodySet&, const std::vector<Contact>& contacts, double dt, StepVelocities&, BodyExchange&);

 private:
  struct Body {
    std::size_t row;
    bool moves;  // owned and free
    double inverse_mass;
    Mat3 inverse_inertia;
    int pairs = 0;         // in this round
    bool pushed = false;   // by a pair, since it last took its impulses
    bool changed = false;  // a pair of it, in this sweep
    Twist start;           // of the round
    Vec3 impulse = Vec3::Zero(), angular_impulse = Vec3::Zero();
  };
  struct ImpactContact {
    std::size_t index;  // of the contact
    std::array<Vec3, 3> direction;
    Vec3 r_a, r_b;
    double gap, friction;
    bool approaching = false;
    double k_n = 0, k_t = 0;  // velocities a unit of impulse gives, with the masses split
    std::array<double, 3> impulse{};
    Vec3 given = Vec3::Zero();  // in all rounds so far
  };
  struct Pair {
    std::size_t first, last;  // its contacts
    std::size_t a, b;         // in bodies_
    double restitution;
    bool collides = false;  // in this round
    bool alone = false;     // no other pair of the round has one of its bodies: one sweep is exact
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
  bool is_to_solve(const Pair&, Stage, int sweep);
  bool sweep(Stage, int sweep);
  double solve(const Pair&, Stage);
  void take_impulses(const Pair&, const std::vector<std::array<double, 3>>& old);
  void apply();
  void spread_word(BodySet&, BodyExchange&);
  void rebound(BodySet&, BodyExchange&);
  void add_given();
  void note_impacts(const BodySet&, std::size_t contacts, StepVelocities&) const;
  bool rubs() const;

  int most_sweeps_;
  double least_restitution_;
  bool cut_short_ = false;  // the last sweeps, by their number
  std::vector<Body> bodies_;
  std::vector<Pair> pairs_;
  std::vector<ImpactContact> contacts_;
  std::vector<std::array<double, 3>> old_;  // impulses before a pair is solved
  std::vector<std::int32_t> index_;         // of a row of the BodySet in bodies_, -1: takes no part
  std::vector<double> state_;               // a row of the BodySet: v, w, and what else is shared
};

/// sffd after an impact phase: its contacts then no longer bounce, but leave each other as impacts have
/// parted them, whatever forces do in the step.
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
  std::vector<Contact> plastic_;  // the contacts, those of the impact phase without restitution
};

}  // namespace silt::rigid
