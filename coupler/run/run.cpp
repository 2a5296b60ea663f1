#include "coupler/run/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>

#include "coupler/case/case.hpp"
#include "coupler/case/case_check.hpp"
#include "coupler/guard.hpp"
#include "coupler/results/body_output.hpp"
#include "coupler/results/build_info.hpp"
#include "coupler/results/checkpoint.hpp"
#include "coupler/results/departure_log.hpp"
#include "coupler/results/flow_fields.hpp"
#include "coupler/results/report.hpp"
#include "coupler/results/result_folder.hpp"
#include "coupler/results/run_series.hpp"
#include "coupler/results/scene_output.hpp"
#include "coupler/run/abort_alone.hpp"
#include "coupler/run/complete_run.hpp"
#include "coupler/run/prepare_run.hpp"
#include "coupler/run/progress.hpp"
#include "coupler/run/stop_request.hpp"
#include "cpu/isa.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::coupler {

namespace fs = std::filesystem;

namespace {

/// As a shell has to be given it.
std::string quoted(const std::string& argument) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) || std::strchr("/._-+=:,@%", c); };
  const std::string path = argument.starts_with('-') ? "./" + argument : argument;
  if (!path.empty() && std::all_of(path.begin(), path.end(), plain)) return path;
  std::string text = "'";
  for (const char c : path) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

class Run {
 public:
  Run(PreparedRun prepared, fs::path folder, const RunOptions& options, bool resumed, parallel::Reunion&);
  Exit go();

 private:
  const Case& setup() const { return simulation_.setup(); }
  RunExtent extent() const;
  bool is_steady() const { return prepared_.steady && prepared_.steady->steady(); }
  bool ended() const { return simulation_.steps_done() >= setup().steps || is_steady(); }
  const char* reason_of_end() const { return is_steady() ? "steady" : "completed"; }
  std::string text_of_end() const { return is_steady() ? steady_text() : ""; }
  bool due(const SeriesSpec& series) const;
  void greet();
  void start_outputs();
  void advance();
  void watch();
  std::string steady_text() const;
  void judge_sweeps();
  void write_outputs();
  void log_departures();
  void checkpoint();
  void write_report(const std::string& reason, const std::string& text, bool sound);
  Exit end(Exit, const std::string& reason, const std::string& text);
  [[noreturn]] void fail_alone(Exit, const std::string& reason, const std::string& what);
  std::string common_text(const std::exception&);
  std::string stopped_state_text();
  std::string last_checkpoint_text() const;

  PreparedRun prepared_;
  Simulation& simulation_;
  Quantities& quantities_;
  const MPI_Comm comm_;
  const fs::path folder_;
  const bool resumed_;
  const std::string resume_with_;  // arguments of silt resume
  const std::int64_t first_step_;
  const double begin_ = MPI_Wtime();
  const adapters::Provenance provenance_;
  StopRequest stop_request_;
  parallel::Reunion& reunion_;
  std::unique_ptr<Progress> progress_;
  std::unique_ptr<BodyOutput> body_output_;
  std::unique_ptr<DepartureLog> departures_;  // on rank 0, where bodies may leave
  std::unique_ptr<RunSeries> series_;         // on rank 0, where the case asks for reports
  std::string last_checkpoint_;
  double reported_ = -1;  // seconds from the start to the last report.json, on rank 0
};

Run::Run(PreparedRun prepared, fs::path folder, const RunOptions& options, bool resumed,
         parallel::Reunion& reunion)
    : prepared_(std::move(prepared)),
      simulation_(*prepared_.simulation),
      quantities_(*prepared_.quantities),
      comm_(simulation_.scene().comm),
      folder_(std::move(folder)),
      resumed_(resumed),
      resume_with_(quoted(options.directory.string()) +
                   (options.out ? " --out " + quoted(options.out->string()) : "")),
      first_step_(simulation_.steps_done()),
      provenance_(provenance_of(setup(), simulation_.scene().ranks, simulation_.scene().backend_name())),
      stop_request_(comm_, options.time_limit),
      reunion_(reunion) {}

RunExtent Run::extent() const {
  const auto& n = setup().cells;
  return {first_step_, setup().steps, setup().fluid ? double(n[0]) * n[1] * n[2] : 0, setup().units};
}

