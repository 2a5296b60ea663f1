// The bits do not depend on the order of rows or on how many ranks the bodies are spread over.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <random>

#include "rigid/math/types.hpp"
#include "tests/rigid/scene.hpp"
#include "tests/rigid/shapes/meshes.hpp"
#include "tests/rigid/threaded_ranks.hpp"

namespace silt::rigid {
namespace {

using testing::Scene;

constexpr int bodies_in_scene = 60;

/// A box periodic in x and y for bodies that collide all the time, too few sweeps to solve for them: what is
/// added up in another order would show.
Scene hasty_box(double restitution, double friction) {
  Scene s(restitution, friction, {3, 3, 8});
  s.extent.periodic = {true, true, false};
  s.world.gravity = {0.5, 0, -9.81};
  s.world.contact_margin = 0.1;
  s.settings.max_sweeps = 6;
  return s;
}

std::vector<int> shuffled(int count, unsigned order) {
  std::vector<int> ids(count);
  std::iota(ids.begin(), ids.end(), 0);
  std::shuffle(ids.begin(), ids.end(), std::mt19937(order));
  return ids;
}

/// Body n of those that fall, on a lattice, its motion by its own random numbers.
void add_falling(Scene& s, int n, int shape, double mass) {
  std::mt19937 random(n);
  std::uniform_real_distribution<> u(-1, 1);
  const Quat q = Quat(u(random), u(random), u(random), u(random)).normalized();
  const Vec3 x(0.4 + 0.75 * (n % 4), 0.4 + 0.75 * (n / 4 % 4), 0.4 + 0.75 * (n / 16));
  s.add_with_id(10 + 3 * n, shape, {x, q}, {u(random), u(random), u(random)},
                {5 * u(random), 5 * u(random), 0}, mass);
}

Compound star() {
  Compound star;
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
    star.parts.push_back({Capsule{0.1, 0.15}, {Vec3::Zero(), rotation_between(Vec3::UnitZ(), axis)}});
  return star;
}

/// Balls, boxes, capsules and stars falling onto a floor.
Scene tumble(unsigned order) {
  Scene s = hasty_box(0.4, 0.3);
  const int shapes[] = {s.shape(Sphere{0.25}), s.shape(Capsule{0.12, 0.2}), s.shape(star()),
                        s.shape(Box{{0.2, 0.15, 0.25}})};
  for (const int n : shuffled(bodies_in_scene, order)) add_falling(s, n, shapes[n % 4], 1 + n % 3);
  s.bodies.motion[7] = Motion::fixed;
  s.bodies.set_velocity(7, Vec3::Zero(), Vec3::Zero());
  s.bodies.motion[20] = Motion::prescribed;
  s.floor({0.3, 0, 0});
  return s;
}

/// Returns this scene with an impact phase.
Scene tumble_of_impacts(unsigned order) {
  Scene s = tumble(order);
  s.world.materials[0].restitution = 0.9;
  s.settings.impact_sweeps = 60;
  return s;
}

/// Balls of two materials, slippery between equals and rough between unequals, so that groups of contacts
/// with friction, without, and of both come about.
Scene partly_slippery(unsigned order) {
  Scene s = hasty_box(0.4, 0);
  s.world.materials = {{0.4, 0}, {0.4, 0.5}, {0.4, 0.5}, {0.4, 0}};
  s.world.material_count = 2;
  const int ball = s.shape(Sphere{0.35});
  for (const int n : shuffled(bodies_in_scene, order)) {
    add_falling(s, n, ball, 1);
    s.bodies.material[s.row(10 + 3 * n)] = n % 3 == 0;
  }
  s.floor();
  return s;
}

/// Balls, boxes and stars on a turning plate, prescribed, much larger than a rank's slab, with a beam across
/// it (a compound) that sweeps them along.
Scene carousel(unsigned order) {
  Scene s(0.3, 0.5, {6, 6, 6});
  s.world.gravity = {0, 0, -9.81};
  s.world.contact_margin = 0.1;
  s.settings.max_sweeps = 6;
  Compound plate;
  plate.parts = {{Box{{2, 2, 0.1}}, {}}, {Box{{1.9, 0.1, 0.2}}, {Vec3(0, 0, 0.25), Quat::Identity()}}};
  const int shapes[] = {s.shape(Sphere{0.2}), s.shape(Box{{0.2, 0.15, 0.25}}), s.shape(star())};
  const int turntable = s.shape(plate);
  for (const int id : shuffled(24, order))
    s.add_with_id(10 + 3 * id, shapes[id % 3],
                  {{1.8 + 0.6 * (id % 5), 1.9 + 0.7 * (id / 5 % 4), 2.2 + id / 20}}, Vec3::Zero(),
                  {0, 0, 0.1 * id}, 1 + id % 3);
  s.add_with_id(1000, turntable, {{3, 3, 1}}, {0.2, 0, 0}, {0, 0.05, 2});
  s.bodies.motion[s.row(1000)] = Motion::prescribed;
  s.floor();
  return s;
}

/// Rings and cubes of triangles, balls, boxes and capsules on a floor of triangles, with a paddle of
/// triangles across a periodic border.
Scene meshes_on_a_floor(unsigned order) {
  Scene s = hasty_box(0.4, 0.3);
  s.extent.periodic = {true, true, false};
  s.world.gravity = {0, 0, -9.81};
  const int shapes[] = {
      s.shape(testing::solid_of(testing::torus_mesh(0.22, 0.07, 10, 6))),
      s.shape(testing::solid_of(testing::cuboid_mesh(Vec3::Constant(-0.2), Vec3::Constant(0.2)))),
      s.shape(Sphere{0.2}),
      s.shape(Box{{0.2, 0.15, 0.25}}),
      s.shape(Capsule{0.12, 0.2}),
      s.shape(star())};
  for (const int n : shuffled(36, order)) {
    add_falling(s, n, shapes[n % 6], 1 + n % 3);
    s.bodies.position[s.row(10 + 3 * n)][2] += 0.9;
  }
  const auto floor = testing::solid_of(testing::random_slab(9, 0.5, 6, 3));
  add_wall(s.bodies, s.world, {floor, {{-3, -3, 0.6}, Quat::Identity()}, Vec3::UnitZ(), 0, {}});
  PrescribedMotion turns;
  turns.angular_velocity = {0, 0, 0.5};
  const auto paddle = testing::solid_of(testing::cuboid_mesh({-0.8, -0.1, -0.2}, {0.8, 0.1, 0.2}));
  add_wall(s.bodies, s.world, {paddle, {{0.2, 1.5, 0.9}, Quat::Identity()}, Vec3::UnitZ(), 0, turns});
  return s;
}

/// Balls, boxes and stars that stick to each other and to a floor that moves.
Scene sticky(unsigned order) {
  Scene s = tumble(order);
  Material& m = s.world.materials[0];
  m.restitution = 0, m.cohesion = 60, m.hamaker = 1e-4, m.hamaker_gap = 1e-3;
  set_materials(s.settings, s.world);
  return s;
}

using MakeScene = Scene (*)(unsigned order);

void push(BodySet& bodies, int step) {  // the outside world: a force on some, by id; the same on any rank
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const double phase = 0.01 * step * static_cast<double>(bodies.id[row]);
    bodies.add_force(row, {0.3 * std::sin(phase), 0.1, 0});
    bodies.add_torque(row, {0, 0.01 * std::cos(phase), 0});
  }
}

std::vector<BodyRecord> records(const BodySet& b) {
  std::vector<BodyRecord> all;
  for (std::size_t row = 0; row < b.owned; ++row) all.push_back(b.record(row));
  return all;
}

bool same_bits(const BodyRecord& p, const BodyRecord& q) {
  bool same = true;
  visit_columns([&](const BodyColumn&, auto, auto member) {
    same &= std::memcmp(&(p.*member), &(q.*member), sizeof(p.*member)) == 0;
  });
  return same;
}

struct Outcome {
  std::vector<BodyRecord> bodies;
  std::uint64_t contacts = 0, impact_sweeps = 0, visitors = 0, mixed = 0;
  std::vector<int> sweeps;  // of each step, those of the rank with most
};

Outcome on_one_rank(const char* resolver, unsigned order, int steps, MakeScene make = tumble) {
  Scene s = make(order);
  s.start(resolver);
  Outcome o;
  for (int i = 0; i < steps; ++i) {
    push(s.bodies, i);
    s.run(1, 2e-3);
    o.contacts += s.report.resolver.contacts;
    o.sweeps.push_back(s.report.resolver.sweeps);
    o.impact_sweeps += s.report.resolver.impact_sweeps;
  }
  o.bodies = records(s.bodies);
  return o;
}

Outcome on_ranks(const char* resolver, int ranks, int steps, MakeScene make = tumble) {
  testing::SharedMemory memory(ranks);
  std::vector<Outcome> outcomes(ranks);
  std::vector<std::thread> threads;
  for (int rank = 0; rank < ranks; ++rank)
    threads.emplace_back([&, rank] {
      Scene s = make(rank);
      testing::ThreadedExchange exchange(s.extent, s.world, memory, rank);
      const auto law = make_resolver(resolver, s.settings);
      RigidStep step(s.world, *s.backend, *law, exchange,
                     adapters::make_broad_phase(testing::broad_phase_name));
      if (rank != 0) {  // rank 0 hands them out
        while (s.bodies.first_wall() > 0) s.bodies.erase(0);
        s.bodies.owned = 0;
        s.bodies.reindex();
      }
      exchange.synchronise(s.bodies);
      Outcome& o = outcomes[rank];
      for (int i = 0; i < steps; ++i) {
        push(s.bodies, i);
        const RigidStepReport report = step(s.bodies, 2e-3);
        o.contacts += report.resolver.contacts;
        o.sweeps.push_back(report.resolver.sweeps);
        o.impact_sweeps += report.resolver.impact_sweeps;
        o.mixed += report.mixed_owner_contacts;
      }
      o.bodies = records(s.bodies);
      o.visitors = exchange.visitors_seen;
    });
  for (std::thread& t : threads) t.join();
  Outcome all;
  for (const Outcome& o : outcomes) {
    all.bodies.insert(all.bodies.end(), o.bodies.begin(), o.bodies.end());
    all.contacts += o.contacts, all.visitors += o.visitors, all.mixed += o.mixed;
    all.sweeps.resize(o.sweeps.size());
    for (std::size_t i = 0; i < o.sweeps.size(); ++i) all.sweeps[i] = std::max(all.sweeps[i], o.sweeps[i]);
    all.impact_sweeps = std::max(all.impact_sweeps, o.impact_sweeps);
  }
  std::sort(all.bodies.begin(), all.bodies.end(), [](auto& p, auto& q) { return p.id < q.id; });
  return all;
}

void expect_same(const Outcome& p, const Outcome& q) {
  ASSERT_EQ(p.bodies.size(), q.bodies.size());
  int different = 0;
  for (std::size_t k = 0; k < p.bodies.size(); ++k) different += !same_bits(p.bodies[k], q.bodies[k]);
  EXPECT_EQ(different, 0);
  EXPECT_EQ(p.contacts, q.contacts);
  EXPECT_EQ(p.sweeps, q.sweeps);
}

TEST(Determinism, OrderOfInsertionDoesNotMatter) {
  const Outcome reference = on_one_rank("sffd", 1, 300);
  EXPECT_GT(reference.contacts, 5000u);
  expect_same(reference, on_one_rank("sffd", 2, 300));
  expect_same(on_one_rank("ffd", 1, 200), on_one_rank("ffd", 2, 200));
}

TEST(Determinism, NumberOfRanksDoesNotMatter) {
  const Outcome reference = on_one_rank("sffd", 1, 200);
  for (int ranks : {2, 3, 5}) {
    const Outcome o = on_ranks("sffd", ranks, 200);
    expect_same(reference, o);
    EXPECT_GT(o.mixed, 100u);
    EXPECT_GT(o.visitors, 0u);
  }
}

TEST(Determinism, ClassicFfdToo) {
  const Outcome reference = on_one_rank("ffd", 1, 200);
  for (int ranks : {2, 3}) expect_same(reference, on_ranks("ffd", ranks, 200));
}

TEST(Determinism, TheBroadPhaseDoesNotShow) {
  const Outcome reference = on_one_rank("sffd", 1, 200);
  for (const char* name : {"bullet", "fcl"}) {
    testing::broad_phase_name = name;
    for (int ranks : {1, 3}) expect_same(reference, on_ranks("sffd", ranks, 200));
    testing::broad_phase_name = "auto";
  }
}

/// Expects the same bits of another order of rows and on several ranks; returns them.
Outcome everywhere(MakeScene make, int steps) {
  const Outcome reference = on_one_rank("sffd", 1, steps, make);
  expect_same(reference, on_one_rank("sffd", 2, steps, make));
  for (int ranks : {1, 3, 4}) expect_same(reference, on_ranks("sffd", ranks, steps, make));
  return reference;
}

TEST(Determinism, WhatIsSolvedBesideAContactDoesNotShow) {
  EXPECT_GT(everywhere(partly_slippery, 200).contacts, 6000u);
}

TEST(Determinism, ImpactsToo) {
  EXPECT_GT(everywhere(tumble_of_impacts, 250).impact_sweeps, 300u);
}

TEST(Determinism, CohesionToo) {
  EXPECT_GT(everywhere(sticky, 250).contacts, 5000u);
}

TEST(Determinism, MeshesToo) {
  EXPECT_GT(everywhere(meshes_on_a_floor, 300).contacts, 4000u);
}

TEST(Determinism, PrescribedBodyLargerThanASlab) {
  const Outcome reference = everywhere(carousel, 400);
  EXPECT_GT(reference.contacts, 4000u);
  const BodyRecord& plate = reference.bodies.back();
  EXPECT_EQ(plate.id, 1000u);
  EXPECT_NEAR(plate.position[0], 3 + 0.2 * 0.8, 1e-12) << "as prescribed, whatever lies on it";
  EXPECT_EQ(plate.velocity[0], 0.2);
}

}  // namespace
}  // namespace silt::rigid
