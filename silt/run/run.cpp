#include "silt/run/run.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "parallel/collectives.hpp"
#include "parallel/together.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/guard.hpp"
#include "silt/results/report.hpp"
#include "silt/run/prepare_run.hpp"
#include "silt/run/progress.hpp"
#include "silt/run/run_outputs.hpp"
#include "silt/run/stop_request.hpp"

namespace silt {

namespace fs = std::filesystem;

namespace {

class Run {
 public:
  Run(PreparedRun prepared, const fs::path& folder, const RunOptions&, parallel::ErrorBarrier&);
  Exit go();

 private:
  const Case& setup() const { return simulation_.setup(); }
  bool is_alone() const { return simulation_.scene().ranks() == 1; }
  void greet();
  void advance();
  Exit end(Exit, const std::string& reason, const std::string& text);
  [[noreturn]] void fail_alone(Exit, const std::string& reason, const std::string& what);
  std::string of_rank(int rank, std::int64_t step, const std::string& text) const;
  std::string common_text(const std::exception&);
  std::string stopped_state_text();

  PreparedRun prepared_;
  Simulation& simulation_;
  const fs::path folder_;
  const std::string resume_with_;  // arguments for silt resume
  StopRequest stop_request_;
  parallel::ErrorBarrier& reunion_;
  Progress progress_;
  RunOutputs outputs_;
};

Run::Run(PreparedRun prepared, const fs::path& folder, const RunOptions& options,
         parallel::ErrorBarrier& reunion)
    : prepared_(std::move(prepared)),
      simulation_(*prepared_.simulation),
      folder_(folder),
      resume_with_(arguments_of(options)),
      stop_request_(simulation_.scene().comm, options.time_limit),
      reunion_(reunion),
      progress_(prepared_.extent(), simulation_.scene().rank() == 0),
      outputs_(prepared_, folder_, progress_) {}

Exit Run::go() {
  try {
    parallel::together(simulation_.scene().comm, [&] { progress_.open_log(folder_ / "run.log"); });
    greet();
    outputs_.start();
    while (!prepared_.has_ended()) {
      advance();
      prepared_.watch();
      outputs_.write_due();
      const auto& coarsening = simulation_.setup().coarsening;  // ends a step of the coarsest cells
      if (coarsening && simulation_.steps_done() % coarsening->stride() != 0) continue;
      const std::string why = stop_request_.why(simulation_.steps_done());
      if (why.empty() || prepared_.has_ended()) continue;
      const std::string text = fmt::format("{} at step {}; go on with: silt resume {}", why,
                                           simulation_.steps_done(), resume_with_);
      outputs_.interrupt(text);
      return end(Exit::interrupted, "interrupted", text);
    }
    return end(Exit::done, prepared_.reason_of_end(), prepared_.text_of_end());
  } catch (const GuardStop& stop) {  // on every rank
    return end(Exit::guard, "guard", stop.what() + stopped_state_text() + outputs_.last_checkpoint_text());
  } catch (const std::exception& error) {
    return end(Exit::failed, "error", common_text(error) + outputs_.last_checkpoint_text());
  }
}

std::string Run::of_rank(int rank, std::int64_t step, const std::string& text) const {
  return is_alone() ? text : fmt::format("step {}, rank {}: {}", step, rank, text);
}

/// Returns the text of an error with its rank. Ends all ranks if only this one has an error. Collective.
std::string Run::common_text(const std::exception& error) {
  const auto* common = dynamic_cast<const parallel::CommonError*>(&error);
  const std::string text = of_rank(common ? common->rank : simulation_.scene().rank(),
                                   simulation_.steps_done(), parallel::text_of(error));
  if (!is_alone() && !reunion_.all_ranks_arrive()) fail_alone(Exit::failed, "error", text);
  return text;
}

/// Does one step. An error of this rank alone ends all ranks, as the others wait for it.
void Run::advance() {
  const int rank = simulation_.scene().rank();
  try {
    simulation_.step();
    prepared_.quantities->observe(simulation_);
  } catch (const CommonGuardStop&) {
    throw;
  } catch (const GuardStop& stop) {
    if (is_alone()) throw;
    fail_alone(Exit::guard, "guard", stop.what());
  } catch (const std::overflow_error& error) {
    const std::string text = overflow_text(setup(), error.what(), simulation_.steps_done() + 1, rank);
    if (is_alone()) throw GuardStop(text);
    fail_alone(Exit::guard, "guard", text);
  } catch (const std::exception& error) {
    if (is_alone()) throw;
    fail_alone(Exit::failed, "error", of_rank(rank, simulation_.steps_done() + 1, parallel::text_of(error)));
  }
  progress_.step(simulation_.steps_done(), simulation_.step_seconds());
}

/// Writes the state that a guard stopped at; returns a text. Collective.
std::string Run::stopped_state_text() {
  try {
    if (simulation_.scene().flow) simulation_.checked_totals();
  } catch (const CommonGuardStop&) {
    // one fault of the step is reported
  }
  try {
    return fmt::format("\nthe state it stopped in: {}", outputs_.write_stopped_state().string());
  } catch (const std::exception& error) {
    return fmt::format("\nthe state it stopped in could not be written: {}", common_text(error));
  }
}

void Run::greet() {
  const Scene& scene = simulation_.scene();
  outputs_.begin_log();
  const auto& n = setup().cells;
  std::string text = setup().title.empty() ? setup().directory.string() : setup().title;
  if (scene.flow) text += fmt::format(": {} x {} x {} cells", n[0], n[1], n[2]);
  text +=
      fmt::format("{} {} bod{}, {} rank{}", scene.flow ? "," : ":", scene.at_start.body_count,
                  scene.at_start.body_count == 1 ? "y" : "ies", scene.ranks(), scene.ranks() > 1 ? "s" : "");
  progress_.say(text);
  if (prepared_.resumed)
    progress_.say(fmt::format("goes on from step {} to {}{}", prepared_.first_step, setup().steps,
                              prepared_.earlier_options));
  if (!prepared_.started_from.empty())
    progress_.say(fmt::format("begins at the end of {}", prepared_.started_from.string()));
  if (const std::int64_t steps = quiet_start_steps(setup()); steps > 0 && !prepared_.resumed)
    progress_.say(fmt::format(
        "starts with the pressure that balances the loads, found in {} steps (fluid.quiet_start)", steps));
  progress_.say(fmt::format("results go to {}", folder_.string()));
}

/// Ends the run on all ranks together.
Exit Run::end(Exit code, const std::string& reason, const std::string& text) {
  const bool loud = simulation_.scene().rank() == 0;
  progress_.finish(simulation_.steps_done(),
                   parallel::max_over_ranks(simulation_.scene().comm, simulation_.step_seconds()));
  if (code != Exit::failed && code != Exit::guard)
    for (const std::string& warning : warnings_of(simulation_)) progress_.say("warning: " + warning);
  if (!text.empty()) code == Exit::done ? progress_.say(text) : progress_.log(text);
  if (!text.empty() && loud && code != Exit::done) fmt::print(stderr, "silt: {}\n", text);
  try {
    outputs_.write_report(reason, text, code != Exit::guard);
  } catch (const std::exception& error) {
    const std::string found = common_text(error);
    if (loud && !text.starts_with(found)) fmt::print(stderr, "silt: {}\n", found);
    if (code == Exit::done) return Exit::failed;
  }
  return code;
}

/// Ends a run with an error of this rank alone, while others wait: reports it on stderr and in run.log,
/// writes a short report.json and calls MPI_Abort. If several ranks fail alone, only the one that can create
/// the file `last_words` reports.
void Run::fail_alone(Exit code, const std::string& reason, const std::string& what) {
  const std::string text = what + outputs_.last_checkpoint_text();
  const fs::path part = folder_ / last_words;
  const int file = open(part.c_str(), O_CREAT | O_EXCL | O_WRONLY, 0644);
  if (file >= 0 || errno != EEXIST) {
    fmt::print(stderr, "\nsilt: {}\n", text);
    std::fflush(stderr);
    const std::string report =
        last_report({reason, text}, simulation_.steps_done(), simulation_.scene().ranks());
    std::error_code ignored;  // reported on stderr before
    if (file >= 0 && write(file, report.data(), report.size()) == ssize_t(report.size()) && fsync(file) == 0)
      fs::rename(part, folder_ / "report.json", ignored);
    else
      fs::remove(part, ignored);
    if (std::FILE* log = std::fopen((folder_ / "run.log").c_str(), "a")) {
      fmt::print(log, "{}\n", text);
      std::fclose(log);
    }
  } else {
    sleep(1);  // lets the reporting rank finish first
  }
  MPI_Abort(simulation_.scene().comm, int(code));
  std::abort();
}

// ---- before the first step ----

/// Returns why a resumed run has no step left, or "".
std::string complete_text(const PreparedRun& prepared) {
  const Case& setup = prepared.simulation->setup();
  const std::int64_t step = prepared.simulation->steps_done();
  if (!prepared.resumed || !prepared.has_ended()) return "";
  if (step >= setup.steps)
    return fmt::format(
        "the run is complete: it has done {} of {} steps{}; to go on, raise run.steps (--set run.steps={})\n",
        step, setup.steps, prepared.earlier_options, 2 * setup.steps);
  return fmt::format(
      "the run is complete: {} was steady at step {}; to go on, lower run.steady.change (--set "
      "run.steady.change={})\n",
      setup.steady->quantity, step, shown(setup.steady->change / 10));
}

/// Returns whether a file is the report of a run that ended at this step.
bool is_final_report(const fs::path& path, std::int64_t step) {
  std::ifstream file(path);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto says = [&](const std::string& member) { return text.find(member) != std::string::npos; };
  return says("\"steps\": " + std::to_string(step) + ",") &&
         (says("\"exit_reason\": \"completed\"") || says("\"exit_reason\": \"steady\""));
}

/// Returns whether report.json is not the report of the end. Collective.
bool lacks_final_report(const fs::path& folder, const Simulation& simulation) {
  const std::int64_t step = simulation.steps_done();
  if (step > simulation.setup().steps) return false;
  int lacks = 0;
  parallel::on_rank_0(simulation.scene().comm,
                      [&] { lacks = !is_final_report(folder / "report.json", step); });
  parallel::broadcast(simulation.scene().comm, lacks);
  return lacks;
}

template <class Prepare>
Exit start(const RunOptions& options, MPI_Comm comm, Prepare&& prepare) {
  const int rank = parallel::rank_of(comm);
  const fs::path folder = result_folder(options);
  parallel::ErrorBarrier reunion(comm);
  PreparedRun prepared;
  try {
    prepared = prepare(options, comm, folder);
  } catch (const std::exception& error) {
    const bool alone = !reunion.all_ranks_arrive();
    if (alone || rank == 0)
      fmt::print(stderr, "{}{}\n", alone ? fmt::format("silt: rank {}: ", rank) : "",
                 parallel::text_of(error));
    std::fflush(stderr);
    if (alone) MPI_Abort(comm, int(Exit::failed));
    return dynamic_cast<const FileError*>(&error) ? Exit::failed : Exit::bad_case;
  }
  if (const std::string complete = complete_text(prepared); !complete.empty()) {
    if (rank == 0) fmt::print("{}", complete);
    if (!lacks_final_report(folder, *prepared.simulation)) return Exit::done;
  }
  catch_signals();  // signals before this end the program at once
  return Run(std::move(prepared), folder, options, reunion).go();
}

}  // namespace

Exit run_case(const RunOptions& options, MPI_Comm comm) {
  return start(options, comm, prepare_run);
}
Exit resume_case(const RunOptions& options, MPI_Comm comm) {
  return start(options, comm, prepare_resume);
}

}  // namespace silt
