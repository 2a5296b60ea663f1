#pragma once
// Dry scenes for the tests of the body exchange: described alike on every rank, to be run on all ranks or, as
// the reference, by each rank alone.
#include <bit>
#include <functional>
#include <memory>
#include <random>
#include <string_view>
#include <utility>

#include "adapters/automatic/collision_factory.hpp"
#include "coupler/exchange/check_exchange.hpp"
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/exchange/parallel_body_exchange.hpp"
#include "coupler/state_hash.hpp"
#include "lbm/blocks/equal_cut.hpp"
#include "parallel/collectives.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/rigid_step.hpp"
#include "rigid/shapes/shape.hpp"
#include "tests/odd_cut.hpp"

namespace silt::coupler::testing {

using rigid::BodyId;
using rigid::Vec3;

/// Hashes values bit by bit.
class BitHash {
 public:
  template <class... T>
  void add(const T&... values) {
    (parallel::put(bytes_, values), ...);
  }
  std::uint64_t value() const {
    return std::hash<std::string_view>{}({reinterpret_cast<const char*>(bytes_.data()), bytes_.size()});
  }

 private:
  parallel::Bytes bytes_;
};

/// Hashes everything that is saved of a record.
inline std::uint64_t hash_of(const rigid::BodyRecord& r) {
  BitHash hash;
  visit_columns(r, [&](const rigid::BodyColumn&, auto numbers) { hash.add(numbers); });
  visit_columns(coupling_of(r.attached_state), [&](const CouplingColumn& c, auto numbers) {
    if (c.saved) hash.add(numbers);
  });
  return hash.value();
}

inline int ranks_of(MPI_Comm comm) {
  int n = 1;
  MPI_Comm_size(comm, &n);
  return n;
}

inline std::uint64_t sum_of(MPI_Comm comm, std::uint64_t x) {
  std::uint64_t all = 0;
  MPI_Allreduce(&x, &all, 1, MPI_UINT64_T, MPI_SUM, comm);
  return all;
}

inline int max_of(MPI_Comm comm, int x) {
  int most = 0;
  MPI_Allreduce(&x, &most, 1, MPI_INT, MPI_MAX, comm);
  return most;
}

/// Bodies, walls and laws; knows nothing of ranks.
struct ExchangeScene {
  lbm::Int3 cells{24, 24, 24};
  std::array<bool, 3> periodic{true, true, true};
  rigid::World world;
  rigid::BodySet bodies;
  rigid::ResolverSettings settings;
  const char* broad_phase = "auto";

