#include "adapters/automatic/collision_factory.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "adapters/common/engine_backend.hpp"
#include "rigid/collision/collision_backend.hpp"
#include "rigid/collision/uniform_grid.hpp"

namespace silt::adapters {

using namespace rigid;

namespace {

// ---- "auto": the best method for each pair ----

/// Returns whether the deepest point from index `first` on lies between the shapes' supporting planes.
bool supported(const Query& q, const std::vector<ContactPoint>& points, std::size_t first) {
  const auto deepest =
      std::min_element(points.begin() + first, points.end(),
                       [](const ContactPoint& p, const ContactPoint& r) { return p.gap < r.gap; });
  const double size =
      (q.pose_b.position - q.pose_a.position).norm() + (deepest->on_a - q.pose_a.position).norm();
  return std::abs(support_gap(q, deepest->normal) - deepest->gap) <= answer_tolerance * size;
}

/// Returns whether the answer needs a search: not half-spaces, nor spheres with spheres, capsules or boxes.
bool needs_search(const ConvexShape& a, const ConvexShape& b) {
  if (std::holds_alternative<Sphere>(a) && std::holds_alternative<Sphere>(b)) return false;
  if (std::holds_alternative<HalfSpace>(b)) return false;
  const auto is_box = [](const ConvexShape& s) { return convex_core(s, Pose{}).is_box; };
  const bool with_sphere = std::holds_alternative<Sphere>(a) || std::holds_alternative<Sphere>(b);
  return !(with_sphere && is_box(a) && is_box(b));
}

/// The analytic backend is the most exact (1e-12 of a cell) and the fastest for every pair (table in
/// adapters/README.md), so it answers. An answer that needs a search is checked against the supporting
/// planes; if it fails the engines answer in turn, which counts as a fallback. A shape that an engine handles
/// better would go to that engine here.
class AutomaticBackend : public AnalyticBackend {
 public:
  explicit AutomaticBackend(std::vector<std::unique_ptr<CollisionBackend>> engines)
      : engines_(std::move(engines)) {
    if (engines_.empty()) engines_.push_back(std::make_unique<AnalyticBackend>());  // for its trees
  }
  std::string_view name() const override { return "auto"; }
  void collide(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b, const Pose& pose_b,
               double tolerance, std::vector<ContactPoint>& out) override {
    const std::size_t first = out.size();
    AnalyticBackend::collide(a, pose_a, b, pose_b, tolerance, out);
    if (out.size() == first || !needs_search(a, b)) return;
    const Query q{a, b, pose_a, pose_b, tolerance};
    for (const auto& engine : engines_) {
      if (supported(q, out, first)) return;
      ++counters_.fallbacks;
      out.resize(first);
      engine->collide(a, pose_a, b, pose_b, tolerance, out);
      if (out.size() == first) return;
    }
  }

 protected:
  /// Triangles are found by the tree of the first engine, Bullet's, which is the fastest for small bodies.
  bool finds_triangles() const override { return true; }
  void find_triangles(const SharedMesh& mesh, const BoundingBox& near,
                      std::vector<std::uint32_t>& out) override {
    engines_[0]->triangles_near(mesh, near, out);
  }
  void find_triangle_pairs(const SharedMesh& a, const Pose& pose_a, const SharedMesh& b, const Pose& pose_b,
                           double margin, std::vector<TrianglePair>& out) override {
    engines_[0]->triangle_pairs_near(a, pose_a, b, pose_b, margin, out);
  }

 private:
  std::vector<std::unique_ptr<CollisionBackend>> engines_;  // never empty
};

// ---- by name ----

template <class Made>
using Maker = std::unique_ptr<Made> (*)();
using MakeBackend = Maker<CollisionBackend>;
using MakeBroadPhase = Maker<BroadPhase>;

#ifndef SILT_WITH_BULLET
constexpr MakeBackend make_bullet_backend = nullptr;
constexpr MakeBroadPhase make_bullet_broad_phase = nullptr;
#endif
#ifndef SILT_WITH_FCL
constexpr MakeBackend make_fcl_backend = nullptr;
constexpr MakeBroadPhase make_fcl_broad_phase = nullptr;
#endif

std::unique_ptr<CollisionBackend> make_automatic_backend() {
  std::vector<std::unique_ptr<CollisionBackend>> engines;
  for (const MakeBackend make : {MakeBackend(make_bullet_backend), MakeBackend(make_fcl_backend)})
    if (make) engines.push_back(make());
  return std::make_unique<AutomaticBackend>(std::move(engines));
}

template <class Made>
struct Entry {
  std::string_view name;
  Maker<Made> make;  // nullptr: left out of this build
};

/// The backends. The conformance suite tests every one by its name.
constexpr Entry<CollisionBackend> backends[] = {
    {"auto", make_automatic_backend},
    {"analytic", [] { return std::unique_ptr<CollisionBackend>(new AnalyticBackend); }},
    {"bullet", make_bullet_backend},
    {"fcl", make_fcl_backend},
};

/// The broad phases. The tests of rigid/collision/broad_phase run on every one by its name.
constexpr Entry<BroadPhase> broad_phases[] = {
    {"grid", [] { return std::unique_ptr<BroadPhase>(new UniformGrid); }},
    {"bullet", make_bullet_broad_phase},
    {"fcl", make_fcl_broad_phase},
};

template <class Made, std::size_t count>
const Entry<Made>* entry_of(const Entry<Made> (&entries)[count], std::string_view name) {
  for (const Entry<Made>& entry : entries)
    if (entry.name == name) return &entry;
  return nullptr;
}

template <class Made, std::size_t count>
void add_names(const Entry<Made> (&entries)[count], std::vector<std::string_view>& names) {
  for (const Entry<Made>& entry : entries)
    if (entry.make) names.push_back(entry.name);
}

/// `what` begins the message for an unknown name.
template <class Made>
std::unique_ptr<Made> made(const Entry<Made>* entry, std::string_view name, const char* what,
                           const std::vector<std::string_view>& known) {
  if (entry && entry->make) return entry->make();
  if (entry) throw std::invalid_argument(missing_from_build(name));
  std::string list;
  for (const std::string_view n : known) list += (list.empty() ? "" : ", ") + std::string(n);
  throw std::invalid_argument("unknown " + std::string(what) + " \"" + std::string(name) +
                              "\"; known: " + list);
}

}  // namespace

std::vector<std::string_view> backend_names() {
  std::vector<std::string_view> names;
  add_names(backends, names);
  return names;
}

std::vector<std::string_view> broad_phase_names() {
  std::vector<std::string_view> names = {"auto"};
  add_names(broad_phases, names);
  return names;
}

std::string missing_from_build(std::string_view name) {
  const auto* entry = entry_of(backends, name);
  if (!entry || entry->make) return "";
  std::string option(name);
  for (char& c : option) c = char(std::toupper(static_cast<unsigned char>(c)));
  return "this build of silt has no " + option + ": use \"auto\", or configure it with -D SILT_WITH_" +
         option + "=ON";
}

std::unique_ptr<CollisionBackend> make_backend(std::string_view name) {
  return made(entry_of(backends, name), name, "collision backend", backend_names());
}

std::unique_ptr<BroadPhase> make_broad_phase(std::string_view name, std::string_view backend) {
  if (name == "auto") name = entry_of(broad_phases, backend) ? backend : "grid";
  return made(entry_of(broad_phases, name), name, "broad phase", broad_phase_names());
}

}  // namespace silt::adapters
