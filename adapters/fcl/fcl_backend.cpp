// The narrow phase by FCL; only files of this folder include FCL. Its assertions end the process, so signed
// distances (it asserts where shapes nearly touch) and distances to a half-space are not used.
#include "adapters/common/engine_backend.hpp"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk_libccd.h>
#include <fcl/narrowphase/distance.h>

#include <optional>
#include <type_traits>
#include <variant>

#include "rigid/collision/convex_core.hpp"

// Debian's FCL is built for plain x86-64, where Eigen aligns to 16 bytes; another value changes its types.
static_assert(EIGEN_MAX_ALIGN_BYTES == 16, "compile this file with EIGEN_MAX_ALIGN_BYTES=16");

namespace silt::adapters {

using namespace rigid;

namespace {

template <class T>
bool is(const ConvexShape& shape) {
  return std::holds_alternative<T>(shape);
}

fcl::Transform3d to_fcl(const Pose& pose, const Vec3& shift = Vec3::Zero()) {
  fcl::Transform3d t = fcl::Transform3d::Identity();
  t.linear() = pose.orientation.toRotationMatrix();
  t.translation() = pose.position + shift;
  return t;
}

/// Converts a polyhedron: FCL stores its faces in one list, each as the number of corners and the corners.
fcl::Convexd to_fcl(const PolyhedronMesh& mesh) {
  auto vertices = std::make_shared<std::vector<Vec3>>(mesh.vertices);
  auto faces = std::make_shared<std::vector<int>>();
  for (const auto& face : mesh.faces) {
    faces->push_back(int(face.corners.size()));
    faces->insert(faces->end(), face.corners.begin(), face.corners.end());
  }
  return fcl::Convexd(vertices, int(mesh.faces.size()), faces, true);
}

/// An FCL shape on the stack that refers to the shape; spheres and capsules have a fraction of their radius.
class FclShape {
 public:
  explicit FclShape(const ConvexShape& shape, double radius_share = 1, double lift = 0)
      : shape_(shape), radius_share_(radius_share), lift_(lift) {
    std::visit(
        [&]<class S>(const S& s) {
          if constexpr (requires { make(s); }) make(s);
        },
        shape);
  }
  const fcl::CollisionGeometryd* get() const {
    return std::visit(
        [](const auto& s) -> const fcl::CollisionGeometryd* {
          if constexpr (std::is_same_v<std::decay_t<decltype(s)>, std::monostate>)
            return nullptr;
          else
            return &s;
        },
        fcl_shape_);
  }
  const ConvexShape& shape() const { return shape_; }
  double radius_share() const { return radius_share_; }

 private:
  void make(const Sphere& s) { fcl_shape_.emplace<fcl::Sphered>(radius_share_ * s.radius); }
  void make(const Capsule& c) {
    fcl_shape_.emplace<fcl::Capsuled>(radius_share_ * c.radius, 2 * c.half_length);
  }
  void make(const Box& b) { fcl_shape_.emplace<fcl::Boxd>(2 * b.half_edges); }
  void make(const Cylinder& c) { fcl_shape_.emplace<fcl::Cylinderd>(c.radius, 2 * c.half_length); }
  void make(const Ellipsoid& e) { fcl_shape_.emplace<fcl::Ellipsoidd>(e.half_axes); }
  void make(const Polyhedron& q) { fcl_shape_.emplace<fcl::Convexd>(to_fcl(*q.mesh)); }
  void make(const HalfSpace& h) { fcl_shape_.emplace<fcl::Halfspaced>(h.normal, lift_); }

  const ConvexShape& shape_;
  double radius_share_, lift_;
  std::variant<std::monostate, fcl::Sphered, fcl::Capsuled, fcl::Boxd, fcl::Cylinderd, fcl::Ellipsoidd,
               fcl::Convexd, fcl::Halfspaced>
      fcl_shape_;
};

/// A shape unknown to FCL, and its partner, by their support functions.
class SupportShape {
 public:
  SupportShape(const FclShape& s, const Pose& pose)
      : core_(convex_core(s.shape(), pose)), radius_(s.radius_share() * core_.radius) {}

  static void support(const void* shape, const ccd_vec3_t* direction, ccd_vec3_t* point) {
    const auto& self = *static_cast<const SupportShape*>(shape);
    const Vec3 n = Vec3(direction->v[0], direction->v[1], direction->v[2]).normalized();
    put(self.core_.support(n) + self.radius_ * n, point);
  }
  static void centre(const void* shape, ccd_vec3_t* point) {
    put(static_cast<const SupportShape*>(shape)->core_.centre, point);
  }

 private:
  static void put(const Vec3& x, ccd_vec3_t* point) { ccdVec3Set(point, x[0], x[1], x[2]); }

