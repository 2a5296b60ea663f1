// A ball that hits another body with friction, against the law of rigid impact with Coulomb's friction (O. R.
// Walton, in: Particulate Two-Phase Flow, 1993): whatever the step was when the surfaces met.
#include "rigid/math/types.hpp"
#include "tests/adapters/mesh_scenes.hpp"
#include "tests/hull_of.hpp"
#include "tests/rigid/with_backend.hpp"

namespace silt::rigid::testing {
namespace {

class Rebound : public WithBackend {};

constexpr double radius = 0.4;

struct Impact {
  double restitution, friction;
  Twist ball;
};
const std::vector<Impact> slanted = {{0.5, 0.35, {{1, 0, -2}, {0, 0, 0}}},
                                     {0.9, 0.1, {{2, -0.5, -2}, {3, 10, -4}}},
                                     {0, 0.3, {{1, 0.7, -2}, {0, -10, 0}}},
                                     {1, 0.2, {{0.2, 0, -3}, {-5, 20, 0}}}};

/// A ball of mass 1 after an impact against a surface of infinite mass with the velocity `surface`; n points
/// into it.
Twist after(const Impact& impact, const Vec3& n, const Vec3& surface) {
  const auto& [v, w] = impact.ball;
  const Vec3 u = surface - v - w.cross(radius * n);
  const double press = -(1 + impact.restitution) * u.dot(n);
  Vec3 rub = -2.0 / 7 * (u - u.dot(n) * n);
  rub *= std::min(1.0, impact.friction * press / std::max(rub.norm(), 1e-300));
  const Vec3 p = -(press * n + rub);  // on the ball
  return {v + p, w + radius * n.cross(p) / (0.4 * radius * radius)};
}

void expect_twist(const Scene& s, BodyId id, const Twist& expected, double tolerance, const char* of) {
  EXPECT_LT((s.v(id) - expected.v).norm(), tolerance) << of;
  EXPECT_LT(radius * (s.w(id) - expected.w).norm(), tolerance) << of;
}

/// A partner is what a ball may fall on: its surface is at {50, 50, 0} and faces up there.
struct Partner {
  const char* name;
  Shape shape;
  Vec3 centre;
  Quat turn = Quat::Identity();
};

std::vector<Partner> flat_partners() {
  const Vec3 half(3, 2.5, 0.5);
  const TriangleMesh cuboid = cuboid_mesh(-half, half);
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(half.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  const auto mesh = [](TriangleMesh m) { return Mesh{std::make_shared<const TriangleMesh>(std::move(m))}; };
  const Part blocks[] = {{Box{{2, 2.5, 0.5}}, {{1.0625, 0, 0}, Quat::Identity()}},
                         {Sphere{0.5}, {{-3, 0, -1}, Quat::Identity()}}};
  return {
      {"box", Box{half}, {50.5, 49.5, -0.5}},
      {"box on its side", Box{{0.5, 3, 2}}, {50.5, 49.5, -0.5}, Quat(std::sqrt(0.5), 0, std::sqrt(0.5), 0)},
      {"end of a cylinder", Cylinder{3, 0.5}, {50.5, 49.5, -0.5}},
      {"polyhedron", tests::hull_of(corners), {50.5, 49.5, -0.5}},
      {"mesh", mesh(cuboid), {50.5, 49.5, -0.5}},
      {"fine mesh", mesh(tests::tessellated_cuboid(half, 11)), {50.5, 49.5, -0.5}},
      {"compound", Compound{{blocks, blocks + 2}}, {50, 49.5, -0.5}}};
}

/// A ball may only fall straight on these, or along x where they are straight.
std::vector<Partner> round_partners() {
  return {{"sphere", Sphere{2}, {50, 50, -2}},
          {"ellipsoid", Ellipsoid{{3, 2, 1}}, {50, 50, -1}},
          {"end of a capsule", Capsule{1, 2}, {50, 50, -3}},
          {"side of a cylinder", Cylinder{1, 3}, {50, 50, -1}, Quat(std::sqrt(0.5), 0, std::sqrt(0.5), 0)},
          {"side of a capsule", Capsule{1, 3}, {50, 50, -1}, Quat(std::sqrt(0.5), 0, std::sqrt(0.5), 0)}};
}

/// The ball starts `height` above the partner, whose id is lower or higher than the ball's and which moves as
/// prescribed. Returns the ball's id.
BodyId put(Scene& s, const Partner& partner, bool lower_id, const Twist& motion, const Twist& ball,
           double height = 0.2503) {
  const int ball_shape = s.shape(Sphere{radius}), shape = s.shape(partner.shape);
  s.add_with_id(lower_id ? 3 : 7, shape, {partner.centre, partner.turn}, motion.v, motion.w);
  const bool moves = !motion.v.isZero(0) || !motion.w.isZero(0);
  s.bodies.motion[s.row(lower_id ? 3 : 7)] = moves ? Motion::prescribed : Motion::fixed;
  const BodyId id = s.add_with_id(5, ball_shape, {{50, 50, radius + height}}, ball.v, ball.w);
  s.start();
  return id;
}

TEST_F(Rebound, FromAWall) {
  for (const Impact& impact : slanted) {
    Scene s(impact.restitution, impact.friction);
    const BodyId ball =
        s.add(s.shape(Sphere{radius}), {50, 50, radius + 0.2503}, impact.ball.v, impact.ball.w);
    s.floor();
    s.start();
    s.run(200);
    expect_twist(s, ball, after(impact, -Vec3::UnitZ(), Vec3::Zero()), 1e-13, "wall");
  }
}

TEST_F(Rebound, FromFlatBodiesOfInfiniteMass) {
  const Twist at_rest{Vec3::Zero(), Vec3::Zero()}, belt{{0.5, -0.25, 0}, Vec3::Zero()},
      lift{{0.125, 0, 0.25}, Vec3::Zero()};
  for (const Partner& partner : flat_partners())
    for (const Impact& impact : slanted)
      for (const Twist& motion : {at_rest, belt, lift})
        for (const bool lower_id : {false, true})
          for (const int impact_sweeps : {0, 100}) {
            Scene s(impact.restitution, impact.friction);
            s.settings.impact_sweeps = impact_sweeps;
            const BodyId ball = put(s, partner, lower_id, motion, impact.ball);
            s.run(150);
            expect_twist(s, ball, after(impact, -Vec3::UnitZ(), motion.v), 1e-12, partner.name);
          }
}

/// The normal does not turn: the ball falls straight, or along the side of what is straight.
TEST_F(Rebound, FromRoundBodiesOfInfiniteMass) {
  for (const Partner& partner : round_partners())
    for (Impact impact : slanted)
      for (const bool lower_id : {false, true}) {
        const bool straight = std::string_view(partner.name).starts_with("side");
        impact.ball.v[1] = 0;
        if (!straight) impact.ball.v[0] = 0;
        Scene s(impact.restitution, impact.friction);
        const BodyId ball = put(s, partner, lower_id, {Vec3::Zero(), Vec3::Zero()}, impact.ball);
        s.run(130);
        expect_twist(s, ball, after(impact, -Vec3::UnitZ(), Vec3::Zero()), 1e-12, partner.name);
      }
}

TEST_F(Rebound, FromARollerAndATurntable) {
  const Vec3 turn(0.25, 1.5, 0);
  const Partner roller{"roller", Sphere{2}, {50, 50, -2}},
      turntable{"turntable", Cylinder{3, 0.5}, {51, 49, -0.5}};
  for (Impact impact : slanted)
    for (const bool lower_id : {false, true}) {
      impact.ball.v[0] = impact.ball.v[1] = 0;
      Scene on_roller(impact.restitution, impact.friction), on_table(impact.restitution, impact.friction);
      const BodyId first = put(on_roller, roller, lower_id, {{0, 0, 0}, turn}, impact.ball);
      on_roller.run(130);
      const Vec3 surface = turn.cross(Vec3(0, 0, 2));
      expect_twist(on_roller, first, after(impact, -Vec3::UnitZ(), surface), 1e-12, "roller");
      const BodyId second = put(on_table, turntable, lower_id, {{0, 0, 0}, {0, 0, 2}}, impact.ball);
      on_table.run(130);
      expect_twist(on_table, second, after(impact, -Vec3::UnitZ(), {-2, -2, 0}), 1e-12, "turntable");
    }
}

/// Off the axis of what turns, with the normal and the pose of the step.
TEST_F(Rebound, FromACam) {
  const Part part{Sphere{1}, {{1, 0, 0.5}, Quat::Identity()}};
  const Vec3 turn(0.25, -3, -1);  // it rises to the ball
  for (const Impact& impact : slanted)
    for (const bool lower_id : {false, true}) {
      Scene s(impact.restitution, impact.friction);
      const Partner cam{"cam", Compound{{part}}, {49, 50, -1.5}};
      const BodyId ball = put(s, cam, lower_id, {Vec3::Zero(), turn}, impact.ball, 4e-3);
      s.run(1);
      const Quat half_turned(Eigen::AngleAxisd(5e-4 * turn.norm(), turn.normalized()));
      const Vec3 cam_centre = half_turned * part.pose.position,
                 ball_centre = Vec3(1, 0, 1.5 + radius + 4e-3) + 5e-4 * impact.ball.v;
      const Vec3 n = (cam_centre - ball_centre).normalized();
      ASSERT_GT(s.step->contacts().size(), 0u);
      EXPECT_GT(s.step->contacts()[0].gap, 1e-4);
      expect_twist(s, ball, after(impact, n, turn.cross(cam_centre - n)), 1e-12, "cam");
    }
}

/// An edge meets a plate in two points at once: alike whichever of the two has the lower id, and as a wall.
TEST_F(Rebound, OfABoxOnItsEdge) {
  const Quat tilt(Eigen::AngleAxisd(0.3, Vec3::UnitY()));
  const Vec3 lowest = tilt * Vec3(0.5, 0, -0.25);
  std::vector<Twist> found;
  for (const BodyId plate : {BodyId(3), BodyId(7), first_wall_id}) {
    Scene s(0.5, 0.3);
    const int box = s.shape(Box{{0.5, 0.5, 0.25}}), below = s.shape(Box{{3, 3, 0.5}});
    s.add_with_id(5, box, {{50, 50, 2.5e-3 - lowest[2]}, tilt}, {0.7, 0.4, -3}, {0.5, 1, 2});
    if (plate == first_wall_id) {
      s.floor();
    } else {
      s.add_with_id(plate, below, {{50.5, 49.5, -0.5}});
      s.bodies.motion[s.row(plate)] = Motion::fixed;
    }
    s.start();
    s.run(1);
    EXPECT_EQ(s.step->contacts().size(), 2u);
    found.push_back({s.v(5), s.w(5)});
  }
  for (const Twist& twist : found) {
    EXPECT_GT((twist.v - Vec3(0.7, 0.4, -3)).norm(), 1);
    EXPECT_LT((twist.v - found[0].v).norm() + (twist.w - found[0].w).norm(), 1e-11);
  }
}

/// Two spheres that meet head on and turn: masses, radii and the point that both impulses act at.
struct Meeting {
  Twist a, b;
  double mass_a, mass_b;
};

/// Returns their velocities after the impact, by each sphere's own radius: `radius` for both.
Meeting after_free(const Impact& impact, Meeting m) {
  const Vec3 n = Vec3::UnitZ();
  const double reduced = m.mass_a * m.mass_b / (m.mass_a + m.mass_b);
  const Vec3 u = m.b.v - m.a.v - (m.a.w + m.b.w).cross(radius * n);
  const double press = -(1 + impact.restitution) * reduced * u.dot(n);
  Vec3 rub = -2.0 / 7 * reduced * (u - u.dot(n) * n);
  rub *= std::min(1.0, impact.friction * press / std::max(rub.norm(), 1e-300));
  const Vec3 p = press * n + rub;
  const double inertia = 0.4 * radius * radius;
  m.a = {m.a.v - p / m.mass_a, m.a.w - radius * n.cross(p) / (inertia * m.mass_a)};
  m.b = {m.b.v + p / m.mass_b, m.b.w - radius * n.cross(p) / (inertia * m.mass_b)};
  return m;
}

struct Error {
  double velocity, angular_momentum;
};

/// Returns the error of a step of time dt in which the two meet, a gap of half its approach before. The
/// heavier one does not turn.
Error error_of_free_pair(const Impact& impact, double mass_a, double mass_b, double dt) {
  Scene s(impact.restitution, impact.friction);
  Meeting m{{{0, 0, 2}, {1, 5, -2}}, {{0, 0, -1}, {0.5, 3, 4}}, mass_a, mass_b};
  if (mass_a > mass_b) m.a.w.setZero();
  if (mass_b > mass_a) m.b.w.setZero();
  const int ball = s.shape(Sphere{radius});
  const double gap = dt * 3 / 2;
  const BodyId a = s.add(ball, {0.5, 0.25, 50}, m.a.v, m.a.w, mass_a);
  const BodyId b = s.add(ball, {0.5, 0.25, 50 + 2 * radius + gap + dt * 3 / 2}, m.b.v, m.b.w, mass_b);
  s.start();
  const Vec3 l = s.angular_momentum();
  s.run(1, dt);
  EXPECT_NEAR(s.step->contacts()[0].gap, gap, 1e-12);
  m = after_free(impact, m);
  const auto off = [&](BodyId id, const Twist& t) {
    return (s.v(id) - t.v).norm() + radius * (s.w(id) - t.w).norm();
  };
  double scale = 0;
  for (const std::size_t row : {s.row(a), s.row(b)})
    scale += s.bodies.angular_momentum[row].norm() +
             s.bodies.mass[row] * s.bodies.position[row].cross(s.bodies.velocity[row]).norm();
  return {off(a, m.a) + off(b, m.b), (s.angular_momentum() - l).norm() / scale};
}

/// Both sides of a free pair take their impulse at one point, which keeps angular momentum, while the arms
/// are longer than the radii by their parts of the gap: Coulomb's law holds to the order of the gap. The
/// lighter one has the lesser part, so the law of a fixed body is the limit.
TEST_F(Rebound, OfFreeSpheresKeepsAngularMomentum) {
  for (const Impact& impact : {Impact{0.5, 10, {}}, Impact{0.5, 0.1, {}}})
    for (const double ratio : {1.0, 10.0, 1e6})
      for (const bool exchanged : {false, true}) {
        const double mass_a = exchanged ? ratio : 1, mass_b = exchanged ? 1 : ratio;
        const Error coarse = error_of_free_pair(impact, mass_a, mass_b, 4e-3),
                    fine = error_of_free_pair(impact, mass_a, mass_b, 4e-4);
        EXPECT_LT(coarse.angular_momentum, 1e-13) << ratio;
        EXPECT_NEAR(coarse.velocity / fine.velocity, 10, 0.5) << ratio;
        EXPECT_LT(coarse.velocity, 0.06 / ratio) << ratio;
      }
}

}  // namespace
}  // namespace silt::rigid::testing
