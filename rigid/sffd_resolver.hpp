#pragma once
// sFFD: the default contact resolver. Keeps the structure of Kaufman's Fast Frictional Dynamics and of its
// parallel form (SC10 section III), one exchange of neighbours a sweep, but solves pairs symmetrically, so
// that momentum is exact and the law is Coulomb's. Own derivation; the laws and figures are in the design
// notes (FFD.md section 5).
//
// In a sweep every pair is solved alone, from the same velocities, with the masses of its bodies divided by
// their numbers of pairs; then each body takes the sum of its impulse changes with its true mass (Jacobi with
// mass splitting: it descends for any number of pairs). A pair is solved wherever one of its free bodies is
// owned, redundantly and bitwise equally; each owner moves its own bodies. Nothing depends on rows, only on
// keys.
#include "rigid/contact_pair.hpp"
#include "rigid/contact_resolver.hpp"

namespace silt::rigid {

class SffdResolver : public ContactResolver {
 public:
  explicit SffdResolver(const ResolverSettings& settings) : settings_(settings) {}
  std::string_view name() const override { return "sffd"; }
  ResolverStatistics resolve(BodySet&, const std::vector<Contact>&, double dt, StepVelocities&,
                             BodyExchange&) override;

 private:
  struct Body {  // that takes part in a contact
    std::size_t row;
    bool moves;  // owned and free: this rank applies its impulses
    double inverse_mass;
    Mat3 inverse_inertia;
    double pairs = 0;
    Vec3 impulse = Vec3::Zero(), angular_impulse = Vec3::Zero();  // of the sweep at hand
    bool changed = false;
  };
  struct Pair {
    std::size_t first, last;  // its contacts
    std::size_t a, b;         // in bodies_
    std::size_t matrix = 0;   // where it starts in matrices_
    bool single = false, final_after_one = false;
    double reduced_mass = 0, least_scale = 0;  // impulses below least_scale are rounding
  };

  void collect_pairs(const BodySet&, const std::vector<Contact>&);
  std::size_t involve(const BodySet&, std::size_t row);
  void start(const BodySet&, const std::vector<Contact>&, double dt, const StepVelocities&);
  void warm_start(const BodySet&, const std::vector<Contact>&);
  void split_masses(const BodySet&);
  void set_least_scales(const BodySet&, double dt, bool push);
  int sweep_to_rest(BodySet&, BodyExchange&, std::vector<double>& state, double tolerance, bool push,
                    double& residual);
  double sweep(std::vector<double>& state, double tolerance, bool first, bool push);
  void apply_impulses(std::vector<double>& state);
  double correctable_overlap(const std::vector<Contact>&) const;
  void set_push_targets(const std::vector<Contact>&, double dt);
  void remember(BodySet&, const std::vector<Contact>&) const;
  void count(const BodySet&, const std::vector<Contact>&, ResolverStatistics&) const;
  void correct_positions(BodySet&, const std::vector<Contact>&, double dt, StepVelocities&, BodyExchange&);

  ResolverSettings settings_;
  std::vector<Body> bodies_;
  std::vector<Pair> pairs_;
  std::vector<ContactRow> rows_;     // one a contact
  std::vector<double> matrices_;     // of the pairs, one after the other
  std::vector<std::int32_t> index_;  // of a row in bodies_, -1: takes no part
  // what the sweeps read and write, a row of the BodySet: v, w, and a number that travels with them (before
  // the first sweep the body's number of pairs, then whether it changed)
  std::vector<double> state_, push_;
};

}  // namespace silt::rigid