  ConvexCore core_;
  double radius_;
};

double radius_of(const ConvexShape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere->radius;
  if (const auto* capsule = std::get_if<Capsule>(&shape)) return capsule->radius;
  return 0;
}

constexpr double gjk_tolerance = 1e-12;  // lattice units; the default of 1e-6 leaves errors of 3e-3

/// Finds the deepest overlap by MPR, as FCL does for its own shapes.
std::optional<Answer> deepest_overlap(SupportShape a, SupportShape b) {
  constexpr unsigned most_iterations = 500;
  constexpr double tolerance = 1e-6;
  double depth = 0;
  Vec3 normal = Vec3::Zero();
  const bool overlap = fcl::detail::GJKCollide<double>(&a, &SupportShape::support, &SupportShape::centre, &b,
                                                       &SupportShape::support, &SupportShape::centre,
                                                       most_iterations, tolerance, nullptr, &depth, &normal);
  return overlap ? std::optional(Answer{normal, -depth}) : std::nullopt;
}

/// FCL's normal points from the first shape to the second; its position (errors up to 10) is not used.
std::optional<Answer> deepest_overlap(const FclShape& a, const Pose& pose_a, const FclShape& b,
                                      const Pose& pose_b) {
  if (!a.get() || !b.get()) return deepest_overlap(SupportShape(a, pose_a), SupportShape(b, pose_b));
  constexpr int most_contacts = 8;
  fcl::CollisionRequestd request(most_contacts, true);
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::CollisionResultd result;
  fcl::collide(a.get(), to_fcl(pose_a), b.get(), to_fcl(pose_b), request, result);
  std::optional<Answer> deepest;
  for (std::size_t i = 0; i < result.numContacts(); ++i) {
    const fcl::Contactd& c = result.getContact(i);
    if (!deepest || -c.penetration_depth < deepest->gap) deepest = Answer{c.normal, -c.penetration_depth};
  }
  return deepest;
}

/// Returns nothing if the shapes overlap (FCL then gives -1 or coinciding points).
std::optional<Answer> distance(const FclShape& a, const Pose& pose_a, const FclShape& b, const Pose& pose_b,
                               const Vec3& shift_of_b) {
  double least = -1;
  Vec3 on_a = Vec3::Zero(), on_b = Vec3::Zero();
  if (a.get() && b.get()) {
    fcl::DistanceRequestd request(true, false, 0, 0, gjk_tolerance, fcl::GST_LIBCCD);
    fcl::DistanceResultd result;
    fcl::distance(a.get(), to_fcl(pose_a), b.get(), to_fcl(pose_b, shift_of_b), request, result);
    least = result.min_distance;
    on_a = result.nearest_points[0];
    on_b = result.nearest_points[1];
  } else {
    constexpr unsigned most_iterations = 1000;
    SupportShape first(a, pose_a), second(b, {pose_b.position + shift_of_b, pose_b.orientation});
    fcl::detail::GJKDistance<double>(&first, &SupportShape::support, &second, &SupportShape::support,
                                     most_iterations, gjk_tolerance, &least, &on_a, &on_b);
  }
  if (!(least > 0)) return {};
  const Vec3 between = on_b - on_a;
  const double length = between.norm();
  if (!(length > 0)) return {};
  return Answer{between / length, length};
}

class FclBackend : public EngineBackend {
 public:
  std::string_view name() const override { return "fcl"; }

 protected:
  int methods(const Query& q) const override {
    return is<HalfSpace>(q.b) || (is<Box>(q.a) && is<Box>(q.b)) ? 1 : 2;
  }

  /// Method 0: the distance of the cores (spheres and capsules of radius 0), which gives gaps, and overlaps
  /// up to the radii: closed forms, or for a capsule and a box GJK of two polytopes. (On the shapes
  /// themselves FCL is wrong: libccd's MPR for 61 of 100 pairs of capsules.) For overlapping cores collide:
  /// separating axes for two boxes (prefers a face to crossed edges up to 5 % less deep; the check detects
  /// it), MPR for a capsule's axis in a box (not always the least depth). Method 1: collide on the shapes
  /// themselves. With a cylinder, an ellipsoid or a polyhedron: the distance or, for cores that touch or
  /// overlap, that of cores moved apart along the normal of collide; method 1: along the line of centres.
  std::optional<Answer> ask(int method, const Query& q) override {
    if (is<HalfSpace>(q.b)) return plane(q);
    if (!is_swept_box(q.a) || !is_swept_box(q.b))
      return method == 0 ? near_or_deep(q) : moved_apart(q, centres(q));
    if (method == 1) return within(q, overlap(q));
    const bool boxes = is<Box>(q.a) && is<Box>(q.b);
    if (boxes)
      if (const auto deep = overlap(q); deep && deep->gap < -touching) return deep;
    if (const auto apart = core_distance(q)) return within(q, apart);
    const double radii = radius_of(q.a) + radius_of(q.b);
    auto cores = deepest_overlap(FclShape(q.a, 0), q.pose_a, FclShape(q.b, 0), q.pose_b);
    if (cores) cores->gap -= radii;
    return within(q, cores);
  }

