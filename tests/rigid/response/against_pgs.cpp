// sffd against a sequential reference and against the contact law itself. In every step of a scene both solve
// the same contacts from the same velocities, sffd with as many sweeps as it takes: then their fixed points
// are to agree, in every velocity, and in the impulses where these are unique (spheres; a box on four corners
// shares its weight in many ways, and only the sums are).
#include <gtest/gtest.h>

#include <random>

#include "tests/rigid/response/pgs_resolver.hpp"
#include "tests/rigid/scene.hpp"

namespace silt::rigid {
namespace {

using testing::PgsResolver;
using testing::Scene;

using testing::g;

/// Resolves with sffd and, every so many steps, with pgs; keeps the largest differences.
class Both : public ContactResolver {
 public:
  Both(const ResolverSettings& settings, int every, bool unique_impulses, double converged)
      : sffd_(make_resolver("sffd", settings)),
        settled_(make_resolver("sffd", to_rest(settings))),
        every_(every),
        unique_impulses_(unique_impulses),
        converged_(converged) {}
  double velocity = 0, impulse = 0;  // differences, relative to the largest change of velocity or
  double law = 0;                    // impulse; how much sffd's own result breaks the contact law
  int steps = 0, lawful = 0, compared = 0, contacts = 0;  // steps looked at; where sffd converged; where both

  std::string_view name() const override { return "both"; }
  ResolverStatistics resolve(BodySet& bodies, const std::vector<Contact>& c, double dt, StepVelocities& s,
                             BodyExchange& exchange) override {
    const bool now = steps_++ % every_ == 0 && !c.empty();
    StepVelocities other = s;
    const StepVelocities kicked = s;
    if (now) pgs_.resolve(bodies, c, dt, other, exchange);
    const ResolverStatistics statistics = (now ? settled_ : sffd_)->resolve(bodies, c, dt, s, exchange);
    if (now) compare(bodies, c, kicked, s, other, statistics.residual);
    return statistics;
  }

 private:
  static ResolverSettings to_rest(ResolverSettings settings) {
    settings.max_sweeps = 3000;
    settings.sweep_tolerance = 1e-12;
    return settings;
  }

  void compare(const BodySet& bodies, const std::vector<Contact>& c, const StepVelocities& kicked,
               const StepVelocities& s, const StepVelocities& other, double residual) {
    ++steps;
    double scale = 1e-3 * g;  // a step's fall, where the contacts have less to do
    for (std::size_t row = 0; row < bodies.owned; ++row)
      scale = std::max({scale, (other.now[row].v - kicked.now[row].v).norm(),
                        (other.now[row].w - kicked.now[row].w).norm()});
    if (residual > converged_ * scale) return;
    ++lawful;
    contacts += static_cast<int>(c.size());
    const bool both = pgs_.residual <= converged_;
    compared += both;
    for (std::size_t row = 0; row < bodies.owned && both; ++row) {
      velocity = std::max({velocity, (s.now[row].v - other.now[row].v).norm() / scale,
                           (s.now[row].w - other.now[row].w).norm() / scale});
    }
    double largest = 0;
    for (const PgsResolver::Solved& k : pgs_.solved) largest = std::max(largest, k.impulse.norm());
    for (const PgsResolver::Solved& k : pgs_.solved) {
      const Vec3 p = impulse_of_sffd(bodies, k.contact);
      if (unique_impulses_ && both) impulse = std::max(impulse, (p - k.impulse).norm() / largest);
      check_law(bodies, k, p, s, scale, largest);
    }
  }

  static Vec3 impulse_of_sffd(const BodySet& bodies, const Contact& c) {
    for (const StoredImpulse& i : bodies.stored_impulses[bodies.row_of(c.a)])
      if (i.partner == c.b && i.feature == c.feature && i.image == c.image) return i.impulse;
    return Vec3::Zero();
  }

  /// 0 <= p_n, u_n >= target, one of both 0; |p_t| <= mu p_n; what slides is braked along its velocity.
  void check_law(const BodySet& bodies, const PgsResolver::Solved& k, const Vec3& p, const StepVelocities& s,
                 double speed, double largest) {
    const Contact& c = k.contact;
    const std::size_t a = bodies.row_of(c.a), b = bodies.row_of(c.b);
    const Vec3 r_b = is_wall(c.b) ? Vec3(Vec3::Zero()) : c.r_b;
    const Vec3 u = (s.now[b].v + s.now[b].w.cross(r_b) - s.now[a].v - s.now[a].w.cross(c.r_a)) / speed,
               q = p / largest;
    const double normal = c.normal.dot(q), excess = c.normal.dot(u) - k.target / speed;
    const Vec3 u_t = u - c.normal.dot(u) * c.normal, q_t = q - normal * c.normal;
    law = std::max({law, -normal, -excess, std::min(normal, excess), q_t.norm() - c.friction * normal});
    const double room = c.friction * normal - q_t.norm();  // inside the cone: sticks
    law = std::max(law, std::min(room, u_t.norm()));
    if (u_t.norm() > 1e-6 && q_t.norm() > 1e-6)
      law = std::max(law, (u_t.normalized() + q_t.normalized()).norm() * std::min(u_t.norm(), q_t.norm()));
  }

