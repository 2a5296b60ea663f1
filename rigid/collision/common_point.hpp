#pragma once
// Where two outlines that face each other meet: the proof that a direction is one of closest or least deep
// approach.
#include "rigid/shapes/contact_outline.hpp"

namespace silt::rigid {

/// Where the normal of a contact passes through both outlines.
struct CommonPoint {
  Vec3 on_a = Vec3::Zero(), on_b = Vec3::Zero();  // lattice units, on the cores
  double miss = 0;                                // of on_b from on_a + gap n: 0 but for rounding
  std::uint32_t code_a = 0, code_b = 0;           // of the features they lie on
};

/// The points of the two outlines, `gap` (lattice units) apart, that lie most exactly over each other along
/// unit n, found among the corners, the crossings of edges and the centres of discs: one of these is common
/// to both if anything is.
CommonPoint common_point(const ContactOutline& a, const ContactOutline& b, const Vec3& n, double gap,
                         double slack);

/// The face as seen along unit n (not in its plane): signed distance of x to the edge k, positive outside.
class Prism {
 public:
  Prism(const ContactOutline& face, const Vec3& n);
  std::size_t size() const { return outward_.size(); }
  double beyond(std::size_t k, const Vec3& x) const { return outward_[k].dot(x) - bound_[k]; }

 private:
  std::vector<Vec3> outward_;
  std::vector<double> bound_;
};

/// What of the face lies under x: the face, or an edge or corner of it that is within `slack` (lattice
/// units).
std::uint32_t code_under(const ContactOutline& face, const Prism&, const Vec3& x, double slack);

}  // namespace silt::rigid
