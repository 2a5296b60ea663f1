#pragma once
// The pressure that drives a stream through the bodies that stand in it, foreseen before a run.
#include <optional>

#include "rigid/bodies/world.hpp"
#include "silt/case/case_error.hpp"

namespace silt::rigid {
struct BodySet;
}

namespace silt {

struct Case;

/// Warns where the bodies in the stream of an inlet let the pressure fall by so much that the fluid is
/// noticeably compressible: their drag by the law of Beetstra, van der Hoef and Kuipers (AIChE J. 53 (2007)
/// 489) at the solid fraction between the first and the last of them; of free bodies at most their weight in
/// the fluid.
std::optional<Diagnostic> pressure_warning(const Case&, const rigid::BodySet&, const rigid::World&);

}  // namespace silt
