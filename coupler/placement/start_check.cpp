#include "coupler/placement/start_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "coupler/case/case.hpp"
#include "coupler/case/case_check.hpp"
#include "coupler/placement/given_bodies.hpp"
#include "coupler/placement/neighbour_grid.hpp"
#include "coupler/placement/overlap.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

using rigid::Motion;
using rigid::Vec3;

std::string in_the_domain(const Case& setup, const std::string& key, const BodySpec& body) {
  const bool centred = body.origin.isZero(0);
  return fmt::format(
      "{} is {}{}; it must lie in the domain, {}{}", key, shown_point(setup, body.given_position()),
      centred ? "" : ": this puts the body's centre of mass at " + shown_point(setup, body.pose.position),
      shown_box(setup, box_of(setup)),
      centred ? "" : "; with origin = \"centre\" the position is that of the centre");
}

/// What is wrong with where a body is, "" if nothing: its centre of mass must be in the domain, and if it
/// moves it must not reach into a wall.
std::string fault_of_place(const Case& setup, const BodySpec& body) {
  const Vec3 size = extent_of(setup).size, x = body.given_position();
  const Vec3& centre = body.pose.position;
  const std::string key = position_text(setup, body);
  for (int d = 0; d < 3; ++d)
    if (!(centre[d] >= 0 && centre[d] <= size[d])) return in_the_domain(setup, key, body);
  if (body.motion == Motion::fixed) return "";
  const auto box = rigid::bounding_box(setup.shapes[body.shape], body.pose);
  for (int d = 0; d < 3; ++d) {
    if (setup.periodic(d)) continue;
    const double low = setup.boundary[2 * d].solid_for_bodies ? -box.lower[d] : 0;
    const double high = setup.boundary[2 * d + 1].solid_for_bodies ? box.upper[d] - size[d] : 0;
    if (std::max(low, high) <= start_overlap) continue;
    const double allowed_low = x[d] - box.lower[d], allowed_high = size[d] - (box.upper[d] - x[d]);
    return fmt::format(
        "{} is {}: the body reaches {} into the {} wall of {}; its {} must be between {} and {}", key,
        shown_point(setup, x), shown_length(setup, std::max(low, high)), low > high ? "lower" : "upper",
        "xyz"[d], "xyz"[d], shown_length(setup, allowed_low), shown_length(setup, allowed_high));
  }
  return fault_in_curved_walls(setup, body, key, start_overlap);
}

std::vector<BodyFault> faults_of_places(const Case& setup, const std::vector<GivenBody>& bodies) {
  std::vector<BodyFault> faults;
  for (const GivenBody& body : bodies) {
    if (!body.own || faults.size() >= most_messages) continue;
    if (std::string text = fault_of_place(setup, body.spec); !text.empty())
      faults.push_back({body.id, 0, std::move(text)});
  }
  return faults;
}

std::string text_of_overlap(const Case& setup, const BodySpec& a, const BodySpec& b, double depth) {
  return fmt::format(
      "{}: the body at {} overlaps the one at {} (entry {}) by at least {} at the start; move them apart",
      position_text(setup, b), shown_point(setup, b.given_position()), shown_point(setup, a.given_position()),
      a.entry, shown_length(setup, depth));
}

/// Of two bodies that overlap some rank has both near it: the one where they do.
std::vector<BodyFault> faults_of_pairs(const Case& setup, const std::vector<GivenBody>& bodies) {
  const rigid::Extent extent = extent_of(setup);
  NeighbourGrid grid(extent, mean_width(setup, bodies));
  std::vector<BodyFault> faults;
  std::vector<int> partners;
  for (std::size_t j = 0; j < bodies.size() && faults.size() < most_messages; ++j) {
    const BodySpec& b = bodies[j].spec;
    const auto box = rigid::bounding_box(setup.shapes[b.shape], b.pose);
    partners.clear();
    grid.visit(box, [&](int i) { return partners.push_back(i), true; });
    std::sort(partners.begin(), partners.end());
    partners.erase(std::unique(partners.begin(), partners.end()), partners.end());
    for (const int i : partners) {
      const BodySpec& a = bodies[i].spec;
      if (a.motion != Motion::free && b.motion != Motion::free) continue;
      const double depth =
          overlap_depth(setup.shapes[a.shape], a.pose, setup.shapes[b.shape], b.pose, extent);
      if (depth > start_overlap)
        faults.push_back({bodies[j].id, bodies[i].id, text_of_overlap(setup, a, b, depth)});
    }
    grid.insert(static_cast<int>(j), box);
  }
  return faults;
}

}  // namespace

void require_sound_start(const Case& setup, const lbm::Domain& domain, MPI_Comm comm) {
  Surroundings around(setup, domain, comm, 1);
  const std::vector<GivenBody> bodies = given_bodies(setup, around);
  std::vector<BodyFault> faults = first_faults(comm, faults_of_places(setup, bodies), most_messages);
  if (faults.empty()) faults = first_faults(comm, faults_of_pairs(setup, bodies), most_messages);
  std::vector<Diagnostic> list;
  for (const BodyFault& fault : faults)
    list.push_back({Diagnostic::Severity::error,
                    setup.place(position_key(setup, entry_of(setup, fault.body))), fault.text});
  if (!list.empty()) throw CaseError(std::move(list));
}

}  // namespace silt::coupler
