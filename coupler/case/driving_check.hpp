#pragma once
// Judges what drives a scene, by what comes of it: how fast bodies will fall and fluid will flow.
#include "coupler/case/body_check.hpp"

namespace silt::coupler {

/// Reports accelerations that no step can take or that are a slip of units; gravity that nothing holds, and
/// bodies with weight where nothing moves at all; bodies in a fluid that will fall or rise too fast (the
/// drag law of Schiller and Naumann, hindered by the others, and no further than the domain and the run
/// allow) and flows that a body force makes too fast (laminar). With a time step that cures it.
void find_driving_faults(const Case&, Findings&);

}  // namespace silt::coupler
