// Bodies that pass each other with little room do not touch: what falls past a shelf falls freely, and what
// slides over a seam or comes to a step down keeps its speed. Lengths in m, times in s, g = 9.81.
#include <gtest/gtest.h>

#include <random>

#include "tests/hull_of.hpp"
#include "tests/rigid/shapes/meshes.hpp"
#include "tests/rigid/with_backend.hpp"

namespace silt::rigid {
namespace {

using testing::Scene;

using testing::g;

class PassingBodies : public testing::WithBackend {};

struct Mover {
  std::string name;
  Shape shape;
};

Polyhedron cuboid(const Vec3& half) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(half.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  return tests::hull_of(corners);
}

Mesh block(const Vec3& half) {
  return testing::solid_of(testing::cuboid_mesh(-half, half));
}

Compound two_boxes(const Vec3& half) {
  const Vec3 part(half[0] / 2, half[1], half[2]), middle(half[0] / 2, 0, 0);
  return {{{Box{part}, {-middle, Quat::Identity()}}, {Box{part}, {middle, Quat::Identity()}}}};
}

/// All of a width of 0.2 along x, and with their lowest points 0.1 below the origin.
std::vector<Mover> movers() {
  const Vec3 half = Vec3::Constant(0.1);
  return {{"cube", Box{half}},
          {"cylinder", Cylinder{0.1, 0.1}},
          {"polyhedron", cuboid(half)},
          {"mesh", block(half)},
          {"compound", two_boxes(half)}};
}

/// Makes a body that stays where it is.
enum class Made { box, polyhedron, mesh, compound, wall };
constexpr Made all_made[] = {Made::box, Made::polyhedron, Made::mesh, Made::compound, Made::wall};

constexpr const char* names[] = {"a box", "a polyhedron", "a mesh", "a compound", "a mesh wall"};

void add_fixed(Scene& s, Made made, const Vec3& half, const Vec3& x) {
  if (made == Made::wall)
    return add_wall(s.bodies, s.world, {block(half), {x, Quat::Identity()}, Vec3::UnitZ(), 0, {}});
  const Shape shapes[] = {Box{half}, cuboid(half), block(half), two_boxes(half)};
  const BodyId id = s.add(s.shape(shapes[static_cast<int>(made)]), x);
  s.bodies.motion[s.bodies.row_of(id)] = Motion::fixed;
}

/// The largest change that contacts made to a body's velocity, gravity left out, in so much time.
double disturbance(Scene& s, BodyId id, double time, double dt) {
  const Vec3 start = s.v(id);
  double most = 0;
  const int steps = static_cast<int>(time / dt);
  for (int i = 1; i <= steps; ++i) {
    s.run(1, dt);
    const Vec3 off = s.v(id) - start - i * dt * s.world.gravity;
    most = std::max({most, off.norm(), 0.1 * s.w(id).norm()});
  }
  return most;
}

Scene beside_a_shelf(const Mover& mover, Made made, double clearance, double speed, double margin) {
  Scene s(0, 0.5);
  s.world.gravity = {0, 0, -g};
  s.world.contact_margin = margin;
  s.add(s.shape(mover.shape), {1.1 + clearance, 1, 0.6043}, {0, 0, -speed});
  add_fixed(s, made, {0.5, 0.4, 0.02}, {0.5, 1, 0.48});
  s.start();
  return s;
}

/// The slowest take the most steps.
std::vector<double> clearances(double speed) {
  return speed == 0.1 ? std::vector{1e-6, 3e-5} : std::vector{1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3};
}

TEST_F(PassingBodies, WhatFallsPastAShelfFallsFreely) {
  constexpr double dt = 1e-3;
  for (const Mover& mover : movers())
    for (const Made made : all_made)
      for (const double speed : {0.1, 1.0, 5.0})
        for (const double clearance : clearances(speed)) {
          Scene s = beside_a_shelf(mover, made, clearance, speed, clearance > 2e-4 ? 0.05 : 0.002);
          EXPECT_LT(disturbance(s, 0, 0.06 / speed, dt), 1e-6 * speed)
              << mover.name << " by " << names[int(made)] << ", speed " << speed << ", clearance "
              << clearance;
        }
}

/// It lands where it meets the shelf by as little as a micrometre.
TEST_F(PassingBodies, WhatMeetsAShelfLandsOnIt) {
  for (const Mover& mover : movers())
    for (const Made made : all_made)
      for (const double speed : {1.0, 5.0}) {
        Scene s = beside_a_shelf(mover, made, -1e-6, speed, 0.05);
        EXPECT_GT(disturbance(s, 0, 0.06 / speed, 1e-3), 0.1 * speed)
            << mover.name << " on " << names[int(made)] << ", speed " << speed;
      }
}

/// Plates of 2 mm that fly through each other's places in a step, at a slant, meet or not as their edges do.
TEST_F(PassingBodies, FastThinPlatesMeetOrPassAsTheirEdgesDo) {
  for (const double across : {0.0, 3.0, -3.0})
    for (const double speed : {5.0, 20.0})
      for (const double overlap : {0.01, 1e-5, -1e-5, -1e-3}) {
        Scene s(0, 0);
        s.world.contact_margin = 0.05;
        const int plate = s.shape(Box{{0.1, 0.1, 0.001}});
        const double high = 0.0421, t = (high - 0.001) / speed;  // from middle to middle, and until they meet
        const BodyId id = s.add(plate, {1.2 - overlap - across * t, 1, 0.5 + high}, {across, 0, -speed});
        s.bodies.motion[s.bodies.row_of(s.add(plate, {1, 1, 0.499}))] = Motion::fixed;
        s.start();
        // a plate of this height hits the edge from the side only if it comes from there within its height
        const bool from_the_side = overlap < 0 && across < 0 && -overlap < -across * (0.004 / speed);
        const double change = disturbance(s, id, 2 * high / speed, 1e-3);
        if (overlap > 0 || from_the_side)
          EXPECT_GT(change, 0.1 * speed) << across << " " << speed << " " << overlap;
        else
          EXPECT_LT(change, 1e-6 * speed) << across << " " << speed << " " << overlap;
      }
}

Scene on_two_slabs(const Mover& mover, Made made, double step, double margin) {
  Scene s(0, 0);
  s.world.gravity = {0, 0, -g};
  s.world.contact_margin = margin;
  s.add(s.shape(mover.shape), {1.05, 1, 0.6}, {1.3, 0, 0});
  for (const int i : {0, 1}) add_fixed(s, made, {0.6, 0.5, 0.1}, {0.6 + 1.2 * i, 1, 0.4 - i * step});
  s.start();
  return s;
}

/// Fractions of 1.3 m/s lost while it slides 6.5 cm, and how high it jumps.
void expect_undisturbed(Scene& s, double dt, const std::string& what) {
  double slowest = 1.3, highest = 0;
  const int steps = static_cast<int>(0.05 / dt);
  for (int i = 0; i < steps; ++i) {
    s.run(1, dt);
    slowest = std::min(slowest, s.v(0)[0]);
    highest = std::max(highest, s.x(0)[2] - 0.6);
  }
  EXPECT_GT(slowest, 1.3 * (1 - 1e-6)) << what;
  EXPECT_LT(highest, 1e-7) << what;
}

TEST_F(PassingBodies, WhatSlidesFeelsNoSeamAndNoStepDown) {
  for (const Mover& mover : movers())
    for (const Made made : all_made)
      for (const double step : {0.0, 1e-9, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2})
        for (const double dt : step == 1e-6 ? std::vector{1e-3, 1e-4} : std::vector{1e-3}) {
          Scene s = on_two_slabs(mover, made, step, dt == 1e-3 ? 0.05 : 0.002);
          expect_undisturbed(s, dt,
                             mover.name + " on " + names[int(made)] + ", step " + std::to_string(step));
        }
}

/// The domain's border is a seam between a body and its own image, and the parts of a body have seams.
TEST_F(PassingBodies, WhatSlidesFeelsNoBorderAndNoParts) {
  for (const Mover& mover : movers())
    for (const Made made : all_made) {
      Scene border(0, 0, {1.2, 2, 2}), parts(0, 0);
      border.extent.periodic = {true, true, false};
      for (Scene* s : {&border, &parts}) {
        s->world.gravity = {0, 0, -g};
        s->world.contact_margin = 0.05;
        s->add(s->shape(mover.shape), {1.05, 1, 0.6}, {1.3, 0, 0});
      }
      add_fixed(border, made, {0.6, 0.5, 0.1}, {0.6, 1, 0.4});
      border.start();
      expect_undisturbed(border, 1e-3, mover.name + " across the border on " + names[int(made)]);
      add_fixed(parts, Made::compound, {1.2, 0.5, 0.1}, {1.2, 1, 0.4});
      parts.start();
      expect_undisturbed(parts, 1e-3, mover.name + " on parts of a body");
    }
}

/// Under a load, with friction, on a floor of twenty pieces: as on one of one piece, but for the first steps,
/// in which the load finds its way.
TEST_F(PassingBodies, WhatSlidesUnderALoadFeelsNoSeam) {
  for (const Mover& mover : movers()) {
    const auto lost = [&](int pieces) {
      Scene s(0, 0.3);
      s.settings.max_sweeps = 400;
      s.world.gravity = {0, 0, -g};
      s.world.contact_margin = 0.05;
      s.add(s.shape(mover.shape), {1.05, 1, 0.6}, {1.3, 0, 0});
      s.add(s.shape(Box{Vec3::Constant(0.09)}), {1.05, 1, 0.79}, {1.3, 0, 0});
      const double half = 1.2 / pieces;
      for (int i = 0; i < pieces; ++i)
        add_fixed(s, Made::box, {half, 0.5, 0.1}, {half * (2 * i + 1), 1, 0.4});
      s.start();
      s.run(3, 1e-3);
      const double start = s.v(0)[0];
      s.run(297, 1e-3);
      return start - s.v(0)[0];
    };
    EXPECT_NEAR(lost(20), lost(1), 2e-5) << mover.name;
    EXPECT_NEAR(lost(20), 0.3 * g * 0.297, 1e-3) << mover.name;
  }
}

/// The largest distance between two boxes' supporting planes along the axes of the separating axis theorem:
/// above 0 they are apart, below they overlap.
double separation(const Vec3& half_a, const Pose& a, const Vec3& half_b, const Pose& b) {
  const Mat3 u = a.orientation.toRotationMatrix(), v = b.orientation.toRotationMatrix();
  std::vector<Vec3> axes;
  for (int i = 0; i < 3; ++i) axes.push_back(u.col(i)), axes.push_back(v.col(i));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (const Vec3 n = u.col(i).cross(v.col(j)); n.norm() > 1e-6) axes.push_back(n.normalized());
  double most = -1;
  for (const Vec3& n : axes)
    most =
        std::max(most, std::abs(n.dot(b.position - a.position)) - half_a.dot((u.transpose() * n).cwiseAbs()) -
                           half_b.dot((v.transpose() * n).cwiseAbs()));
  return most;
}

/// A box flies past another, turning about one of its axes: contacts act if the two overlap on its way, and
/// only then.
TEST_F(PassingBodies, ContactsActIfBodiesMeet) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> of(-1, 1);
  const auto vector = [&] { return Vec3(of(random), of(random), of(random)); };
  const auto turn = [&] { return Quat(of(random), of(random), of(random), of(random)).normalized(); };
  constexpr double dt = 1e-3;
  constexpr int steps = 40, fine = 100;
  int met = 0, passed = 0;
  for (int n = 0; n < 400; ++n) {
    const Vec3 half = Vec3::Constant(0.06) + 0.05 * vector(), other = Vec3::Constant(0.06) + 0.055 * vector();
    const Vec3 v = vector().normalized() * 8,
               from = Vec3::Constant(1) - 0.5 * steps * dt * v + 0.25 * vector();
    const Quat q = turn(), q_other = turn();
    const Vec3 spin = q * Vec3::UnitX() * (n % 2 ? 30 * of(random) : 0);
    double least = 1, least_before = 1;  // up to a step after the flight's end, and up to a step before
    for (int i = 0; i <= (steps + 1) * fine; ++i) {
      const double t = i * dt / fine;
      const Quat turned = Quat(Eigen::AngleAxisd(spin.norm() * t,
                                                 spin.norm() > 0 ? Vec3(spin.normalized()) : Vec3::UnitX())) *
                          q;
      least = std::min(least, separation(half, {from + t * v, turned}, other, {Vec3::Constant(1), q_other}));
      if (i <= (steps - 1) * fine) least_before = least;
    }
    // in between the arcs are not those of the steps' chords
    if (std::abs(least) < 2e-4 || (least < 0 && least_before > -2e-4)) continue;
    Scene s(0, 0);
    s.world.contact_margin = 0.05;
    const Shape shapes[] = {Box{half}, cuboid(half), block(half)},
                others[] = {Box{other}, cuboid(other), block(other)};
    s.append(0, s.shape(shapes[n % 3]), from, q);
    s.append(1, s.shape(others[n / 3 % 3]), Vec3::Constant(1), q_other);
    s.bodies.reindex();
    s.bodies.motion[1] = Motion::fixed;
    s.bodies.set_velocity(0, v, spin);
    if (separation(half, s.bodies.pose(0), other, s.bodies.pose(1)) < 0.01) continue;
    s.start();
    const double change = disturbance(s, 0, steps * dt, dt);
    if (least < 0) {
      EXPECT_GT(change, 1e-3) << n << " least " << least;
      ++met;
    } else {
      EXPECT_LT((s.v(0) - v).norm(), 1e-8) << n << " least " << least;
      ++passed;
    }
  }
  EXPECT_GT(met, 20);
  EXPECT_GT(passed, 20);
}

}  // namespace
}  // namespace silt::rigid
