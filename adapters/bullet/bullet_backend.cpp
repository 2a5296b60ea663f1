// The narrow phase; only files of this folder see Bullet's headers.
#include "adapters/common/engine_backend.hpp"

#include <btBulletCollisionCommon.h>

#include <BulletCollision/CollisionDispatch/btBoxBoxDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <cmath>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <variant>

#include "rigid/shapes/shape.hpp"

#ifndef BT_USE_DOUBLE_PRECISION
#error "build against bullet-float64: Bullet in single precision is off by up to 3e-4 at coordinates of 1000"
#endif

namespace silt::adapters {

using namespace rigid;

namespace {

struct NoMemory : std::bad_alloc {
  const char* what() const noexcept override {
    return "there is no memory left for the collision backend bullet (see ulimit -v)";
  }
};

/// Throws when memory is exhausted; Bullet does not check the result of its allocation.
void* allocate(std::size_t size) {
  if (void* const memory = std::malloc(size)) return memory;
  throw NoMemory();
}
[[maybe_unused]] const bool allocation_throws = (btAlignedAllocSetCustom(allocate, std::free), true);

btVector3 to_bullet(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
Vec3 from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}
btTransform to_bullet(const Pose& pose) {
  const auto& q = pose.orientation;
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), to_bullet(pose.position));
}

/// Pools for the one pair that is asked for at a time. Those of Bullet's defaults have room for thousands,
/// which a run clears when it starts: 7 MB.
btDefaultCollisionConstructionInfo pools_of_a_pair() {
  btDefaultCollisionConstructionInfo pools;
  pools.m_defaultMaxPersistentManifoldPoolSize = pools.m_defaultMaxCollisionAlgorithmPoolSize = 8;
  return pools;
}

/// A bounded convex shape by its exact support function, about the origin of its frame, which is inside.
class BulletSupport : public btConvexInternalShape {
 public:
  explicit BulletSupport(const ConvexShape& shape) : shape_(shape) {
    m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE;
    m_collisionMargin = 0;
  }
  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& direction) const override {
    return to_bullet(support(shape_, from_bullet(direction)));
  }
  void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* directions, btVector3* out,
                                                         int count) const override {
    for (int i = 0; i < count; ++i) out[i] = localGetSupportingVertexWithoutMargin(directions[i]);
  }
  void calculateLocalInertia(btScalar, btVector3& inertia) const override { inertia.setZero(); }
  const char* getName() const override { return "support"; }

 private:
  const ConvexShape& shape_;
};

/// A Bullet shape on the stack that refers to the shape. Its margin is the radius of sphere and capsule, 0
/// for shapes given by their support, else `margin` (Bullet's default of 0.04 would round the edges).
class BulletShape {
 public:
  explicit BulletShape(const ConvexShape& shape, double margin = 0) {
    std::visit(
        [&]<class S>(const S& s) {
          if constexpr (requires { make(s, margin); })
            make(s, margin);
          else
            shape_.emplace<BulletSupport>(shape);
        },
        shape);
  }
  btCollisionShape* get() {
    return std::visit(
        [](auto& s) -> btCollisionShape* {
          if constexpr (std::is_same_v<std::decay_t<decltype(s)>, std::monostate>)
            return nullptr;
          else
            return &s;
        },
        shape_);
  }
  const btConvexShape* convex() { return static_cast<const btConvexShape*>(get()); }

 private:
  void make(const Sphere& s, double) { shape_.emplace<btSphereShape>(s.radius); }
  void make(const Capsule& c, double) { shape_.emplace<btCapsuleShapeZ>(c.radius, 2 * c.half_length); }
  void make(const Box& b, double margin) {
    shape_.emplace<btBoxShape>(to_bullet(b.half_edges)).setMargin(margin);
  }
  void make(const Cylinder& c, double margin) {
    const btVector3 half(c.radius, c.radius, c.half_length);
    shape_.emplace<btCylinderShapeZ>(half).setMargin(margin);
  }
  void make(const Polyhedron& q, double margin) {
    auto& hull = shape_.emplace<btConvexHullShape>();
    for (const Vec3& v : q.mesh->vertices) hull.addPoint(to_bullet(v), false);
    hull.recalcLocalAabb();
    hull.setMargin(margin);
  }
  void make(const HalfSpace& h, double) {
    shape_.emplace<btStaticPlaneShape>(to_bullet(h.normal), 0).setMargin(0);
  }

