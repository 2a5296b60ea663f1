#pragma once
// Prepares a run up to its first step: reads and checks the case, or continues from a checkpoint.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "silt/case/case_error.hpp"
#include "silt/results/flow_mean.hpp"
#include "silt/results/quantities.hpp"
#include "silt/results/result_folder.hpp"
#include "silt/results/steady_watch.hpp"
#include "silt/run/progress.hpp"
#include "silt/run/run.hpp"
#include "silt/simulation.hpp"

namespace silt {

/// A run before its first step. Errors on any rank become errors on all.
struct PreparedRun {
  std::unique_ptr<Simulation> simulation;
  std::unique_ptr<Quantities> quantities;
  std::optional<SteadyWatch> steady;  // if the case asks for it
  std::optional<FlowMean> mean;       // likewise
  std::vector<Diagnostic> warnings;
  ReadyFolder folder;  // on rank 0
  std::filesystem::path started_from;  // the checkpoint of initial.from, if the run begins with one
  bool resumed = false;
  std::int64_t first_step = 0;  // first step of this start
  /// Describes the options of the resumed run that still hold, or "".
  std::string earlier_options;

  RunExtent extent() const;
  /// Checks after a step whether the flow is steady, if the case asks for it. Collective.
  void watch();
  bool is_steady() const { return steady && steady->steady(); }
  /// Returns whether no step is left; the next two functions describe that end for report.json.
  bool has_ended() const;
  std::string reason_of_end() const { return is_steady() ? "steady" : "completed"; }
  std::string text_of_end() const;
};

/// Prepares a run without a folder for results. All three functions are collective and throw the same error
/// on every rank: CaseError, FileError or std::runtime_error.
PreparedRun prepare_scene(const RunOptions&, MPI_Comm);
PreparedRun prepare_run(const RunOptions&, MPI_Comm, const std::filesystem::path& folder);
/// Continues from the checkpoint of the options, or else from the newest one in the folder.
PreparedRun prepare_resume(const RunOptions&, MPI_Comm, const std::filesystem::path& folder);

}  // namespace silt
