// sffd against the contact law of method.md, (C1) to (C3) and (C7), in steps that it solves with as many
// sweeps as it takes: no impulse and no velocity breaks the law, and the velocities are those that the
// impulses give.
#include <gtest/gtest.h>

#include <random>

#include "tests/rigid/scene.hpp"

namespace silt::rigid {
namespace {

using testing::Scene;

using testing::g;

/// Resolves with sffd, every so many steps to the end; keeps the largest faults of what it finds there.
class Judged : public ContactResolver {
 public:
  Judged(const ResolverSettings& settings, int every, double converged)
      : sffd_(make_resolver("sffd", settings)),
        settled_(make_resolver("sffd", to_rest(settings))),
        every_(every),
        converged_(converged) {}
  double law = 0;                // by how much a contact breaks the law
  double balance = 0;            // difference of a velocity from what the impulses make of it; both relative
  int lawful = 0, contacts = 0;  // steps in which it converged, and their contacts

  std::string_view name() const override { return "judged"; }
  ResolverStatistics resolve(BodySet& bodies, const std::vector<Contact>& c, double dt, StepVelocities& s,
                             BodyExchange& exchange) override {
    if (steps_++ % every_ != 0 || c.empty()) return sffd_->resolve(bodies, c, dt, s, exchange);
    std::vector<double> targets;
    for (const Contact& contact : c) targets.push_back(target_of(bodies, contact, dt, s.before));
    const std::vector<Twist> kicked = s.now;
    const ResolverStatistics statistics = settled_->resolve(bodies, c, dt, s, exchange);
    double speed = 1e-3 * g;  // a step's fall, where the contacts have less to do
    for (std::size_t row = 0; row < bodies.owned; ++row)
      speed = std::max(speed, distance(s.now[row], kicked[row]));
    if (statistics.residual > converged_ * speed) return statistics;
    ++lawful, contacts += static_cast<int>(c.size());
    judge(bodies, c, targets, kicked, s.now, speed);
    return statistics;
  }

 private:
  static ResolverSettings to_rest(ResolverSettings settings) {
    settings.max_sweeps = 3000;
    settings.sweep_tolerance = 1e-12;
    return settings;
  }
  static double distance(const Twist& a, const Twist& b) {
    return std::max((a.v - b.v).norm(), (a.w - b.w).norm());
  }
  static Vec3 arm_of_b(const Contact& c) { return is_wall(c.b) ? Vec3(Vec3::Zero()) : c.r_b; }
  static Vec3 relative(const BodySet& bodies, const Contact& c, const std::vector<Twist>& of) {
    const Twist &a = of[bodies.row_of(c.a)], &b = of[bodies.row_of(c.b)];
    return b.v + b.w.cross(arm_of_b(c)) - a.v - a.w.cross(c.r_a);
  }
  static Vec3 impulse_of(const BodySet& bodies, const Contact& c) {
    for (const StoredImpulse& i : bodies.stored_impulses[bodies.row_of(c.a)])
      if (i.partner == c.b && i.feature == c.feature && i.image == c.image) return i.impulse;
    return Vec3::Zero();
  }

  /// The least normal velocity after the step. A contact that pressed in the last step closes, but for a gap
  /// of 1e-4 of the lever arms: what sffd remembers for its warm start is part of its contact law.
  static double target_of(const BodySet& bodies, const Contact& c, double dt,
                          const std::vector<Twist>& before) {
    const double approach = c.normal.dot(relative(bodies, c, before));
    const bool overlaps = c.gap <= 0, reached = c.gap + dt * approach < 0;
    double target = std::min(0.0, -c.gap / dt);
    if (approach < 0 && (overlaps || reached)) target = std::max(target, -c.restitution * approach);
    const double arms = c.r_a.norm() + arm_of_b(c).norm();
    if (c.normal.dot(impulse_of(bodies, c)) > 0)
      target = std::max(target, -std::max(0.0, c.gap - 1e-4 * arms) / dt);
    return target;
  }

  void judge(const BodySet& bodies, const std::vector<Contact>& c, const std::vector<double>& targets,
             std::vector<Twist> expected, const std::vector<Twist>& now, double speed) {
    double largest = 0;
    for (const Contact& contact : c) largest = std::max(largest, impulse_of(bodies, contact).norm());
    for (std::size_t k = 0; k < c.size(); ++k) {
      const Vec3 p = impulse_of(bodies, c[k]);
      check_law(c[k], targets[k] / speed, p / largest, relative(bodies, c[k], now) / speed);
      const std::size_t a = bodies.row_of(c[k].a), b = bodies.row_of(c[k].b);
      expected[a].v -= bodies.inverse_mass(a) * p, expected[b].v += bodies.inverse_mass(b) * p;
      expected[a].w -= bodies.inverse_inertia_W(a) * c[k].r_a.cross(p);
      expected[b].w += bodies.inverse_inertia_W(b) * arm_of_b(c[k]).cross(p);
    }
    for (std::size_t row = 0; row < bodies.owned; ++row)
      balance = std::max(balance, distance(now[row], expected[row]) / speed);
  }

