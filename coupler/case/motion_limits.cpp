#include "coupler/case/motion_limits.hpp"

#include <algorithm>
#include <limits>

#include "coupler/case/case.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

namespace {

constexpr double without_limit = std::numeric_limits<double>::infinity();

double width_of_thinnest_part(const rigid::Shape& shape) {
  double width = without_limit;
  for (const rigid::Part& part : rigid::convex_parts(shape))
    width = std::min(width, std::visit([](const auto& s) { return s.least_width(); }, part.shape));
  return width;
}

}  // namespace

MotionLimits::MotionLimits(const Case& scene) : least_(without_limit), least_half_width_(without_limit) {
  const ContactSpec& contacts = scene.contacts;
  for (const rigid::Shape& shape : scene.shapes) {
    const double width = width_of_thinnest_part(shape);
    of_shape_.push_back(scene.fluid ? furthest_motion : contacts.substeps * 0.5 * (contacts.margin + width));
    half_width_.push_back(0.5 * width);
    least_ = std::min(least_, of_shape_.back());
    least_half_width_ = std::min(least_half_width_, half_width_.back());
  }
}

}  // namespace silt::coupler