  ExchangeScene(double restitution, double friction) {
    world.materials = {{restitution, friction}};
    world.material_count = 1;
    world.contact_margin = 0.25;
  }
  int shape(const rigid::Shape& s) {
    world.shapes.push_back(s);
    world.bounding_radii.push_back(rigid::bounding_radius(s));
    return static_cast<int>(world.shapes.size()) - 1;
  }
  void add(BodyId id, int shape, const Vec3& x, const Vec3& v = Vec3::Zero(), const Vec3& w = Vec3::Zero(),
           const rigid::Quat& q = rigid::Quat::Identity()) {
    const rigid::MassProperties p = rigid::mass_properties(world.shapes[shape]);
    rigid::BodyRecord r;
    r.id = id;
    r.shape = shape;
    r.mass = p.volume;
    Eigen::Map<rigid::Mat3>{r.inertia_B} = p.inertia;
    Eigen::Map<Vec3>{r.position} = x;
    coupling_of(r.attached_state).mapped.position() =
        x + Vec3(0.01, 0.02, 0.03);  // something that only a record carries
    r.orientation[0] = q.w(), r.orientation[1] = q.x(), r.orientation[2] = q.y(), r.orientation[3] = q.z();
    bodies.add(r);
    bodies.reindex();
    bodies.set_velocity(bodies.row_of(id), v, w);
  }
  void add_walls() {  // where not periodic
    std::array<rigid::WallSpec, 6> walls;
    for (rigid::WallSpec& w : walls) w.solid = true;
    rigid::add_walls(bodies, world, extent(), walls);
  }
  rigid::Extent extent() const { return {{double(cells.x), double(cells.y), double(cells.z)}, periodic}; }
  std::unique_ptr<rigid::ContactResolver> resolver(std::string_view law) const {
    rigid::ResolverSettings all = settings;
    rigid::set_materials(all, world);
    return rigid::make_resolver(law, all);
  }
  std::array<lbm::SideCondition, 6> sides() const {
    std::array<lbm::SideCondition, 6> s;
    for (int side = 0; side < 6; ++side)
      s[side].kind = periodic[side / 2] ? lbm::SideKind::periodic : lbm::SideKind::bounce;
    return s;
  }
};

/// Cuts the cells for so many ranks.
struct Blocks {
  std::function<lbm::CutTree(lbm::Int3 cells, int ranks)> cut = lbm::equal_cut;
  Blocks() = default;
  Blocks(lbm::Int3 size) : cut([=](lbm::Int3 cells, int) { return lbm::grid_cut(cells, size); }) {}
};
/// So many blocks a rank, of all sizes.
inline Blocks odd_blocks(int a_rank, int edge = 2) {
  Blocks blocks;
  blocks.cut = [=](lbm::Int3 cells, int ranks) { return tests::odd_cut(cells, a_rank * ranks, edge, ranks); };
  return blocks;
}

/// Reach of copies that the contacts of these tests need: half a margin, and some.
constexpr double contact_rim = 0.25;

/// Keeps account of the contacts that owners are given: each one once at the owner of either body, in order.
class Witness : public ParallelBodyExchange {
 public:
  using ParallelBodyExchange::ParallelBodyExchange;
  std::uint64_t at_first = 0, at_second = 0;  // wrapping sums of hashes
  bool in_order = true;
  std::size_t visitors = 0;

  void exchange_contacts(rigid::BodySet& bodies, std::vector<rigid::Contact>& contacts) override {
    ParallelBodyExchange::exchange_contacts(bodies, contacts);
    visitors += bodies.visitors;
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      const rigid::Contact& c = contacts[k];
      if (k > 0) in_order &= contacts[k - 1].key() < c.key();
      if (bodies.row_of(c.a) < bodies.owned) at_first += hash_of_contact(c);
      if (bodies.row_of(c.b) < bodies.owned) at_second += hash_of_contact(c);
    }
  }

 private:
  static std::uint64_t hash_of_contact(const rigid::Contact& c) {
    BitHash hash;
    hash.add(c.a, c.b, c.feature, c.image, c.gap, c.restitution, c.friction, c.radii, c.lubrication,
             c.normal_turns);
    for (const Vec3* v : {&c.normal, &c.r_a, &c.r_b}) hash.add((*v)[0], (*v)[1], (*v)[2]);
    return hash.value();
  }
};

/// Returns the wrapping sum over all owned bodies of the hashes of their records (holder state included) and
/// stored impulses: the same on any number of ranks. Collective.
inline std::uint64_t records_hash(MPI_Comm comm, const rigid::BodySet& bodies) {
  std::uint64_t mine = hash_bodies(bodies);
  for (std::size_t row = 0; row < bodies.owned; ++row) mine += hash_of(bodies.record(row));
  return parallel::sum_over_ranks(comm, mine);
}

/// Counts what all ranks own. Collective.
inline OwnedBodies count_owned(MPI_Comm comm, const rigid::BodySet& bodies) {
  return parallel::sum_over_ranks(comm, ExpectedBodies(rigid::BodySet{}).excess(bodies));
}

/// A scene on a communicator, its bodies spread over the ranks. Exchange: ParallelBodyExchange or one derived
/// from it.
template <class Exchange = ParallelBodyExchange>
struct SceneRun {
  ExchangeScene scene;
  MPI_Comm comm;
  lbm::Domain domain;
  Exchange exchange;
  std::unique_ptr<rigid::CollisionBackend> backend;
  std::unique_ptr<rigid::ContactResolver> resolver;
  rigid::RigidStep step;
  rigid::RigidStepReport report;
  std::uint64_t contacts = 0, mixed_contacts = 0, sweeps = 0, impact_sweeps = 0;