  /// 0 <= p_n, u_n >= target, one of both 0; |p_t| <= mu p_n; what slides is braked along its velocity.
  void check_law(const Contact& c, double target, const Vec3& p, const Vec3& u) {
    const double normal = c.normal.dot(p), excess = c.normal.dot(u) - target;
    const Vec3 u_t = u - c.normal.dot(u) * c.normal, p_t = p - normal * c.normal;
    law = std::max({law, -normal, -excess, std::min(normal, excess), p_t.norm() - c.friction * normal});
    const double room = c.friction * normal - p_t.norm();  // inside the cone: sticks
    law = std::max(law, std::min(room, u_t.norm()));
    if (u_t.norm() > 1e-6 && p_t.norm() > 1e-6)
      law = std::max(law, (u_t.normalized() + p_t.normalized()).norm() * std::min(u_t.norm(), p_t.norm()));
  }

  std::unique_ptr<ContactResolver> sffd_, settled_;  // as the scene has it; with all the sweeps it takes
  int every_, steps_ = 0;
  double converged_;  // change of a last sweep, relative
};

/// The scene runs with its own few sweeps; every so many steps they go on to the end.
void expect_lawful(Scene& s, int steps, int every, int least_lawful, double converged = 1e-10) {
  s.start();
  Judged judged(s.settings, every, converged);
  s.step = std::make_unique<RigidStep>(s.world, *s.backend, judged, *s.exchange);
  s.run(steps);
  EXPECT_GT(judged.lawful, least_lawful);
  EXPECT_GT(judged.contacts, judged.lawful);
  // a slowly converging step leaves an error some thousand times its last change
  EXPECT_LT(judged.law, std::max(1e-6, converged));
  EXPECT_LT(judged.balance, 1e-11);
}

Scene on_earth(double restitution, double friction) {
  Scene s(restitution, friction);
  s.world.gravity = {0, 0, -g};
  return s;
}

TEST(ContactLaw, BedOfSpheres) {
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
  expect_lawful(s, 600, 20, 20);
}

TEST(ContactLaw, StackOfBoxes) {  // slowly found: corners share out the weight
  Scene s = on_earth(0.2, 0.5);
  const int box = s.shape(Box{{0.5, 0.5, 0.25}});
  for (int i = 0; i < 3; ++i) s.add(box, {10 + 0.03 * (i % 2), 10, 0.26 + 0.51 * i});
  s.floor();
  expect_lawful(s, 300, 10, 5, 1e-5);
}

TEST(ContactLaw, WedgeOfBalls) {  // one falls between two, and spreads them against friction
  Scene s = on_earth(0, 0.2);
  const int ball = s.shape(Sphere{0.5});
  s.add(ball, {9.45, 10, 0.5});
  s.add(ball, {10.55, 10, 0.5});
  s.add(ball, {10, 10, 1.5}, {0, 0, -2}, Vec3::Zero(), 3);
  s.floor();
  expect_lawful(s, 400, 5, 30);
}

TEST(ContactLaw, WedgeOfABallAndBoxes) {
  Scene s = on_earth(0, 0.2);
  const int ball = s.shape(Sphere{0.5}), block = s.shape(Box{{0.5, 0.5, 0.3}});
  s.add(block, {9.35, 10, 0.3});
  s.add(block, {10.65, 10, 0.3});
  s.add(ball, {10, 10, 1.2}, {0, 0, -2}, Vec3::Zero(), 3);
  s.floor();
  expect_lawful(s, 400, 10, 5);
}

// Blocks thrown onto each other, full cones in changing directions.
TEST(ContactLaw, SlidingOverOneAnother) {
  Scene s = on_earth(0.3, 0.3);
  const int box = s.shape(Box{{0.5, 0.5, 0.2}}), ball = s.shape(Sphere{0.3});
  s.add(box, {10, 10, 0.2}, {1, 0.3, 0});
  s.add(box, {10.2, 10.1, 0.6}, {-0.5, 1, 0}, {0, 0, 3});
  s.add(ball, {10.1, 10.1, 1.11}, {0.4, -1, 0}, {5, 1, 2});
  s.floor();
  expect_lawful(s, 300, 10, 11);
}

}  // namespace
}  // namespace silt::rigid
