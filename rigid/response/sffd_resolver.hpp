#pragma once
// sFFD: the default contact resolver. Keeps the structure of Kaufman's Fast Frictional Dynamics and of its
// parallel form (SC10 section III), one exchange of neighbours a sweep, but solves pairs symmetrically, so
// that momentum is exact and the law is Coulomb's. Own derivation: rigid/README.md, equations
// (C1) to (C7).
//
// In a sweep every pair is solved alone, from the same velocities, with the masses of its bodies divided by
// their numbers of pairs; then each body takes the sum of its impulse changes with its true mass (Jacobi with
// mass splitting: it descends for any number of pairs). A pair is solved wherever one of its free bodies is
// owned, redundantly and bitwise equally; each owner moves its own bodies. Nothing depends on rows, only on
// keys. Between two sweeps a pair's impulses are carried on along their last change (Nesterov's
// acceleration).
#include "rigid/response/contact_resolver.hpp"
#include "rigid/response/pair_lanes.hpp"

namespace silt::rigid {

class SffdResolver : public ContactResolver {
 public:
  explicit SffdResolver(const ResolverSettings& settings) : settings_(settings) {}
  std::string_view name() const override { return "sffd"; }
  ResolverStatistics resolve(BodySet&, const std::vector<Contact>&, double dt, StepVelocities&,
                             BodyExchange&) override;

 private:
  struct Body : BodyMass {           // one a row
    bool moves = false;              // owned and free: this rank applies its impulses
    bool asks_for_impulses = false;  // owned, and moves or is held at rest
    bool involved = false;           // in a contact of this step; else all here is unset
    double pairs = 0;                // that are solved here
    double size = 0;                 // radius of gyration
  };
  struct Pair {
    std::size_t first, last;  // its contacts
    std::size_t row_a, row_b;
    double reduced_mass = 0;
    bool link = false;  // of a chain
    PairLanes::Place place{};
  };
  /// How sweeps go on.
  struct Sweeps {
    int most, accelerated;
    double tolerance;
    bool push = false;  // position correction
  };

  std::size_t collect_pairs(BodySet&, const std::vector<Contact>&);
  void involve(const BodySet&, std::size_t row);
  void start(const BodySet&, const std::vector<Contact>&, double dt, const StepVelocities&);
  void warm_start(const Pair&, std::span<const Contact> of_pair, double dt, Recall&);
  void take_sum(BodyState&, std::size_t row, double number) const;
  void share_pair_numbers(BodySet&, BodyExchange&);
  void lay_out(const std::vector<Contact>&, double dt, bool links_only = false);
  bool is_link(const Pair&, std::span<const Contact> of_pair) const;
  std::span<ContactImpulse> impulses_of(const Pair&);
  int settle_links(BodySet&, const std::vector<Contact>&, double dt, BodyExchange&);
  Vec3 report_impact(BodySet&, const Pair&, std::size_t contact, const Vec3& normal) const;
  bool is_mostly_impact(const Pair&, std::size_t contact) const;
  void note_other_wall_impulse(const Pair&, std::span<const Contact> of_pair, const Vec3& by_sink,
                               StepVelocities&) const;
  double least_scale(const Pair&) const;
  double largest_change(const BodySet&) const;
  int sweep_to_rest(BodySet&, BodyExchange&, std::vector<BodyState>& state, const Sweeps&, double& residual);
  void aim_push(const std::vector<Contact>&, double dt);
  bool is_correctable(const Contact&) const;
  bool is_to_correct(const std::vector<Contact>&, const BodyExchange&) const;
  void finish(BodySet&, const std::vector<Contact>&, StepVelocities&, ResolverStatistics&);
  void correct_positions(BodySet&, const std::vector<Contact>&, double dt, StepVelocities&, BodyExchange&);

  ResolverSettings settings_;
  // one a row of the BodySet, and one more at rest
  std::vector<Body> bodies_;
  std::vector<BodyState> state_, push_;  // velocities, pseudo velocities
  std::vector<BodySum> sums_;            // of the sweep at hand
  std::vector<std::size_t> involved_;    // rows that take part
  std::vector<Pair> pairs_;
  PairLanes lanes_;
  // one a contact
  std::vector<ContactImpulse> impulses_;
  std::vector<double> targets_;
  std::vector<double> impact_changes_;  // change of the normal velocity by an impact; 0: none
};

}  // namespace silt::rigid
