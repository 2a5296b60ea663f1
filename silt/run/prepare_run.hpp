#pragma once
// Prepares a run up to its first step: the case is read and judged, or the run comes from a checkpoint.
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

/// The parts of a run before its first step, made together, so that an error on any rank is one on all.
struct PreparedRun {
  std::unique_ptr<Simulation> simulation;
  std::unique_ptr<Quantities> quantities;
  std::optional<SteadyWatch> steady;  // where the case asks for it
  std::optional<FlowMean> mean;       // the same
  std::vector<Diagnostic> warnings;
  ReadyFolder folder;  // on rank 0
  bool resumed = false;
  std::int64_t first_step = 0;  // where this start begins
  /// Says what of the options of the run that goes on still holds, or "".
  std::string earlier_options;

  RunExtent extent() const;
  /// Collective, after a step: looks whether the flow has become steady, when the case asks for it.
  void watch();
  bool is_steady() const { return steady && steady->steady(); }
  /// Returns whether no step is left to do; the next two, what report.json says of that end.
  bool has_ended() const;
  std::string reason_of_end() const { return is_steady() ? "steady" : "completed"; }
  std::string text_of_end() const;
};

/// Collective. All three throw on every rank, with what is wrong: CaseError, FileError, std::runtime_error.
/// Without a folder for results, for those who write none:
PreparedRun prepare_scene(const RunOptions&, MPI_Comm);
PreparedRun prepare_run(const RunOptions&, MPI_Comm, const std::filesystem::path& folder);
/// Goes on from the checkpoint of the options, else from the newest one in the folder.
PreparedRun prepare_resume(const RunOptions&, MPI_Comm, const std::filesystem::path& folder);

}  // namespace silt
