#pragma once
// The files that a run writes: fields, bodies, departures, series, report.json and series.csv, checkpoints.
#include <deque>

#include "silt/case/output_spec.hpp"
#include "silt/results/body_output.hpp"
#include "silt/results/probes.hpp"
#include "silt/results/run_tables.hpp"
#include "silt/run/prepare_run.hpp"
#include "silt/run/progress.hpp"

namespace silt {

/// Everything but last_checkpoint_text is collective. Errors are std::runtime_error.
class RunOutputs {
 public:
  /// Refers to the run and its progress.
  RunOutputs(PreparedRun&, const std::filesystem::path& folder, Progress&);

  /// Says in run.log what is run, by what, and what is to be warned of.
  void begin_log();
  /// Begins the files, or goes on with those that are there; of a new run it writes the first state.
  void start();
  /// Writes what is due after a step.
  void write_due();
  void write_checkpoint();
  /// Writes report.json, at most once a second while the run goes on but with each checkpoint, and, unless it
  /// is there, its row of series.csv. `sound`: the state is one that figures can be taken from.
  void write_report(const std::string& reason, const std::string& text, bool sound);
  /// Leaves the report and the checkpoint of a run that ends before its last step.
  void interrupt(const std::string& text);
  /// Leaves the state that a guard stopped at, for a look at it. Returns its path.
  std::filesystem::path write_stopped_state();

  /// Returns a line that says which checkpoint is the last.
  std::string last_checkpoint_text() const;

 private:
  const Case& setup() const { return simulation_.setup(); }
  std::vector<const FieldsSpec*> fields_due() const;
  bool due(const SeriesSpec&) const;
  void write_bodies_and_fields();
  void log_departures();
  void write_rows();
  std::filesystem::path write_state(const std::string& name);

  PreparedRun& run_;
  Simulation& simulation_;
  const std::filesystem::path folder_;
  Progress& progress_;
  const double begin_ = MPI_Wtime();
  const adapters::Provenance provenance_;
  std::optional<BodyOutput> bodies_;
  std::optional<DepartureLog> departures_;  // on rank 0, where bodies may leave
  std::optional<StepTable> reports_;        // on rank 0, where the case asks for reports
  std::vector<StepTable> series_;           // on rank 0: of [[output.series]]
  std::deque<Probes> probes_;
  std::vector<StepTable> probe_tables_;  // on rank 0
  std::string last_checkpoint_;
  double reported_ = -1;  // seconds from the start to the last report.json, on rank 0
};

}  // namespace silt