  std::variant<std::monostate, btSphereShape, btCapsuleShapeZ, btBoxShape, btCylinderShapeZ, BulletSupport,
               btConvexHullShape, btStaticPlaneShape>
      shape_;
};

/// Keeps the deepest point reported by contactPairTest.
struct Deepest : btCollisionWorld::ContactResultCallback {
  const btCollisionObject* a;
  std::optional<Answer> answer;

  explicit Deepest(const btCollisionObject* first) : a(first) {}
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper* first, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    const double gap = point.getDistance();
    if (answer && answer->gap <= gap) return 0;
    // Bullet's normal points from its second object to its first
    const Vec3 n = from_bullet(point.m_normalWorldOnB);
    answer = Answer{first->getCollisionObject() == a ? Vec3(-n) : n, gap};
    return 0;
  }
};

class BulletBackend : public EngineBackend {
 public:
  BulletBackend() : dispatcher_(&configuration_), world_(&dispatcher_, nullptr, &configuration_) {}
  std::string_view name() const override { return "bullet"; }

 protected:
  /// In order: Bullet's own algorithm for the pair; GJK and EPA on the shapes moved apart; the same in place;
  /// with margins where Bullet has them (without them overlapping coaxial cylinders are always wrong).
  int methods(const Query& q) const override {
    return std::holds_alternative<HalfSpace>(q.b) ? 1 : has_margin(q.a) || has_margin(q.b) ? 4 : 3;
  }
  std::optional<Answer> ask(int method, const Query& q) override {
    if (method == 1) return gjk_apart(q);
    if (method == 2) return gjk_epa(q, Vec3::Zero());
    if (method == 3) return gjk_epa_with_margins(q);
    const bool boxes = std::holds_alternative<Box>(q.a) && std::holds_alternative<Box>(q.b);
    if (!boxes) return closest(q);
    if (const auto overlap = box_box(q); overlap && overlap->gap < -touching) return overlap;
    const auto near = closest(q);
    return near && std::abs(near->gap) < touching ? gjk_apart(q) : near;
  }

  std::unique_ptr<MeshTree> make_tree(const SharedMesh& mesh) override { return make_bullet_tree(mesh); }

 private:
  /// Gap (lattice units) below which the normal is determined again with the shapes moved apart.
  static constexpr double touching = 1e-3;

  static bool has_margin(const ConvexShape& shape) {
    return std::holds_alternative<Cylinder>(shape) || std::holds_alternative<Polyhedron>(shape);
  }

  /// Bullet's separating-axis test for two overlapping boxes. It prefers a face to crossed edges that are up
  /// to 5 % less deep; the check of the answer detects that.
  static std::optional<Answer> box_box(const Query& q) {
    BulletShape a(q.a), b(q.b);
    btBoxBoxDetector detector(static_cast<btBoxShape*>(a.get()), static_cast<btBoxShape*>(b.get()));
    btDiscreteCollisionDetectorInterface::ClosestPointInput input;
    input.m_transformA = to_bullet(q.pose_a);
    input.m_transformB = to_bullet(q.pose_b);
    btPointCollector found;
    detector.getClosestPoints(input, found, nullptr);
    if (!found.m_hasResult) return {};
    // the test adds 1e-5 to every cosine before it tests crossed edges, and divides by their sine
    const auto& [box_a, box_b] = std::pair(std::get<Box>(q.a), std::get<Box>(q.b));
    const double padding = 1e-3 * (box_a.half_edges + box_b.half_edges).norm();
    return Answer{-from_bullet(found.m_normalOnBInWorld), found.m_distance, padding};
  }