  std::unique_ptr<MeshTree> make_tree(const SharedMesh& mesh) override { return make_fcl_tree(mesh); }

 private:
  /// Distance (lattice units) below which cores are moved apart along the normal, a difference of two points.
  static constexpr double touching = 1e-3;

  static std::optional<Answer> within(const Query& q, const std::optional<Answer>& answer) {
    return answer && answer->gap <= q.tolerance ? answer : std::nullopt;
  }

  static std::optional<Answer> overlap(const Query& q) {
    return deepest_overlap(FclShape(q.a), q.pose_a, FclShape(q.b), q.pose_b);
  }

  static std::optional<Answer> core_distance(const Query& q) {
    constexpr int rounds = 5;
    const FclShape a(q.a, 0), b(q.b, 0);
    std::optional<Answer> answer = distance(a, q.pose_a, b, q.pose_b, Vec3::Zero());
    if (!answer || answer->gap < touching) {
      if (!answer) answer = overlap(q);
      if (!answer || answer->gap < -touching - radius_of(q.a) - radius_of(q.b)) return {};
      for (int round = 0; round < rounds; ++round) {
        const Vec3 shift = 10 * touching * answer->normal;
        auto apart = distance(a, q.pose_a, b, q.pose_b, shift);
        if (!apart) return {};
        apart->gap -= apart->normal.dot(shift);
        const bool settled = (apart->normal - answer->normal).squaredNorm() < 1e-24;
        answer = apart;
        if (settled) break;
      }
    }
    answer->gap -= radius_of(q.a) + radius_of(q.b);
    return answer;
  }

  static bool is_swept_box(const ConvexShape& shape) {
    return is<Sphere>(shape) || is<Capsule>(shape) || is<Box>(shape);
  }

  static Vec3 centres(const Query& q) {
    const Vec3 d = q.pose_b.position - q.pose_a.position;
    const double distance = d.norm();
    return distance > 0 ? Vec3(d / distance) : Vec3(Vec3::UnitZ());
  }

  static std::optional<Answer> near_or_deep(const Query& q) {
    auto near = distance(FclShape(q.a, 0), q.pose_a, FclShape(q.b, 0), q.pose_b, Vec3::Zero());
    if (near && near->gap >= touching) {
      near->gap -= radius_of(q.a) + radius_of(q.b);
      return within(q, near);
    }
    const auto deep = overlap(q);
    return moved_apart(q, deep && deep->normal.squaredNorm() > 0.5 ? deep->normal : centres(q));
  }

  /// Computes the cores' distance with b moved along the last normal, until the normal is constant.
  static std::optional<Answer> moved_apart(const Query& q, const Vec3& normal) {
    constexpr int rounds = 8;
    const double radii = radius_of(q.a) + radius_of(q.b);
    const FclShape a(q.a, 0), b(q.b, 0);
    std::optional<Answer> answer;
    Vec3 n = normal;
    for (int round = 0; round < rounds; ++round) {
      const Vec3 shift = (10 * touching - support_gap(q, n) - radii) * n;
      answer = distance(a, q.pose_a, b, q.pose_b, shift);
      if (!answer) return {};
      answer->gap -= answer->normal.dot(shift) + radii;
      const bool settled = (answer->normal - n).squaredNorm() < 1e-12;
      n = answer->normal;
      if (settled) break;
    }
    return within(q, answer);
  }

  /// Raises the half-space by the tolerance, so that a gap becomes an overlap.
  static std::optional<Answer> plane(const Query& q) {
    const double lift = std::max(q.tolerance, 0.0);
    if (!FclShape(q.a).get()) {  // a shape unknown to FCL: the support point, as FCL does for its own
      const Vec3 n = -(q.pose_b.orientation * std::get<HalfSpace>(q.b).normal);
      const Vec3 lowest = q.pose_a.to_world(support(q.a, q.pose_a.orientation.conjugate() * n));
      return within(q, Answer{n, n.dot(q.pose_b.position - lowest)});
    }
    auto answer = deepest_overlap(FclShape(q.a), q.pose_a, FclShape(q.b, 1, lift), q.pose_b);
    if (answer) answer->gap += lift;
    return within(q, answer);
  }
};

}  // namespace

std::unique_ptr<CollisionBackend> make_fcl_backend() {
  return std::make_unique<FclBackend>();
}

}  // namespace silt::adapters
