#include "silt/run/run_outputs.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "cpu/isa.hpp"
#include "lbm/blocks/moments.hpp"
#include "parallel/together.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/guard.hpp"
#include "silt/results/build_info.hpp"
#include "silt/results/checkpoint.hpp"
#include "silt/results/flow_fields.hpp"
#include "silt/results/report.hpp"
#include "silt/run/run_estimate.hpp"
#include "silt/simulation.hpp"

namespace silt {

RunOutputs::RunOutputs(PreparedRun& run, const std::filesystem::path& folder, Progress& progress)
    : run_(run),
      simulation_(*run.simulation),
      folder_(folder),
      progress_(progress),
      provenance_(provenance_of(setup(), simulation_.scene().ranks(), simulation_.scene().backend_name())) {}

void RunOutputs::begin_log() {
  const Scene& scene = simulation_.scene();
  if (!run_.folder.note.empty()) progress_.say(run_.folder.note);
  const auto count = [](int n, const char* what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
  };
  progress_.log(fmt::format("silt {} ({}), {}, {}, {}, {}, {}, {}\n{}", provenance_.version,
                            provenance_.commit, provenance_.compiler, provenance_.host,
                            count(scene.ranks(), "rank"), count(scene.domain.blocks(), "block"),
                            instruction_set(), provenance_.created, derived_table(setup())));
  for (const Diagnostic& warning : run_.warnings) progress_.say(warning.line());
}

bool RunOutputs::due(const SeriesSpec& series) const {
  return series.every > 0 && (simulation_.steps_done() % series.every == 0 || run_.has_ended());
}

std::vector<const FieldsSpec*> RunOutputs::fields_due() const {
  std::vector<const FieldsSpec*> fields;
  if (due(setup().output.fields)) fields.push_back(&setup().output.fields);
  for (const FieldsSpec& slice : setup().output.slices)
    if (due(slice)) fields.push_back(&slice);
  return fields;
}

void RunOutputs::start() {
  const OutputSpec& output = setup().output;
  const std::int64_t resumed_at = run_.resumed ? run_.first_step : -1;
  parallel::on_rank_0(simulation_.scene().comm, [&] { write_scene_file(setup(), folder_); });
  if (output.bodies.every > 0 && setup().has_bodies())
    bodies_.emplace(simulation_, folder_, provenance_, run_.resumed);
  parallel::on_rank_0(simulation_.scene().comm, [&] {
    if (output.report.every > 0) reports_.emplace(folder_ / "series.csv", resumed_at);
    for (const ColumnsSpec& series : output.series)
      series_.emplace_back(folder_ / (series.name + ".csv"), resumed_at);
    for (const ProbesSpec& probes : output.probes)
      probe_tables_.emplace_back(folder_ / (probes.name + ".csv"), resumed_at,
                                 Probes(probes).places(setup()));
    if (setup().bodies_leave()) departures_.emplace(folder_, resumed_at, setup().units);
  });
  for (const ProbesSpec& probes : output.probes) probes_.emplace_back(probes);
  if (run_.resumed) return;
  run_.quantities->observe(simulation_);
  if (simulation_.scene().flow) simulation_.checked_totals();
  write_bodies_and_fields();
  if (output.report.every > 0) write_report("running", "", true);
}

void RunOutputs::write_bodies_and_fields() {
  for (std::size_t p = 0; p < probes_.size(); ++p)
    if (simulation_.steps_done() % setup().output.probes[p].every == 0) probes_[p].look(simulation_);
  if (run_.mean) run_.mean->observe(simulation_);
  if (bodies_ && due(setup().output.bodies)) bodies_->append(simulation_);
  for (const FieldsSpec* fields : fields_due()) write_flow_fields(simulation_, *fields, folder_, provenance_);
}

void RunOutputs::write_due() {
  const OutputSpec& output = setup().output;
  const bool ended = run_.has_ended(), fields = !fields_due().empty(), save = due(output.checkpoint),
             report = due(output.report);
  const bool looks = simulation_.steps_done() % guard_interval == 0 || ended || save || report;
  if (ended || fields || save || report || (bodies_ && due(output.bodies))) simulation_.settle();
  if (simulation_.scene().flow && (looks || fields)) simulation_.checked_totals();
  if (looks) log_departures();
  write_bodies_and_fields();
  if (ended && bodies_) bodies_->finish();
  if (looks) write_rows();
  if (ended && run_.mean) run_.mean->write(simulation_, folder_, provenance_);
  // Before the checkpoint: a run killed in between resumes from the one before, and writes the report again.
  if (ended && save)
    write_report(run_.reason_of_end(), run_.text_of_end(), true);
  else if (report && !ended)
    write_report("running", "", true);
  if (save) write_checkpoint();
}

/// Writes the bodies that left since the last call to the log and to departures.csv.
void RunOutputs::log_departures() {
  if (!setup().bodies_leave()) return;
  const std::vector<Departure> left = gathered(simulation_.scene().comm, simulation_.take_departures());
  parallel::on_rank_0(simulation_.scene().comm, [&] { departures_->append(left); });
  if (!left.empty())
    progress_.log(fmt::format("step {}: {}", simulation_.steps_done(), departures_text(left)));
}

/// Flushes the rows of series and probes to their files.
void RunOutputs::write_rows() {
  const OutputSpec& output = setup().output;
  if (output.series.empty() && output.probes.empty()) return;
  run_.quantities->settle(simulation_);
  const std::vector<TableRows> of_series = run_.quantities->take_rows();
  std::vector<TableRows> of_probes;
  for (Probes& probes : probes_) of_probes.push_back(probes.take_rows(setup()));
  parallel::on_rank_0(simulation_.scene().comm, [&] {
    for (std::size_t s = 0; s < series_.size(); ++s)
      series_[s].append(Quantities::columns(output.series[s]), of_series[s]);
    for (std::size_t p = 0; p < probe_tables_.size(); ++p)
      probe_tables_[p].append(probes_[p].columns(), of_probes[p]);
  });
}

/// Writes a checkpoint of this name with all accumulated data; returns its path.
std::filesystem::path RunOutputs::write_state(const std::string& name) {
  log_departures();
  write_rows();
  const RunHistory history{*run_.quantities, run_.steady ? &*run_.steady : nullptr,
                           run_.mean ? &*run_.mean : nullptr};
  return silt::write_checkpoint(simulation_, history, folder_, provenance_, name);
}

void RunOutputs::write_checkpoint() {
  simulation_.settle();
  last_checkpoint_ = write_state("checkpoint").string();
  progress_.log(fmt::format("step {}: wrote {}", simulation_.steps_done(), last_checkpoint_));
}

void RunOutputs::interrupt(const std::string& text) {
  write_report("interrupted", text, true);  // before the checkpoint to which its row belongs
  write_checkpoint();
  if (bodies_) bodies_->finish();
}

std::filesystem::path RunOutputs::write_stopped_state() {
  const auto path = write_state("stopped");
  if (simulation_.scene().flow) write_flow_fields(simulation_, setup().output.fields, folder_, provenance_);
  if (!bodies_) return path;
  bodies_->append(simulation_);
  bodies_->finish();
  return path;
}

std::string RunOutputs::last_checkpoint_text() const {
  if (!last_checkpoint_.empty()) return fmt::format("\nlast checkpoint: {}", last_checkpoint_);
  const auto there = adapters::list_checkpoints(folder_);
  if (there.empty()) return "\nno checkpoint has been written (see output.checkpoint)";
  return fmt::format("\nlast checkpoint: {}", there.front().path.string());
}

void RunOutputs::write_report(const std::string& reason, const std::string& text, bool sound) {
  write_rows();
  const auto path = folder_ / "report.json";
  parallel::with_file_name(path.string(), [&] {
    const bool at_end = run_.has_ended() || reason != "running";
    const RunStatus status{reason, text, run_.first_step, MPI_Wtime() - begin_, sound, at_end};
    const std::string report = report_of(simulation_, *run_.quantities, status);
    parallel::on_rank_0(simulation_.scene().comm, [&] {
      if (reports_ && sound) append_report(*reports_, simulation_.steps_done(), report);
      if (!at_end && !due(setup().output.checkpoint) && status.wall_seconds < reported_ + 1) return;
      write_text(path, report);
      reported_ = status.wall_seconds;
    });
  });
}

namespace {

std::string doubt_of_sweeps(const Simulation& simulation) {
  constexpr double far = 0.1;
  const Case& setup = simulation.setup();
  const RunCounters counters = simulation.counters();
  const double fall = setup.gravity.norm() / setup.contacts.substeps;
  if (counters.residual <= far * std::max(counters.body_speed, fall)) return "";
  const auto speed = [&](double x) {
    return shown(setup.units.physical(x, dimension::velocity)) + " " +
           setup.units.unit_text(dimension::velocity);
  };
  const int sweeps = setup.contacts.resolver_settings.max_sweeps;
  return fmt::format(
      "contacts.sweeps: the sweeps over the contacts ended far from convergence: the last of {} still "
      "changed a body's velocity by {}, compared with {} of the fastest body; raise contacts.sweeps (--set "
      "contacts.sweeps={}), or use smaller steps",
      sweeps, speed(counters.residual), speed(counters.body_speed), 4 * sweeps);
}

/// Returns the change of the fluid's mass over its mass in a closed domain, where there should be none; else
/// 0.
double lost_mass(const Simulation& simulation) {
  if (std::ranges::any_of(simulation.setup().boundary, &coupler::BoundarySpec::is_open)) return 0;
  const Balance& before = simulation.initial_balance();
  return (before.mass_deviation - simulation.balance().mass_deviation) / before.fluid_cells;
}

std::string doubt_of_density(const Simulation& simulation) {
  constexpr double doubtful = 0.01;  // a linear pressure drop to the reference exceeds it from 0.017 on
  const Case& setup = simulation.setup();
  const double all = simulation.density_deviation(), lost = lost_mass(simulation);
  const double found = std::sqrt(std::max(0., all * all - lost * lost));  // about the mean
  if (found <= doubtful) return "";
  // pressure scales with the square of the speed; another run is checked at other phases of sound waves
  const double factor = std::sqrt(0.8 * doubtful / found);
  return fmt::format(
      "the density of the fluid deviated by up to {:.1f} % (root mean square over its cells); above {} % the "
      "fluid is noticeably compressible: {}",
      100 * found, shown(100 * doubtful),
      setup.units.si ? time_step_cure(setup, factor)
                     : fmt::format("give all velocities times {}", shown(rounded_down(factor))));
}

std::string doubt_of_mass(const Simulation& simulation) {
  constexpr double noticeable = 0.003;
  const double fluid = simulation.initial_balance().fluid_cells;
  const double taken = double(simulation.mass_taken()) * lbm::mass_quantum;
  if (!(std::fabs(taken) > noticeable * fluid)) return "";
  return fmt::format(
      "cells that turned solid or fluid without a fluid neighbour took {:.2f} % of the mass of the fluid: "
      "use smaller cells, for gaps of less than one between bodies",
      100 * taken / fluid);
}

std::string doubt_of_walls(const Simulation& simulation) {
  constexpr double noticeable = 0.003;
  const double taken = double(simulation.mass_taken()) * lbm::mass_quantum;
  const double lost = lost_mass(simulation) - taken / simulation.initial_balance().fluid_cells;
  if (!(std::fabs(lost) > noticeable)) return "";
  return fmt::format(
      "the fluid {} {:.2f} % of its mass, as a wall that moves beside a body, with no cell between them, "
      "takes none back for what it sweeps there: give the wall as [[bodies]] with the same file and motion",
      lost > 0 ? "lost" : "gained", 100 * std::fabs(lost));
}

std::string doubt_of_fastest(const Simulation& simulation) {
  const double speed = simulation.fluid_speed();
  const std::string doubt = doubt_of_heat(simulation.setup(), speed);
  return doubt.empty() ? doubt : fmt::format("the fluid came to {} cells a step, {}", shown(speed), doubt);
}

}  // namespace

std::vector<std::string> warnings_of(const Simulation& simulation) {
  std::vector<std::string> doubts{doubt_of_sweeps(simulation)};
  if (simulation.scene().flow)
    for (const auto doubt_of : {doubt_of_density, doubt_of_mass, doubt_of_walls, doubt_of_fastest})
      doubts.push_back(doubt_of(simulation));
  const Scene& scene = simulation.scene();
  if (scene.setup.has_free_bodies())  // others were there at the start
    if (const auto covered = inlet_warning(scene.setup, scene.bodies, scene.world, scene.comm))
      doubts.push_back(covered->text);
  std::erase(doubts, "");
  return doubts;
}

}  // namespace silt
