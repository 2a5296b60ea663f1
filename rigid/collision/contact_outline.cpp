#include "rigid/collision/contact_outline.hpp"

#include <cmath>
#include <numbers>

namespace silt::rigid {

namespace {

using Corner = ContactOutline::Corner;

// Codes of a cylinder: 0 unused, then the rim points of either end, the chords between them, the ends, the
// side, and the points where an end's rim, or an end of a line of the side, is furthest along the normal.
constexpr std::uint32_t first_rim = 1, first_chord = first_rim + 2 * rim_points,
                        first_end = first_chord + 2 * rim_points, side_code = first_end + 2,
                        first_lowest = side_code + 1;

void reset(ContactOutline& out) {
  out.corners.clear();
  out.disc_radius = 0;
}

void set_point(const Vec3& x, std::uint32_t code, ContactOutline& out) {
  reset(out);
  out.corners.push_back({x, code, code});
  out.code = code;
}

/// The corners of a box's face, edge or vertex: the axes with sign 0 are free.
void box_outline(const ConvexCore& box, const Feature& f, ContactOutline& out) {
  reset(out);
  out.code = f.code();
  int free_axes[3], count = 0;
  for (int k = 0; k < 3; ++k)
    if (!f.sign[k] && box.half[k] > 0)
      free_axes[count++] = k;
    else if (f.sign[k])
      out.normal = f.sign[k] * box.axes.col(k);
  const int corners = count == 0 ? 1 : count == 1 ? 2 : 4;
  constexpr std::int8_t si[] = {-1, 1, 1, -1}, sj[] = {-1, -1, 1, 1};
  for (int c = 0; c < corners; ++c) {
    Feature corner = f, edge = f;
    if (count > 0) corner.sign[free_axes[0]] = si[c];
    if (count > 1) {
      corner.sign[free_axes[1]] = sj[c];
      if (c % 2 == 0)
        edge.sign[free_axes[1]] = sj[c];
      else
        edge.sign[free_axes[0]] = si[c];
    }
    const Vec3 signs(corner.sign[0], corner.sign[1], corner.sign[2]);
    out.corners.push_back({box.to_world(box.half.cwiseProduct(signs)), corner.code(), edge.code()});
  }
}

void touching_box(const ConvexCore& box, const Vec3& d, double slack, ContactOutline& out) {
  Feature f;
  for (int k = 0; k < 3; ++k)
    if (box.half[k] > 0 && 2 * box.half[k] * std::abs(d[k]) > slack) f.sign[k] = d[k] < 0 ? -1 : 1;
  box_outline(box, f, out);
}

void facing_box(const ConvexCore& box, const Vec3& d, ContactOutline& out) {
  Feature f;
  if (!box.is_point() && !box.is_segment()) {
    int k = 0;
    d.cwiseAbs().maxCoeff(&k);
    f.sign[k] = d[k] < 0 ? -1 : 1;
  }
  box_outline(box, f, out);
}

void line_outline(const ConvexCore& cylinder, const Vec3& n, ContactOutline& out) {
  reset(out);
  out.code = side_code;
  for (const int side : {-1, 1}) {
    Corner end = lowest_rim_point(cylinder, side, n);
    end.edge_code = side_code;
    out.corners.push_back(end);
  }
}

void face_outline(const ConvexCore& core, int face, ContactOutline& out) {
  reset(out);
  const auto& mesh = *core.mesh;
  const auto& f = mesh.faces[face];
  out.code = 1 + mesh.vertices.size() + mesh.edges.size() + face;
  out.normal = core.axes * f.normal;
  for (std::size_t c = 0; c < f.corners.size(); ++c)
    out.corners.push_back({core.to_world(mesh.vertices[f.corners[c]]), vertex_code(f.corners[c]), 0});
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto& edge = mesh.edges[e];
    if (edge.faces[0] != face && edge.faces[1] != face) continue;
    for (std::size_t c = 0; c < f.corners.size(); ++c) {
      const int from = f.corners[c], to = f.corners[(c + 1) % f.corners.size()];
      if ((edge.corners[0] == from && edge.corners[1] == to) ||
          (edge.corners[0] == to && edge.corners[1] == from))
        out.corners[c].edge_code = 1 + mesh.vertices.size() + e;
    }
  }
}

int face_towards(const PolyhedronMesh& mesh, const Vec3& d) {
  int best = 0;
  for (std::size_t f = 1; f < mesh.faces.size(); ++f)
    if (mesh.faces[f].normal.dot(d) > mesh.faces[best].normal.dot(d)) best = static_cast<int>(f);
  return best;
}

void touching_polyhedron(const ConvexCore& core, const Vec3& d, double slack, ContactOutline& out) {
  const auto& mesh = *core.mesh;
  double furthest = -std::numeric_limits<double>::infinity();
  for (const Vec3& v : mesh.vertices) furthest = std::max(furthest, v.dot(d));
  int touching[2], count = 0;
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    if (mesh.vertices[v].dot(d) < furthest - slack) continue;
    if (count < 2) touching[count] = v;
    ++count;
  }
  if (count > 2) return face_outline(core, face_towards(mesh, d), out);
  set_point(core.to_world(mesh.vertices[touching[0]]), vertex_code(touching[0]), out);
  if (count < 2) return;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto& c = mesh.edges[e].corners;
    if (std::min(c[0], c[1]) == touching[0] && std::max(c[0], c[1]) == touching[1])
      out.code = 1 + mesh.vertices.size() + e;
  }
  out.corners[0].edge_code = out.code;
  out.corners.push_back({core.to_world(mesh.vertices[touching[1]]), vertex_code(touching[1]), out.code});
}

