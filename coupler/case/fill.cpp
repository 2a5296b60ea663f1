#include "coupler/case/fill.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "coupler/case/case.hpp"
#include "coupler/case/neighbour_grid.hpp"
#include "coupler/case/overlap.hpp"
#include "rigid/collision/tube_contacts.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

using rigid::Quat;
using rigid::Vec3;

// draws for one body before the box counts as full
constexpr int most_draws = 20000;

// The standard fixes the numbers of this engine, but not those of its distributions: so the mapping is our
// own.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream) : engine_(seed + 0x9e3779b97f4a7c15u * (stream + 1)) {}
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  // [0, 1)
  double between(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform over all orientations (Shoemake 1992, Graphics Gems III, p. 124).
  Quat orientation() {
    const double u = uniform(), a = 2 * std::numbers::pi * uniform(), b = 2 * std::numbers::pi * uniform();
    const double r = std::sqrt(1 - u), s = std::sqrt(u);
    return Quat(s * std::cos(b), r * std::sin(a), r * std::cos(a), s * std::sin(b)).normalized();
  }

 private:
  std::mt19937_64 engine_;
};

struct Ball {  // a filled body's bounding sphere
  Vec3 centre;
  double radius;
};

struct PlacedTube {
  rigid::Tube tube;
  rigid::Pose pose;
};

struct ShapeFrame {
  Vec3 centre_of_mass = Vec3::Zero();
  double radius = 0;  // of the bounding sphere about it
};

ShapeFrame frame_of(const rigid::Shape& shape) {
  const Vec3 centre = rigid::mass_properties(shape).centre;
  return {centre, rigid::bounding_radius(rigid::recentred(shape, centre))};
}

