#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

std::string_view shape_name(const Shape& shape) {
  return std::visit([]<class S>(const S&) { return S::name; }, shape);
}

bool contains(const Shape& shape, const Vec3& x_B) {
  return std::visit([&](const auto& s) { return solid::contains(s, x_B); }, shape);
}

double signed_distance(const Shape& shape, const Vec3& x_B) {
  return std::visit([&](const auto& s) { return s.signed_distance(x_B); }, shape);
}

BoundingBox bounding_box(const Shape& shape, const Pose& pose) {
  return std::visit([&](const auto& s) { return s.bounding_box(pose); }, shape);
}

double bounding_radius(const Shape& shape) {
  if (std::holds_alternative<Tube>(shape)) return std::numeric_limits<double>::infinity();
  if (const auto* mesh = std::get_if<Mesh>(&shape)) return mesh->bounding_radius();
  double radius = 0;
  for (const Part& part : convex_parts(shape)) radius = std::max(radius, reach(part));
  return radius;
}

MassProperties mass_properties(const Shape& shape) {
  return std::visit([](const auto& s) { return s.mass_properties(); }, shape);
}

double least_width(const Shape& shape) {
  return std::visit([](const auto& s) { return s.least_width(); }, shape);
}

Shape recentred(const Shape& shape, const Vec3& centre) {
  return std::visit([&](const auto& s) -> Shape { return solid::recentred(s, centre); }, shape);
}

namespace {

template <ConvexSolid S>
S scaled_solid(S solid, double factor) {
  std::apply([&](const auto&... field) { ((solid.*field.member *= factor), ...); }, S::fields);
  return solid;
}
Polyhedron scaled_solid(const Polyhedron& solid, double factor) {
  return {scaled(*solid.mesh, factor)};
}
Mesh scaled_solid(const Mesh& mesh, double factor) {
  return {std::make_shared<const TriangleMesh>(mesh.surface->scaled(factor)), mesh.hollow};
}
Compound scaled_solid(Compound compound, double factor) {
  for (Part& part : compound.parts) {
    part.shape =
        std::visit([&](const auto& s) -> ConvexShape { return scaled_solid(s, factor); }, part.shape);
    part.pose.position *= factor;
  }
  return compound;
}
Tube scaled_solid(const Tube& tube, double) {
  return tube;
}

}  // namespace

Shape scaled(const Shape& shape, double factor) {
  return std::visit([&](const auto& s) -> Shape { return scaled_solid(s, factor); }, shape);
}

bool is_sphere(const Shape& shape) {
  return std::holds_alternative<Sphere>(shape);
}

bool is_infinite(const Shape& shape) {
  const auto* const mesh = std::get_if<Mesh>(&shape);
  return mesh ? mesh->hollow : std::holds_alternative<Tube>(shape);
}

std::vector<Part> convex_parts(const Shape& shape) {
  return std::visit(
      []<class S>(const S& s) -> std::vector<Part> {
        if constexpr (ConvexSolid<S>)
          return {{s, Pose{}}};
        else if constexpr (std::is_same_v<S, Compound>)
          return s.parts;
        else
          return {};
      },
      shape);
}

std::vector<InnerBall> inner_balls(const Shape& shape) {
  std::vector<InnerBall> balls;
  if (const auto* mesh = std::get_if<Mesh>(&shape))
    for (const Vec3& corner : mesh->surface->vertices()) balls.push_back({corner, 0});
  for (const Part& part : convex_parts(shape)) {
    const std::size_t first = balls.size();
    std::visit([&](const auto& convex) { convex.add_inner_balls(balls); }, part.shape);
    for (std::size_t i = first; i < balls.size(); ++i) balls[i].centre = part.pose.to_world(balls[i].centre);
  }
  return balls;
}

ShapeList::ShapeList() = default;
ShapeList::ShapeList(std::initializer_list<Shape> shapes) : vector(shapes) {}
ShapeList::ShapeList(const ShapeList&) = default;
ShapeList::ShapeList(ShapeList&&) noexcept = default;
ShapeList& ShapeList::operator=(const ShapeList&) = default;
ShapeList& ShapeList::operator=(ShapeList&&) noexcept = default;
ShapeList::~ShapeList() = default;

Vec3 support(const ConvexShape& shape, const Vec3& direction) {
  const double length = direction.norm();
  const Vec3 unit = length > 0 ? Vec3(direction / length) : Vec3(Vec3::UnitX());
  return std::visit([&](const auto& s) -> Vec3 { return s.support(unit); }, shape);
}

std::optional<LineInterval> line_interval(const ConvexShape& shape, const Vec3& origin,
                                          const Vec3& direction) {
  return std::visit([&](const auto& s) { return s.line_interval(origin, direction); }, shape);
}

std::optional<Mat3> curvature(const ConvexShape& shape, const Vec3& x, const Vec3& n) {
  return std::visit([&](const auto& s) -> std::optional<Mat3> { return s.curvature(x, n); }, shape);
}

bool is_smooth(const ConvexShape& shape) {
  return std::visit(
      []<class S>(const S&) {
        return !requires {
          &S::kinks;
        };
      },
      shape);
}

}  // namespace silt::rigid