Exit Run::go() {
  try {
    parallel::together(comm_, [&] {
      progress_ = std::make_unique<Progress>(extent(), folder_ / "run.log", simulation_.scene().rank == 0);
    });
    greet();
    start_outputs();
    while (!ended()) {
      advance();
      watch();
      write_outputs();
      const std::string why = stop_request_.why(simulation_.steps_done());
      if (why.empty() || ended()) continue;
      const std::string text = fmt::format("{} at step {}; go on with: silt resume {}", why,
                                           simulation_.steps_done(), resume_with_);
      write_report("interrupted", text, true);
      checkpoint();
      return end(Exit::interrupted, "interrupted", text);
    }
    return end(Exit::done, reason_of_end(), text_of_end());
  } catch (const GuardStop& stop) {  // every rank
    return end(Exit::guard, "guard", stop.what() + stopped_state_text() + last_checkpoint_text());
  } catch (const std::exception& error) {
    return end(Exit::failed, "error", common_text(error) + last_checkpoint_text());
  }
}

/// Collective, if the error is every rank's: returns what it says, with the rank it comes from. Of this rank
/// alone it ends everything.
std::string Run::common_text(const std::exception& error) {
  const auto* common = dynamic_cast<const parallel::CommonError*>(&error);
  const std::string text = parallel::text_of(error);
  const Scene& scene = simulation_.scene();
  if (scene.ranks == 1) return text;
  const std::string of_rank =
      fmt::format("step {}, rank {}: {}", simulation_.steps_done(), common ? common->rank : scene.rank, text);
  if (!reunion_.all_here()) fail_alone(Exit::failed, "error", of_rank);
  return of_rank;
}

/// One step. What goes wrong on this rank leaves the others waiting for it: unless it is alone, that ends
/// everything.
void Run::advance() {
  const int rank = simulation_.scene().rank;
  try {
    simulation_.step();
    quantities_.observe(simulation_);
  } catch (const CommonGuardStop&) {
    throw;
  } catch (const GuardStop& stop) {
    if (simulation_.scene().ranks == 1) throw;
    fail_alone(Exit::guard, "guard", stop.what());
  } catch (const std::overflow_error& error) {
    const std::string text = overflow_text(setup(), error.what(), simulation_.steps_done() + 1, rank);
    if (simulation_.scene().ranks == 1) throw GuardStop(text);
    fail_alone(Exit::guard, "guard", text);
  } catch (const std::exception& error) {
    if (simulation_.scene().ranks == 1) throw;
    fail_alone(
        Exit::failed, "error",
        fmt::format("step {}, rank {}: {}", simulation_.steps_done() + 1, rank, parallel::text_of(error)));
  }
  progress_->step(simulation_.steps_done(), simulation_.step_seconds());
}

/// Collective: looks whether the flow has become steady, where the case asks for it and it is time to.
void Run::watch() {
  if (!prepared_.steady || simulation_.steps_done() % setup().steady->every != 0) return;
  const std::string& name = setup().steady->quantity;
  const double value = quantities_.evaluate(simulation_, name);
  prepared_.steady->look(value);
}

std::string Run::steady_text() const {
  const SteadySpec& spec = *setup().steady;
  return fmt::format("{} is steady at {}, to {} of it, and ends the run at step {} of {} (run.steady)",
                     spec.quantity, shown(prepared_.steady->state().value), shown(spec.change),
                     simulation_.steps_done(), setup().steps);
}

/// Collective: says so where the sweeps over contacts ended far from rest, in any step.
void Run::judge_sweeps() {
  constexpr double far = 0.1;
  const RunCounters counters = simulation_.counters();
  const double fall = setup().gravity.norm() / setup().contacts.substeps;
  if (counters.residual <= far * std::max(counters.body_speed, fall)) return;
  const auto speed = [&](double x) {
    return shown(setup().units.physical(x, dimension::velocity)) + " " +
           setup().units.unit_text(dimension::velocity);
  };
  const int sweeps = setup().contacts.resolver_settings.max_sweeps;
  progress_->say(
      fmt::format("warning: contacts.sweeps: the sweeps over the contacts ended far from rest: the last of "
                  "{} still changed a "
                  "body's velocity by {}, where the fastest body had {}; raise contacts.sweeps (--set "
                  "contacts.sweeps={}), or "
                  "take smaller steps",
                  sweeps, speed(counters.residual), speed(counters.body_speed), 4 * sweeps));
}

bool Run::due(const SeriesSpec& series) const {
  return series.every > 0 && (simulation_.steps_done() % series.every == 0 || ended());
}

