#pragma once
// Estimates time, memory and disk of a run, and its balance of work over ranks, from the case; predicts the
// pressure drop of a stream through bodies, and finds the part of an inlet that bodies cover.
#include <mpi.h>

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/world.hpp"
#include "silt/case/case_error.hpp"

namespace silt {

struct Case;

struct RunEstimate {
  int ranks = 1;
  double seconds = 0, seconds_a_step = 0, seconds_of_output = 0;  // `seconds` is the whole run
  double memory = 0;                                              // bytes, all ranks
  double disk = 0;                                                // bytes, all files at the end
  double largest_over_mean = 1;                                   // of the work of ranks
  std::vector<double> cells;       // fluid cells by level at the start; with [coarsening]
  double cell_updates = 0;         // work of the fluid per step, in cells; with [coarsening]
  std::vector<Diagnostic> doubts;  // about borders of levels and about the pressure
};

/// Estimates a run on `ranks` ranks of machines like this one, to a factor of 2 (measurements.md, "Estimates
/// of runs"). Counts work as cuts of the domain do (balance/body_work.hpp), measures the time per cell on
/// this machine now, and takes contacts per body from beds of such bodies. Costs milliseconds, plus the
/// placement of bodies: those of another run and of the case (CaseError if they do not fit).
RunEstimate estimate_run(const Case&, std::span<const rigid::BodyRecord> continued, int ranks);

/// Returns the bytes of a run's files; `share` is the number of cells relative to finest cells everywhere.
double disk_needed(const Case&, std::uint64_t bodies, double share = 1);

/// Returns the estimate in the form of the derived table.
std::string estimate_table(const Case&, const RunEstimate&);

/// Warns if a file system has no room for the files; the folder need not exist yet.
std::optional<Diagnostic> disk_warning(const Case&, double needed, const std::filesystem::path& folder);
/// Warns of a run that takes years.
std::optional<Diagnostic> time_warning(const Case&, const RunEstimate&);

/// Warns if bodies in the stream of an inlet make the pressure drop so large that the fluid is noticeably
/// compressible. Their drag follows Beetstra, van der Hoef and Kuipers (AIChE J. 53 (2007) 489) at the solid
/// fraction between the first and the last body, for free bodies at that of a packing, into which they
/// settle; theirs is at most their weight in the fluid.
std::optional<Diagnostic> pressure_warning(const Case&, const rigid::BodySet&, const rigid::World&);

/// Warns if bodies, as spheres of the same volume, cover a part of an inlet at the start: nothing flows in
/// there. Collective; each rank has its own bodies.
std::optional<Diagnostic> inlet_warning(const Case&, const rigid::BodySet&, const rigid::World&, MPI_Comm);

}  // namespace silt