  std::unique_ptr<ContactResolver> sffd_, settled_;  // as the scene has it; with all the sweeps it takes
  PgsResolver pgs_;
  int every_, steps_ = 0;
  bool unique_impulses_;
  double converged_;  // change of a last sweep or pass, relative
};

/// The scene runs with its own few sweeps; every so many steps both solve it to the end.
Both run(Scene& s, int steps, int every, bool unique_impulses = false, double converged = 1e-10) {
  s.start();
  Both both(s.settings, every, unique_impulses, converged);
  s.step = std::make_unique<RigidStep>(s.world, *s.backend, both, *s.exchange);
  s.run(steps);
  return both;
}

Scene on_earth(double restitution, double friction) {
  Scene s(restitution, friction);
  s.world.gravity = {0, 0, -g};
  return s;
}

// A slowly converging step leaves an error some thousand times its last change: 1e-10 there, 1e-6 here.

TEST(AgainstPgs, BedOfSpheres) {
  Scene s = on_earth(0.3, 0.4);
  s.extent.size = {1, 1, 10};
  s.extent.periodic = {true, true, false};
  const int ball = s.shape(Sphere{0.125});
  std::mt19937 random(3);
  std::uniform_real_distribution<> u(-0.01, 0.01);
  for (int i = 0; i < 27; ++i)
    s.add(ball,
          {0.17 + 0.33 * (i % 3) + u(random), 0.17 + 0.33 * (i / 3 % 3) + u(random), 0.15 + 0.27 * (i / 9)});
  s.floor();
  const Both d = run(s, 600, 20, true);
  EXPECT_GT(d.contacts, 300);
  EXPECT_GT(d.compared, 20);
  EXPECT_LT(d.velocity, 1e-6);
  EXPECT_LT(d.impulse, 1e-6);
  EXPECT_LT(d.law, 1e-6);
}

TEST(AgainstPgs, StackOfBoxesKeepsTheLaw) {  // both converge slowly: corners share out the weight
  Scene s = on_earth(0.2, 0.5);
  const int box = s.shape(Box{{0.5, 0.5, 0.25}});
  for (int i = 0; i < 3; ++i) s.add(box, {10 + 0.03 * (i % 2), 10, 0.26 + 0.51 * i});
  s.floor();
  const Both d = run(s, 300, 10, false, 1e-5);
  EXPECT_GT(d.lawful, 5);
  EXPECT_LT(d.law, 1e-5);
}

TEST(AgainstPgs, WedgeOfBalls) {  // one falls between two, and spreads them against friction
  Scene s = on_earth(0, 0.2);
  const int ball = s.shape(Sphere{0.5});
  s.add(ball, {9.45, 10, 0.5});
  s.add(ball, {10.55, 10, 0.5});
  s.add(ball, {10, 10, 1.5}, {0, 0, -2}, Vec3::Zero(), 3);
  s.floor();
  const Both d = run(s, 400, 5);
  EXPECT_GT(d.compared, 30);
  EXPECT_LT(d.velocity, 1e-6);
  EXPECT_LT(d.law, 1e-6);
}

TEST(AgainstPgs, WedgeOfABallAndBoxesKeepsTheLaw) {  // more than one solution at the impact: see below
  Scene s = on_earth(0, 0.2);
  const int ball = s.shape(Sphere{0.5}), block = s.shape(Box{{0.5, 0.5, 0.3}});
  s.add(block, {9.35, 10, 0.3});
  s.add(block, {10.65, 10, 0.3});
  s.add(ball, {10, 10, 1.2}, {0, 0, -2}, Vec3::Zero(), 3);
  s.floor();
  const Both d = run(s, 400, 10);
  EXPECT_GT(d.lawful, 5);
  EXPECT_LT(d.law, 1e-6);
}

// Blocks thrown onto each other, full cones in changing directions. Here Coulomb's law has more than one
// solution (friction at the edge of a box turns it, which changes the normal impulses), and the reference
// often none that it finds: only the law is asked for.
TEST(AgainstPgs, SlidingOverOneAnotherKeepsTheLaw) {
  Scene s = on_earth(0.3, 0.3);
  const int box = s.shape(Box{{0.5, 0.5, 0.2}}), ball = s.shape(Sphere{0.3});
  s.add(box, {10, 10, 0.2}, {1, 0.3, 0});
  s.add(box, {10.2, 10.1, 0.6}, {-0.5, 1, 0}, {0, 0, 3});
  s.add(ball, {10.1, 10.1, 1.11}, {0.4, -1, 0}, {5, 1, 2});
  s.floor();
  const Both d = run(s, 300, 10);
  EXPECT_GE(d.lawful, 12);
  EXPECT_LT(d.law, 1e-6);
}

}  // namespace
}  // namespace silt::rigid