void Run::start_outputs() {
  const OutputSpec& output = setup().output;
  parallel::on_rank_0(comm_, [&] { write_scene_file(setup(), folder_); });
  if (output.bodies.every > 0 && setup().has_bodies())
    body_output_ = std::make_unique<BodyOutput>(simulation_, folder_, provenance_, resumed_);
  if (output.report.every > 0)
    parallel::on_rank_0(comm_,
                        [&] { series_ = std::make_unique<RunSeries>(folder_, resumed_ ? first_step_ : -1); });
  if (setup().bodies_leave())
    parallel::on_rank_0(comm_, [&] {
      departures_ = std::make_unique<DepartureLog>(folder_, resumed_ ? first_step_ : -1, setup().units);
    });
  if (resumed_) return;
  quantities_.observe(simulation_);
  if (simulation_.scene().flow) simulation_.look_at_flow();
  if (body_output_) body_output_->append(simulation_);
  if (output.fields.every > 0) write_flow_fields(simulation_, output.fields, folder_, provenance_);
  for (const FieldsSpec& slice : output.slices)
    if (slice.every > 0) write_flow_fields(simulation_, slice, folder_, provenance_);
  if (output.report.every > 0) write_report("running", "", true);
}

void Run::write_outputs() {
  const OutputSpec& output = setup().output;
  const bool fields = due(output.fields) || std::any_of(output.slices.begin(), output.slices.end(),
                                                        [&](const FieldsSpec& slice) { return due(slice); });
  const bool bodies = body_output_ && due(output.bodies);
  const bool save = due(output.checkpoint), report = due(output.report);
  const std::int64_t step = simulation_.steps_done();
  if (ended() || fields || bodies || save || report) simulation_.settle();
  if (simulation_.scene().flow && (step % guard_interval == 0 || ended() || fields || save || report))
    simulation_.look_at_flow();
  if (step % guard_interval == 0 || ended() || save || report) log_departures();
  if (bodies) body_output_->append(simulation_);
  if (due(output.fields)) write_flow_fields(simulation_, output.fields, folder_, provenance_);
  for (const FieldsSpec& slice : output.slices)
    if (due(slice)) write_flow_fields(simulation_, slice, folder_, provenance_);
  // Before the checkpoint that stands for them: a run that is killed in between goes on from the one before.
  if (ended() && save)
    write_report(reason_of_end(), text_of_end(), true);
  else if (report && !ended())
    write_report("running", "", true);
  if (save) checkpoint();
}

/// Collective: what left since the last look goes to the log and to departures.csv.
void Run::log_departures() {
  if (!setup().bodies_leave()) return;
  const std::vector<Departure> left = gathered(comm_, simulation_.take_departures());
  parallel::on_rank_0(comm_, [&] { departures_->append(left); });
  if (!left.empty())
    progress_->log(fmt::format("step {}: {}", simulation_.steps_done(), departures_text(left)));
}

void Run::checkpoint() {
  simulation_.settle();
  log_departures();
  last_checkpoint_ =
      write_checkpoint(simulation_, quantities_, folder_, provenance_, prepared_.steady).string();
  progress_->log(fmt::format("step {}: wrote {}", simulation_.steps_done(), last_checkpoint_));
}

/// Collective: leaves the state that a guard stopped at, for a look at it.
std::string Run::stopped_state_text() {
  try {
    if (simulation_.scene().flow) simulation_.look_at_flow();
  } catch (const CommonGuardStop&) {
    // what else is wrong with that step is not told any more
  }
  try {
    log_departures();
    const auto path = write_stopped_state(simulation_, quantities_, folder_, provenance_, prepared_.steady);
    if (simulation_.scene().flow) write_flow_fields(simulation_, setup().output.fields, folder_, provenance_);
    if (body_output_) body_output_->append(simulation_);
    return fmt::format("\nthe state it stopped in: {}", path.string());
  } catch (const std::exception& error) {
    return fmt::format("\nthe state it stopped in could not be written: {}", common_text(error));
  }
}

std::string Run::last_checkpoint_text() const {
  if (!last_checkpoint_.empty()) return fmt::format("\nlast checkpoint: {}", last_checkpoint_);
  const auto there = adapters::list_checkpoints(folder_);
  if (there.empty()) return "\nno checkpoint has been written (see output.checkpoint)";
  return fmt::format("\nlast checkpoint: {}", there.front().path.string());
}

