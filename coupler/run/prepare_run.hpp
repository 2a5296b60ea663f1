#pragma once
// Prepares a run, from its options to its first step: the case is read and judged, or the run comes back from
// a checkpoint.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coupler/case/case_error.hpp"
#include "coupler/results/quantities.hpp"
#include "coupler/results/result_folder.hpp"
#include "coupler/results/steady_watch.hpp"
#include "coupler/run/run.hpp"
#include "coupler/simulation.hpp"

namespace silt::coupler {

/// What a run needs before its first step; made together, so that an error on any rank is one on all.
struct PreparedRun {
  std::unique_ptr<Simulation> simulation;
  std::unique_ptr<Quantities> quantities;
  std::optional<SteadyWatch> steady;  // where the case asks for it
  std::vector<Diagnostic> warnings;
  ReadyFolder folder;           // on rank 0
  std::string earlier_options;  // of the run that goes on, which still hold
};

/// Says what else than the case holds of the run that goes on, or "".
std::string earlier_options_text(const PreparedRun&);

/// Reads and judges a case without running it; returns its derived table and its warnings. CaseError.
std::string examine_case(const RunOptions&);

/// Returns where the results go: the option, else DIRECTORY/out.
std::filesystem::path result_folder(const RunOptions&);

/// Collective. All three throw on every rank, with what is wrong: CaseError, FileError, std::runtime_error.
/// Without a folder for results, for those who write none:
PreparedRun prepare_scene(const RunOptions&, MPI_Comm);
PreparedRun prepare_run(const RunOptions&, MPI_Comm, const std::filesystem::path& folder);
/// Goes on from the checkpoint of the options, else from the newest one in the folder.
PreparedRun prepare_resume(const RunOptions&, MPI_Comm, const std::filesystem::path& folder);

}  // namespace silt::coupler
