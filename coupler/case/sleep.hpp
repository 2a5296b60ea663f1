#pragma once
// When bodies of a case are held at rest.
#include <optional>

#include "coupler/case/case.hpp"
#include "rigid/bodies/sleep_rule.hpp"

namespace silt::coupler {

/// Without a time of its own, that in which a thousandth of gravity gives the speed; none where nothing
/// sleeps.
std::optional<rigid::SleepRule> sleep_rule(const Case&);

}  // namespace silt::coupler
