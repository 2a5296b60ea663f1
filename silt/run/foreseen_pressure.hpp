#pragma once
// Predicts the pressure drop of a stream through bodies, and finds the part of an inlet that bodies cover.
#include <mpi.h>

#include <optional>

#include "rigid/bodies/world.hpp"
#include "silt/case/case_error.hpp"

namespace silt::rigid {
struct BodySet;
}

namespace silt {

struct Case;

/// Warns if bodies in the stream of an inlet make the pressure drop so large that the fluid is noticeably
/// compressible. Their drag follows Beetstra, van der Hoef and Kuipers (AIChE J. 53 (2007) 489) at the solid
/// fraction between the first and the last body; that of free bodies is at most their weight in the fluid.
std::optional<Diagnostic> pressure_warning(const Case&, const rigid::BodySet&, const rigid::World&);

/// Warns if bodies, as spheres of the same volume, cover a part of an inlet at the start: nothing flows in
/// there. Collective; each rank has its own bodies.
std::optional<Diagnostic> inlet_warning(const Case&, const rigid::BodySet&, const rigid::World&, MPI_Comm);

}  // namespace silt