  SceneRun(MPI_Comm comm, const ExchangeScene& from, std::string_view law = "sffd", Blocks blocks = {},
           double rim = contact_rim,
           std::unique_ptr<rigid::CollisionBackend> collision = adapters::make_backend("auto"))
      : scene(from),
        comm(comm),
        domain(blocks.cut(scene.cells, ranks_of(comm)), scene.sides(), ranks_of(comm)),
        exchange(comm, domain, scene.world, rim),
        backend(std::move(collision)),
        resolver(scene.resolver(law)),
        step(scene.world, *backend, *resolver, exchange, adapters::make_broad_phase(scene.broad_phase)) {
    drop_others();
    exchange.synchronise(scene.bodies);
  }
  rigid::BodySet& bodies() { return scene.bodies; }
  void advance(double dt = 1) {
    report = step(scene.bodies, dt);
    contacts += report.resolver.contacts;
    mixed_contacts += report.mixed_owner_contacts;
    sweeps += report.resolver.sweeps;
    impact_sweeps += report.resolver.impact_sweeps;
  }
  std::uint64_t hash() { return records_hash(comm, scene.bodies); }

 private:
  /// Bodies whose centres other ranks hold.
  void drop_others() {
    rigid::BodySet& b = scene.bodies;
    for (std::size_t row = b.owned; row-- > 0;)
      if (exchange.rank_at(b.position[row]) != exchange.rank()) b.erase(row), --b.owned;
    b.reindex();
  }
};

/// Adds body k of those on a lattice of places, 16 a layer, each a little off its place, with its own random
/// motion.
inline void add_flying(ExchangeScene& s, int k, int shape, double speed, double lift = 0) {
  std::mt19937 random(k);
  std::uniform_real_distribution<> u(-1, 1);
  const Vec3 x = Vec3(3 + 6 * (k % 4), 3 + 6 * (k / 4 % 4), 3 + 6 * (k / 16) + lift) +
                 0.3 * Vec3(u(random), u(random), u(random));
  const Vec3 v(u(random), u(random), u(random)), w(u(random), u(random), u(random));
  const rigid::Quat q = rigid::Quat(1, u(random), u(random), u(random)).normalized();
  s.add(1000 - 7 * k, shape, x, speed * v, 0.1 * w, q);
}

/// Spheres of three sizes and boxes, all of them moving: a gas that never rests.
inline ExchangeScene gas(double restitution, double speed = 0.3) {
  ExchangeScene s(restitution, 0.2);
  const int shapes[] = {s.shape(rigid::Sphere{1.6}), s.shape(rigid::Sphere{2.2}), s.shape(rigid::Sphere{2.6}),
                        s.shape(rigid::Box{{1.2, 1.8, 1.4}})};
  for (int k = 0; k < 64; ++k) add_flying(s, k, shapes[k % 7 == 0 ? 3 : k % 3], speed);
  return s;
}

/// Keeps the bodies of a scene without walls at these places.
template <class Keep>
ExchangeScene thinned(ExchangeScene s, Keep&& keep) {
  const rigid::BodySet all = std::exchange(s.bodies, {});
  for (std::size_t row = 0; row < all.owned; ++row)
    if (keep(all.position[row])) s.bodies.add(all.record(row));
  s.bodies.reindex();
  return s;
}

/// A ball that overlaps every block, small ones around it.
inline ExchangeScene planet() {
  const Vec3 centre(12, 12, 12);
  const double radius = 8.5;
  ExchangeScene s = thinned(gas(1), [&](const Vec3& x) { return (x - centre).norm() > radius + 2.6; });
  s.add(5000, s.shape(rigid::Sphere{radius}), centre, {0.02, 0.03, -0.05});
  return s;
}

}  // namespace silt::coupler::testing
