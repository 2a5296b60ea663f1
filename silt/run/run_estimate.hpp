#pragma once
// The time, memory and disk of a run, and how evenly ranks share its work, foreseen from its case.
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rigid/bodies/body_set.hpp"
#include "silt/case/case_error.hpp"

namespace silt {

struct Case;

struct RunEstimate {
  int ranks = 1;
  double seconds = 0, seconds_a_step = 0, seconds_of_output = 0;  // the first is that of all
  double memory = 0;                                              // bytes of all ranks
  double disk = 0;                                                // bytes of all files at the end
  double largest_over_mean = 1;                                   // of the work of a rank
  std::vector<double> cells;       // of the fluid, by level, at the start; with [coarsening]
  double cell_updates = 0;         // as much work as the fluid's is in a step; with [coarsening]
  std::vector<Diagnostic> doubts;  // about where cells change their width; about the pressure
};

/// Estimates a run on so many ranks of machines like this one: work as cuts of the domain count it
/// (balance/body_work.hpp), a cell by what this machine's memory moves now, and contacts by what beds of
/// such bodies have. Meant to be within a factor of 2; what was found is in measurements.md, "Estimates
/// of runs". Takes some milliseconds besides the bodies: those that another run leaves to the case, and those
/// that the case places, for which CaseError says that there is no room.
RunEstimate estimate_run(const Case&, std::span<const rigid::BodyRecord> continued, int ranks);

/// Returns the bytes of the files of a run with so many bodies, and this share of the cells if all were
/// finest.
double disk_needed(const Case&, std::uint64_t bodies, double share = 1);

/// Returns lines in the form of the derived table.
std::string estimate_table(const Case&, const RunEstimate&);

/// Warns of files that the file system of a folder, which need not be there yet, has no room for.
std::optional<Diagnostic> disk_warning(const Case&, double needed, const std::filesystem::path& folder);
/// Warns of a run that takes years.
std::optional<Diagnostic> time_warning(const Case&, const RunEstimate&);

}  // namespace silt