class Filler {
 public:
  explicit Filler(const Case& scene)
      : scene_(scene), extent_(extent_of(scene)), frames_(frames_of(scene)), grid_(extent_, bucket_edge()) {
    for (const CurvedWall& wall : scene.walls)
      walls_.push_back({{wall.tube.radius}, rigid::pose_of(wall.tube)});
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      const BodySpec& body = scene.bodies[i];
      const auto box = rigid::bounding_box(scene.shapes[body.shape], body.pose);
      grid_.insert(static_cast<int>(i), box.lower, box.upper);
    }
  }

  /// The largest bodies first: small ones still find room between them.
  std::vector<std::size_t> order() const {
    std::vector<std::size_t> order(scene_.fills.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return frames_[scene_.fills[a].shape].radius > frames_[scene_.fills[b].shape].radius;
    });
    return order;
  }

  std::vector<BodySpec> place(std::size_t index) {
    const FillSpec& fill = scene_.fills[index];
    std::vector<BodySpec> placed;
    const ShapeFrame frame = frames_[fill.shape];
    const auto [lower, upper] = room(fill, index, frame.radius);
    Random random(fill.seed, index);
    BodySpec body;
    body.shape = fill.shape;
    body.material = fill.material;
    body.kind = fill.kind;
    body.density = fill.density;
    for (int n = 0; n < fill.count; ++n) {
      const auto centre = free_place(random, lower, upper, frame.radius, fill.gap);
      if (!centre) refuse(fill, index, frame.radius, n);
      if (fill.random_orientation) body.pose.orientation = random.orientation();
      body.pose.position = *centre - body.pose.orientation * frame.centre_of_mass;
      // The shape's origin may lie across a periodic border: no fault, but not canonical.
      for (int d = 0; d < 3; ++d)
        if (extent_.periodic[d])
          body.pose.position[d] -= extent_.size[d] * std::floor(body.pose.position[d] / extent_.size[d]);
      insert(*centre, frame.radius);
      placed.push_back(body);
    }
    return placed;
  }

 private:
  // Returns the frames of the shapes that fills use.
  static std::vector<ShapeFrame> frames_of(const Case& scene) {
    std::vector<ShapeFrame> frames(scene.shapes.size());
    for (const FillSpec& fill : scene.fills)
      if (frames[fill.shape].radius == 0) frames[fill.shape] = frame_of(scene.shapes[fill.shape]);
    return frames;
  }

  double bucket_edge() const {
    double edge = 1;
    for (const FillSpec& fill : scene_.fills)
      edge = std::max(edge, 2 * frames_[fill.shape].radius + fill.gap);
    return edge;
  }

  // Where a centre may be: the fill's box less a radius, and less the gap too where a side of the box is a
  // wall.
  std::pair<Vec3, Vec3> room(const FillSpec& fill, std::size_t index, double radius) const {
    Vec3 lower = fill.lower, upper = fill.upper;
    for (int d = 0; d < 3; ++d) {
      const double length = extent_.size[d];
      const bool whole = lower[d] <= 0 && upper[d] >= length;
      if (extent_.periodic[d] && 2 * radius + fill.gap > length)
        refuse_shape(index, d, radius, fmt::format("the periodic axis is {} cells long", shown(length)));
      if (extent_.periodic[d] && whole) {
        lower[d] = 0;
        upper[d] = length;
        continue;
      }
      lower[d] = extent_.periodic[d] ? lower[d] + radius : std::max(lower[d] + radius, radius + fill.gap);
      upper[d] =
          extent_.periodic[d] ? upper[d] - radius : std::min(upper[d] - radius, length - radius - fill.gap);
      if (lower[d] > upper[d])
        refuse_shape(index, d, radius,
                     fmt::format("the box less the gaps to its walls is {} cells wide",
                                 shown(std::max(0., upper[d] - lower[d] + 2 * radius))));
    }
    return {lower, upper};
  }

  std::optional<Vec3> free_place(Random& random, const Vec3& lower, const Vec3& upper, double radius,
                                 double gap) {
    for (int draw = 0; draw < most_draws; ++draw) {
      Vec3 centre;
      for (int d = 0; d < 3; ++d) centre[d] = random.between(lower[d], upper[d]);
      if (is_free(centre, radius, gap)) return centre;
    }
    return {};
  }

  bool clear_of_walls(const Vec3& centre, double distance) const {
    return std::all_of(walls_.begin(), walls_.end(), [&](const PlacedTube& wall) {
      return rigid::gap_in_tube(rigid::Sphere{distance}, {centre, Quat::Identity()}, wall.tube, wall.pose) >=
             0;
    });
  }

  bool is_free(const Vec3& centre, double radius, double gap) const {
    if (!clear_of_walls(centre, radius + gap)) return false;
    const int given = static_cast<int>(scene_.bodies.size());
    const Vec3 reach = Vec3::Constant(radius + gap);
    bool is_free = true;
    grid_.visit(centre - reach, centre + reach, [&](int i) {
      if (i < given)
        is_free = distance_to(scene_.shapes[scene_.bodies[i].shape], scene_.bodies[i].pose, centre,
                              extent_) >= radius + gap;
      else
        is_free = nearest_image(balls_[i - given].centre - centre, extent_).norm() >=
                  balls_[i - given].radius + radius + gap;
      return is_free;
    });
    return is_free;
  }

  void insert(const Vec3& centre, double radius) {
    const Vec3 reach = Vec3::Constant(radius);
    grid_.insert(static_cast<int>(scene_.bodies.size() + balls_.size()), centre - reach, centre + reach);
    balls_.push_back({centre, radius});
  }

  std::string shown_radius(double radius) const {
    return shown(scene_.units.physical(2 * radius, dimension::length));
  }

  [[noreturn]] void refuse_shape(std::size_t index, int axis, double radius, const std::string& why) const {
    throw CaseError(
        scene_.place(fmt::format("fill[{}].box", index)),
        fmt::format("fill[{}]: bodies of {} cells ({}) do not fit along {}: {}; enlarge it or make the "
                    "bodies smaller",
                    index, shown(2 * radius), shown_radius(radius), "xyz"[axis], why));
  }

  [[noreturn]] void refuse(const FillSpec& fill, std::size_t index, double radius, int placed) const {
    const double ball = 4. / 3 * std::numbers::pi * std::pow(radius + fill.gap / 2, 3);
    const double share = fill.count * ball / (fill.upper - fill.lower).prod();
    throw CaseError(
        scene_.place(fmt::format("fill[{}].count", index)),
        fmt::format("fill[{}].count is {}, but only {} bodies fitted: with their gaps the bounding spheres "
                    "would take {:.0f} % of the box, and random places run out near 35 % of what other "
                    "bodies leave; lower count or gap, enlarge box or domain, or make the bodies smaller",
                    index, fill.count, placed, 100 * share));
  }

  const Case& scene_;
  rigid::Extent extent_;
  std::vector<ShapeFrame> frames_;  // by shape
  std::vector<PlacedTube> walls_;
  NeighbourGrid grid_;  // of the given bodies, then of the balls
  std::vector<Ball> balls_;
};

}  // namespace

rigid::Extent extent_of(const Case& scene) {
  rigid::Extent extent;
  for (int d = 0; d < 3; ++d) {
    extent.size[d] = scene.cells[d];
    extent.periodic[d] = scene.periodic(d);
  }
  return extent;
}

std::vector<BodySpec> place_bodies(const Case& scene) {
  Filler filler(scene);
  std::vector<std::vector<BodySpec>> placed(scene.fills.size());
  for (const std::size_t i : filler.order()) placed[i] = filler.place(i);
  std::vector<BodySpec> bodies = scene.bodies;
  for (const auto& fill : placed) bodies.insert(bodies.end(), fill.begin(), fill.end());
  return bodies;
}

}  // namespace silt::coupler
