#pragma once
// sFFD, the default contact resolver. It has the structure of Kaufman's Fast Frictional Dynamics and of its
// parallel form (SC10 section III), one exchange with neighbours per sweep, but solves pairs symmetrically,
// so that momentum is exact and friction is Coulomb's. Own derivation: method.md, equations (C1) to (C7).
//
// A pair is solved on every rank that owns one of its free bodies, bitwise the same; each rank moves its own
// bodies. Results depend on keys, not on rows.
#include "rigid/response/contact_resolver.hpp"
#include "rigid/response/contact_targets.hpp"
#include "rigid/response/pair_lanes.hpp"

namespace silt::rigid {

class SffdResolver : public ContactResolver {
 public:
  explicit SffdResolver(const ResolverSettings& settings) : settings_(settings) {}
  std::string_view name() const override { return "sffd"; }
  ResolverStatistics resolve(BodySet&, const std::vector<Contact>&, double dt, StepVelocities&,
                             BodyExchange&) override;

 private:
  struct Body : BodyMass {  // one per row
    bool moves = false;     // owned and free: this rank applies its impulses
    bool involved = false;  // in a contact of this step; otherwise the other members are not set
    double pairs = 0;       // number of its pairs on this rank
    double size = 0;        // radius of gyration
  };
  struct Pair {
    std::span<const Contact> contacts;
    std::size_t first;  // index of its first contact
    std::size_t row_a, row_b;
    double reduced_mass = 0;
    bool link = false;                   // part of a chain
    const Material* material = nullptr;  // null: no rolling resistance and no pull
    Vec3 together = Vec3::Zero();        // see PairToSolve
    PairLanes::Place place{};
    PairLanes::Rolling rolling{};  // what it had before chains were swept alone
  };
  struct Sweeps {
    int most, accelerated;
    double tolerance;
    bool push = false;  // position correction
  };
  struct Rest {
    int sweeps = 0;  // number of the last sweep that solved a pair here
    double residual = 0;
  };
  struct Step {
    BodySet& bodies;
    std::span<const Contact> contacts;
    double dt;
    StepVelocities& velocities;
    BodyExchange& exchange;
  };

  std::size_t collect_pairs(const BodySet&, const std::vector<Contact>&);
  void involve(const BodySet&, std::size_t row);
  void start(const Step&);
  void warm_start(Pair&, const Step&, WarmStart&);
  static CohesivePair cohesive(const Pair&, const Step&);
  /// Returns null if no material has more than restitution and friction.
  const Material* material_of(const BodySet& bodies, const Pair& p) const {
    if (settings_.materials.empty()) return nullptr;
    return &settings_
                .materials[bodies.material[p.row_a] * settings_.material_count + bodies.material[p.row_b]];
  }
  void lay_out(double dt, bool links_only = false);
  double least_scale(const Pair&) const;
  std::span<ContactImpulse> impulses_of(const Pair& p) {
    return {impulses_.data() + p.first, p.contacts.size()};
  }
  std::span<const double> targets_of(const Pair& p) const {
    return {targets_.data() + p.first, p.contacts.size()};
  }
  void share_pair_numbers(const Step&);
  bool is_link(const Pair&) const;
  int settle_links(const Step&);
  Rest sweep_to_rest(const Step&, std::vector<BodyState>& state, const Sweeps&);
  /// Returns the change of a body's velocities by the last sweep.
  [[gnu::always_inline]] Twist change_of(std::size_t row) const {
    const Body& b = bodies_[row];
    return {b.inverse_mass * Eigen::Map<const Vec3>(sums_[row].impulse),
            b.inverse_inertia * Eigen::Map<const Vec3>(sums_[row].angular)};
  }
  /// Removes the sums along locked axes, which the contacts' impulses on these bodies include.
  void clear_locked_axes(std::vector<ContactSum>* all) {
    for (std::size_t k = 0; k < locked_.size(); ++k) {
      Eigen::Map<Vec3> sum{sums_[locked_[k]].impulse};
      if (all) (*all)[k].impulse += sum, (*all)[k].moment += Eigen::Map<Vec3>{sums_[locked_[k]].angular};
      sum = without_locked(bodies_[locked_[k]].locked, sum);
    }
  }
  void apply_sum(BodyState&, std::size_t row, double number) const;
  double largest_change() const;
  void finish(const Step&, ResolverStatistics&);
  void finish_pair(const Pair&, const Step&, ResolverStatistics&);
  Vec3 report_impact(BodySet&, const Pair&, std::size_t k) const;
  bool is_mostly_impact(const Pair&, std::size_t k) const;
  void add_other_impulses(const Pair&, const Vec3& by_sink, StepVelocities&) const;
  bool needs_correction(const Step&) const;
  void correct_positions(const Step&);

  ResolverSettings settings_;
  // one per row of the BodySet, and one more at rest
  std::vector<Body> bodies_;
  std::vector<BodyState> state_, push_;  // velocities, pseudo velocities
  std::vector<BodySum> sums_;            // of the current sweep
  std::vector<std::size_t> involved_;    // rows in contact
  std::vector<std::size_t> locked_;      // those with locked axes
  std::vector<Pair> pairs_;
  PairLanes lanes_;
  // one per contact
  std::vector<ContactImpulse> impulses_;
  std::vector<double> targets_;
  std::vector<double> impact_changes_;  // change of the normal velocity by an impact; 0: none
};

}  // namespace silt::rigid