void touching_cylinder(const ConvexCore& core, const Vec3& n, const Vec3& d, double slack,
                       ContactOutline& out) {
  const int side = d.z() < 0 ? -1 : 1;
  if (2 * core.half.x() * std::hypot(d.x(), d.y()) <= slack) return end_outline(core, side, out);
  if (2 * core.half.z() * std::abs(d.z()) <= slack) return line_outline(core, n, out);
  const Corner lowest = lowest_rim_point(core, side, n);
  set_point(lowest.x, lowest.code, out);
}

void facing_cylinder(const ConvexCore& core, const Vec3& n, const Vec3& d, ContactOutline& out) {
  if (const int side = facing_end(core, n)) return end_outline(core, side, out);
  if (std::abs(d.z()) <= std::numbers::sqrt2 / 2) return line_outline(core, n, out);
  const Corner lowest = lowest_rim_point(core, d.z() < 0 ? -1 : 1, n);
  set_point(lowest.x, lowest.code, out);
}

}  // namespace

bool has_codes(const ConvexShape& shape) {
  const auto* polyhedron = std::get_if<Polyhedron>(&shape);
  if (!polyhedron) return true;
  const auto& mesh = *polyhedron->mesh;
  return 1 + mesh.vertices.size() + mesh.edges.size() + mesh.faces.size() <= 1 << 16;
}

int facing_end(const ConvexCore& cylinder, const Vec3& n) {
  const Vec3 d = cylinder.direction_B(n);
  return std::hypot(d.x(), d.y()) > flat_end_sine ? 0 : d.z() < 0 ? -1 : 1;
}

Corner lowest_rim_point(const ConvexCore& cylinder, int side, const Vec3& n) {
  const Vec3 d = cylinder.direction_B(n);
  const double across = std::hypot(d.x(), d.y()), scale = across > 0 ? cylinder.half.x() / across : 0;
  const std::uint32_t code = first_lowest + (side > 0);
  return {cylinder.to_world({scale * d.x(), scale * d.y(), side * cylinder.half.z()}), code, code};
}

void end_outline(const ConvexCore& cylinder, int side, ContactOutline& out) {
  reset(out);
  const int upper = side > 0;
  out.code = first_end + upper;
  out.normal = side * cylinder.axes.col(2);
  out.centre = cylinder.to_world({0, 0, side * cylinder.half.z()});
  out.disc_radius = cylinder.half.x();
  for (int k = 0; k < rim_points; ++k) {
    const double angle = 2 * std::numbers::pi * k / rim_points;
    const Vec3 x = out.centre + out.disc_radius * (std::cos(angle) * cylinder.axes.col(0) +
                                                   std::sin(angle) * cylinder.axes.col(1));
    const std::uint32_t which = upper * rim_points + k;
    out.corners.push_back({x, first_rim + which, first_chord + which});
  }
}

void touching_outline(const ConvexCore& core, const Vec3& n, double slack, ContactOutline& out) {
  const Vec3 d = core.direction_B(n);
  switch (core.kind) {
    case ConvexCore::Kind::box:
      return touching_box(core, d, slack, out);
    case ConvexCore::Kind::cylinder:
      return touching_cylinder(core, n, d, slack, out);
    case ConvexCore::Kind::ellipsoid:
      return set_point(core.support(n), 0, out);
    default:
      return touching_polyhedron(core, d, slack, out);
  }
}

void facing_outline(const ConvexCore& core, const Vec3& n, ContactOutline& out) {
  const Vec3 d = core.direction_B(n);
  switch (core.kind) {
    case ConvexCore::Kind::box:
      return facing_box(core, d, out);
    case ConvexCore::Kind::cylinder:
      return facing_cylinder(core, n, d, out);
    case ConvexCore::Kind::ellipsoid:
      return set_point(core.support(n), 0, out);
    default:
      return face_outline(core, face_towards(*core.mesh, d), out);
  }
}

}  // namespace silt::rigid