  /// Closest points within the tolerance, or overlap, by contactPairTest. Manifolds are not kept: they drift.
  std::optional<Answer> closest(const Query& q) {
    BulletShape shape_a(q.a), shape_b(q.b);
    btCollisionObject a, b;
    a.setCollisionShape(shape_a.get());
    b.setCollisionShape(shape_b.get());
    a.setWorldTransform(to_bullet(q.pose_a));
    b.setWorldTransform(to_bullet(q.pose_b));
    Deepest deepest(&a);
    deepest.m_closestDistanceThreshold = q.tolerance;
    world_.contactPairTest(&a, &b, deepest);
    if (!deepest.answer || deepest.answer->gap > q.tolerance) return {};
    return deepest.answer;
  }

  /// Margins round the edges of boxes and cylinders and enlarge hulls.
  static std::optional<Answer> gjk_epa_with_margins(const Query& q) {
    constexpr double margin = 0.04;  // Bullet's own
    auto answer = gjk_epa(q, Vec3::Zero(), margin);
    if (answer) answer->padding = 4 * margin;
    return answer;
  }

  static std::optional<Answer> gjk_epa(const Query& q, const Vec3& shift_of_b, double margin = 0) {
    BulletShape a(q.a, margin), b(q.b, margin);
    btVoronoiSimplexSolver simplex;
    btGjkEpaPenetrationDepthSolver epa;
    btGjkPairDetector detector(a.convex(), b.convex(), &simplex, &epa);
    btGjkPairDetector::ClosestPointInput input;
    input.m_transformA = to_bullet(q.pose_a);
    input.m_transformB = to_bullet(Pose{q.pose_b.position + shift_of_b, q.pose_b.orientation});
    btPointCollector found;
    detector.getClosestPoints(input, found, nullptr);
    const Vec3 n = -from_bullet(found.m_normalOnBInWorld);
    const double gap = found.m_distance - n.dot(shift_of_b);
    if (!found.m_hasResult || gap > q.tolerance) return {};
    return Answer{n, gap};
  }

  /// Repeats the query with b moved along the last normal until the normal is constant.
  static std::optional<Answer> gjk_apart(const Query& q) {
    constexpr double distance = 0.01;  // lattice units
    constexpr int rounds = 5;
    std::optional<Answer> answer = gjk_epa(q, Vec3::Zero());
    for (int round = 0; round < rounds && answer; ++round) {
      const Vec3 before = answer->normal;
      answer = gjk_epa(q, distance * before);
      if (answer && (answer->normal - before).squaredNorm() < 1e-24) break;
    }
    return answer;
  }

  btDefaultCollisionConfiguration configuration_{pools_of_a_pair()};
  btCollisionDispatcher dispatcher_;
  btCollisionWorld world_;
};

}  // namespace

/// Checks that the library computes in double. Debian ships Bullet in float and in double; a mix links
/// without complaint and computes nonsense. The name of the hull's constructor contains its number type, so
/// the wrong library does not resolve it; a box must return unchanged through a virtual call.
void check_bullet_precision() {
  const btScalar corners[] = {1.0 / 3, 0, 0, 0, 0, 0, 2.0 / 3, 0, 0, 1e9 + 1.0 / 3, 0, 0};
  btConvexHullShape hull(corners, 3, 4 * sizeof(btScalar));
  hull.setMargin(0);
  btSphereShape sphere(1.0 / 3);
  btVector3 lower, upper;
  btTransform at(btQuaternion::getIdentity(), btVector3(1000, -1000, 1.0 / 7));
  static_cast<btCollisionShape&>(sphere).getAabb(at, lower, upper);
  const bool right = std::abs(upper.x() - (1000 + 1.0 / 3)) < 1e-12 &&
                     std::abs(lower.y() + 1000 + 1.0 / 3) < 1e-12 &&
                     std::abs(lower.z() - (1.0 / 7 - 1.0 / 3)) < 1e-12 && hull.getNumPoints() == 3 &&
                     hull.getScaledPoint(2).y() == 1e9 + 1.0 / 3;
  if (!right)
    throw std::runtime_error(
        "Bullet at run time is not the double-precision build (libBulletCollision-float64) this program was "
        "built against: install libbullet3.24 and remove other builds of Bullet from the library path");
}

std::unique_ptr<CollisionBackend> make_bullet_backend() {
  check_bullet_precision();
  return std::make_unique<BulletBackend>();
}

}  // namespace silt::adapters
