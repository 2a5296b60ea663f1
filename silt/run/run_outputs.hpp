#pragma once
// Writes the files of a run: fields, bodies, departures, series, report.json and series.csv, checkpoints.
#include <deque>
#include <string>
#include <vector>

#include "silt/case/output_spec.hpp"
#include "silt/results/body_output.hpp"
#include "silt/results/probes.hpp"
#include "silt/results/run_tables.hpp"
#include "silt/run/prepare_run.hpp"
#include "silt/run/progress.hpp"

namespace silt {

/// All functions but last_checkpoint_text are collective and throw std::runtime_error.
class RunOutputs {
 public:
  /// Refers to the run and its progress.
  RunOutputs(PreparedRun&, const std::filesystem::path& folder, Progress&);

  /// Writes the case, the version of the program and warnings to run.log.
  void begin_log();
  /// Opens files, or continues those of a resumed run; writes the first state of a new run.
  void start();
  /// Writes all output that is due after a step.
  void write_due();
  void write_checkpoint();
  /// Writes report.json, at most once a second during the run but with each checkpoint, and appends its row
  /// to series.csv if missing. `sound`: results can be computed from the state.
  void write_report(const std::string& reason, const std::string& text, bool sound);
  /// Writes the report and the checkpoint of a run that ends before its last step.
  void interrupt(const std::string& text);
  /// Writes the state at which a guard stopped the run; returns its path.
  std::filesystem::path write_stopped_state();

  /// Returns a line that names the last checkpoint.
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
  std::optional<DepartureLog> departures_;  // on rank 0, if bodies may leave
  std::optional<StepTable> reports_;        // on rank 0, if the case asks for reports
  std::vector<StepTable> series_;           // on rank 0, per [[output.series]]
  std::deque<Probes> probes_;
  std::vector<StepTable> probe_tables_;  // on rank 0
  std::string last_checkpoint_;
  double reported_ = -1;  // seconds from the start to the last report.json, on rank 0
};

/// Returns the warnings about doubtful results at the end of a run, one text each for contact sweeps that
/// ended far from convergence in a step, a fluid that was noticeably compressible or carried heat too fast at
/// a check, mass that cells took without a fluid neighbour, and free bodies that cover an inlet. Collective.
std::vector<std::string> warnings_of(const Simulation&);

}  // namespace silt
