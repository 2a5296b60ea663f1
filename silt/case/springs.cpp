// [[springs]], with their checks.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "rigid/shapes/shape.hpp"
#include "silt/case/case_sections.hpp"

namespace silt {
namespace {

using rigid::Vec3;

constexpr std::tuple spring_keys{
    HandKey{"body", "string", "", required, "name of a [[bodies]] entry of one body"},
    HandKey{"to", "string", "", "the domain", "the same, of the other body"},
    HandKey{"ends", "[[x, y, z], [x, y, z]]", "m", "centres of mass",
            "its ends at the start: a point fixed to body, and one fixed to the other body or to the domain"},
    Key{"length", &coupler::SpringSpec::length, Number{dimension::length, range::at_least(0)},
        "its length at rest; 0: it holds the two points together in every direction", "of the start"},
    Key{"stiffness", &coupler::SpringSpec::stiffness, Number{{0, -2, 1}, range::at_least(0), "N/m"},
        "its force per elongation", required},
    Key{"damping", &coupler::SpringSpec::damping, Number{{0, -1, 1}, range::at_least(0), "N s/m"},
        "the force of its damper per rate of elongation"}};

/// Returns the only body of a name; null (reported) if a file, a fill or several entries have the name.
const BodySpec* read_body(TableReader& table, const char* key, const Case& setup) {
  const auto kind = read_name(table, key, setup.kind_names, "name of [[bodies]]");
  if (!kind || *kind < 0) return nullptr;
  const BodySpec* found = nullptr;
  bool one = true;
  for (const BodySpec& body : setup.bodies) {
    if (body.kind != *kind) continue;
    one &= !found;
    found = &body;
  }
  for (const FiledBodies& file : setup.filed) one &= file.alike.kind != *kind;
  for (const FillSpec& fill : setup.fills) one &= fill.kind != *kind;
  if (found && one) return found;
  table.fail(
      key, "{}: '{}' names several bodies, or those of a file or a fill; give the one body a name of its own",
      table.path(key), setup.kind_names[*kind]);
  return nullptr;
}

rigid::BodyId id_of(const BodySpec* body, const Case& setup) {
  return body ? static_cast<rigid::BodyId>(body - setup.bodies.data()) + 1 : 0;
}

/// Returns the largest velocity per impulse of a point of a body.
double compliance_of(const BodySpec& body, const Vec3& arm, const Case& setup) {
  if (body.motion != rigid::Motion::free) return 0;
  const rigid::MassProperties p = rigid::mass_properties(setup.shapes[body.shape]);
  const double least = Eigen::SelfAdjointEigenSolver<rigid::Mat3>(p.inertia).eigenvalues()[0];
  return (1 / p.volume + arm.squaredNorm() / least) / body.density;
}

void read_ends(TableReader& table, coupler::SpringSpec& spring, const BodySpec& body, const BodySpec* to,
               const Case& setup) {
  const rigid::Extent extent = extent_of(setup);
  std::vector<Vec3> ends{body.pose.position, to ? to->pose.position : body.pose.position};
  if (table.has("ends")) {
    ends = table.points("ends", 2, 2, "two points, [[x, y, z], [x, y, z]]");
    if (ends.empty()) return;
  } else if (!to) {
    table.need("ends", "a point of the body, and the one of the domain that it is tied to");
  }
  const auto arm = [&](const BodySpec& b, const Vec3& end) -> Vec3 {
    return b.pose.orientation.conjugate() * coupler::nearest_image(end - b.pose.position, extent);
  };
  spring.arm = arm(body, ends[0]);
  spring.to_arm = to ? arm(*to, ends[1]) : ends[1];
  const double length_at_start = coupler::nearest_image(ends[1] - ends[0], extent).norm();
  if (!table.has("length")) spring.length = length_at_start;
  if (spring.stiffness == 0 && spring.length > 0 && length_at_start > 0)
    table.idle("length", "without stiffness there is nothing that a length pulls at; remove it");
  spring.compliance[0] = compliance_of(body, spring.arm, setup);
  if (to) spring.compliance[1] = compliance_of(*to, spring.to_arm, setup);
}

}  // namespace

std::vector<KeySection> spring_sections() {
  return {section_of("springs", spring_keys)};
}

void read_springs(TableReader& root, Case& setup) {
  for (TableReader& table : root.tables("springs")) {
    coupler::SpringSpec spring;
    read_keys(table, spring, spring_keys);
    const BodySpec *const body = read_body(table, "body", setup), *const to =
                                                                      table.has("to")
                                                                          ? read_body(table, "to", setup)
                                                                          : nullptr;
    if (!body || (table.has("to") && !to)) continue;
    spring.body = id_of(body, setup), spring.to = id_of(to, setup);
    if (body == to) table.fail("to", "{} is the body itself; name another one", table.path("to"));
    read_ends(table, spring, *body, to, setup);
    if (spring.stiffness == 0 && spring.damping == 0)
      table.warn("stiffness", "{} has no effect: stiffness and damping are 0; give one of them",
                 table.path());
    setup.springs.push_back(spring);
  }
}

namespace {

constexpr double most_square = 0.4;  // of the frequency of a spring, to resolve its oscillation

void find_fault_of(const coupler::SpringSpec& spring, const std::string& entry, const Units& units,
                   Diagnostics& findings) {
  const double compliance = spring.compliance[0] + spring.compliance[1];
  const double square = spring.stiffness * compliance;
  if (compliance == 0)
    findings.error(entry + ".body", "{}: neither of its ends can move; one must be of a free body", entry);
  if (square > most_square)
    findings.error(entry + ".stiffness",
                   "{}.stiffness makes its bodies oscillate in {} steps; at least {} are needed: lower it to "
                   "{} or shorten the time step",
                   entry, shown(2 * std::numbers::pi / std::sqrt(square)),
                   shown(rounded_up(2 * std::numbers::pi / std::sqrt(most_square))),
                   shown(rounded_down(units.physical(most_square / compliance, {0, -2, 1}))));
}

/// Returns upper bounds, by body id, of squared frequencies from all springs of a body: the sum of its row in
/// the matrix of the springs, scaled by roots of compliances.
std::vector<double> squares_of_bodies(const Case& setup) {
  std::vector<double> squares(setup.bodies.size() + 1);
  for (const coupler::SpringSpec& spring : setup.springs) {
    const double between = std::sqrt(spring.compliance[0] * spring.compliance[1]);
    squares[spring.body] += spring.stiffness * (spring.compliance[0] + between);
    squares[spring.to] += spring.stiffness * (spring.compliance[1] + between);
  }
  return squares;
}

}  // namespace

/// Checks single springs, and the springs of a body together; a step is stable up to a square of 4.
void find_spring_faults(const Case& setup, Diagnostics& findings) {
  constexpr double most_together = 2;
  for (std::size_t i = 0; i < setup.springs.size(); ++i)
    find_fault_of(setup.springs[i], fmt::format("springs[{}]", i), setup.units, findings);
  const std::vector<double> squares = squares_of_bodies(setup);
  for (std::size_t id = 1; id < squares.size(); ++id)
    if (squares[id] > most_together)
      findings.error("springs",
                     "springs: those of body '{}' together may be too stiff for the time step: lower their "
                     "stiffness to {} times what it is, or shorten the time step",
                     setup.kind_names[std::size_t(setup.bodies[id - 1].kind)],
                     shown(rounded_down(most_together / squares[id])));
}

}  // namespace silt