void Run::greet() {
  const Scene& scene = simulation_.scene();
  if (!prepared_.folder.note.empty()) progress_->say(prepared_.folder.note);
  progress_->log(fmt::format("silt {} ({}), {}, {}, {} ranks, {} blocks, {}, {}\n{}", provenance_.version,
                             provenance_.commit, provenance_.compiler, provenance_.host, scene.ranks,
                             scene.domain.blocks(), instruction_set(), provenance_.created,
                             derived_table(setup())));
  for (const Diagnostic& warning : prepared_.warnings) progress_->say(warning.line());
  const auto& n = setup().cells;
  std::string text = setup().title.empty() ? setup().directory.string() : setup().title;
  if (scene.flow) text += fmt::format(": {} x {} x {} cells", n[0], n[1], n[2]);
  text += fmt::format("{} {} bod{}, {} rank{}", scene.flow ? "," : ":", scene.at_start.body_count,
                      scene.at_start.body_count == 1 ? "y" : "ies", scene.ranks, scene.ranks > 1 ? "s" : "");
  progress_->say(text);
  if (resumed_)
    progress_->say(fmt::format("goes on from step {} to {}{}", first_step_, setup().steps,
                               earlier_options_text(prepared_)));
  progress_->say(fmt::format("results go to {}", folder_.string()));
}

/// Collective: writes report.json, at most once a second while the run goes on but with each checkpoint, and,
/// unless it is there, its row of series.csv.
void Run::write_report(const std::string& reason, const std::string& text, bool sound) {
  const fs::path path = folder_ / "report.json";
  parallel::naming(path.string(), [&] {
    const bool at_end = ended() || reason != "running";
    const RunStatus status{reason, text, first_step_, MPI_Wtime() - begin_, sound, at_end};
    const adapters::Json report = report_of(simulation_, quantities_, status);
    parallel::on_rank_0(comm_, [&] {
      if (series_ && sound) series_->append(simulation_.steps_done(), report);
      if (!at_end && !due(setup().output.checkpoint) && status.wall_seconds < reported_ + 1) return;
      write_text(path, report.text());
      reported_ = status.wall_seconds;
    });
  });
}

/// The end that every rank comes to.
Exit Run::end(Exit code, const std::string& reason, const std::string& text) {
  const bool loud = simulation_.scene().rank == 0;
  if (progress_)
    progress_->finish(simulation_.steps_done(), parallel::max_over_ranks(comm_, simulation_.step_seconds()));
  if (progress_ && code != Exit::failed && code != Exit::guard) judge_sweeps();
  if (!text.empty() && progress_) code == Exit::done ? progress_->say(text) : progress_->log(text);
  if (!text.empty() && loud && code != Exit::done) fmt::print(stderr, "silt: {}\n", text);
  try {
    write_report(reason, text, code != Exit::guard);
  } catch (const std::exception& error) {
    const std::string found = common_text(error);
    if (loud && !text.starts_with(found)) fmt::print(stderr, "silt: {}\n", found);
    if (code == Exit::done) return Exit::failed;
  }
  return code;
}

void Run::fail_alone(Exit code, const std::string& reason, const std::string& what) {
  abort_alone(simulation_, folder_, code, reason, what + last_checkpoint_text());
}

template <class Prepare>
Exit start(const RunOptions& options, MPI_Comm comm, bool resumed, Prepare&& prepare) {
  const int rank = parallel::rank_of(comm);
  const fs::path folder = result_folder(options);
  parallel::Reunion reunion(comm);
  PreparedRun prepared;
  try {
    prepared = prepare(options, comm, folder);
  } catch (const std::exception& error) {
    const bool alone = !reunion.all_here();
    if (alone || rank == 0)
      fmt::print(stderr, "{}{}\n", alone ? fmt::format("silt: rank {}: ", rank) : "",
                 parallel::text_of(error));
    std::fflush(stderr);
    if (alone) MPI_Abort(comm, int(Exit::failed));
    return dynamic_cast<const FileError*>(&error) ? Exit::failed : Exit::bad_case;
  }
  if (const std::string complete = resumed ? complete_text(prepared) : ""; !complete.empty()) {
    if (rank == 0) fmt::print("{}", complete);
    if (!lacks_final_report(folder, *prepared.simulation)) return Exit::done;
  }
  catch_signals();  // until here there is nothing to lose, and they end the program at once
  return Run(std::move(prepared), folder, options, resumed, reunion).go();
}

}  // namespace

Exit run_case(const RunOptions& options, MPI_Comm comm) {
  return start(options, comm, false, prepare_run);
}
Exit resume_case(const RunOptions& options, MPI_Comm comm) {
  return start(options, comm, true, prepare_resume);
}

}  // namespace silt::coupler
