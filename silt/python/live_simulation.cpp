#include "silt/python/live_simulation.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt {

namespace {

PreparedRun prepared_or_unfit(const RunOptions& options, bool resume, MPI_Comm comm) {
  try {
    if (!options.out) return prepare_scene(options, comm);
    return (resume ? prepare_resume : prepare_run)(options, comm, *options.out);
  } catch (const std::exception& error) {
    throw UnfitCase(error.what());
  }
}

}  // namespace

LiveSimulation::Files::Files(PreparedRun& run, const std::filesystem::path& folder)
    : progress(run.extent(), run.simulation->scene().rank() == 0, false), outputs(run, folder, progress) {
  parallel::together(run.simulation->scene().comm, [&] { progress.open_log(folder / "run.log"); });
  outputs.begin_log();
  outputs.start();
}

LiveSimulation::LiveSimulation(const RunOptions& options, bool resume, MPI_Comm comm) {
  const RunArithmetic arithmetic;
  prepared_ = prepared_or_unfit(options, resume, comm);
  if (options.out) with([&](Simulation&) { files_ = std::make_unique<Files>(prepared_, *options.out); });
  for (const Diagnostic& warning : prepared_.warnings) warnings_.push_back(warning.line());
  static const bool told = [] {  // attributes of MPI_COMM_SELF are deleted first when MPI is finalised
    int key = MPI_KEYVAL_INVALID;
    MPI_Comm_create_keyval(MPI_COMM_NULL_COPY_FN, end_all, &key, nullptr);
    MPI_Comm_set_attr(MPI_COMM_SELF, key, nullptr);
    return true;
  }();
  (void)told;
  living().push_back(this);
}

LiveSimulation::~LiveSimulation() {
  std::erase(living(), this);
}

Simulation& LiveSimulation::get() {
  if (!prepared_.simulation) throw std::runtime_error("the simulation has ended: MPI is finalised");
  return *prepared_.simulation;
}

void LiveSimulation::step() {
  with([&](Simulation& simulation) {
    if (!files_) return simulation.step();
    if (finished_)
      throw std::invalid_argument(
          fmt::format("step {} was the last one: its report says how it ended; for more raise run.steps",
                      simulation.steps_done()));
    try {
      simulation.step();
      prepared_.quantities->observe(simulation);
      prepared_.watch();
      files_->outputs.write_due();
    } catch (const GuardStop& stop) {
      if (simulation.scene().ranks() > 1 && !dynamic_cast<const CommonGuardStop*>(&stop)) throw;
      end_files("guard", stop.what(), false);
      throw;
    }
    files_->progress.step(simulation.steps_done(), simulation.step_seconds());
  });
  if (files_ && has_ended()) finish();
}

void LiveSimulation::finish() {
  if (!files_ || finished_) return;
  with([&](Simulation& simulation) {
    if (has_ended()) return end_files(prepared_.reason_of_end(), prepared_.text_of_end(), true);
    const auto& coarsening = simulation.setup().coarsening;  // ends a step of the coarsest cells
    if (coarsening && simulation.steps_done() % coarsening->stride() != 0)
      throw std::invalid_argument(
          fmt::format("finish: cells of several levels end their steps together each {} steps; {} are done",
                      coarsening->stride(), simulation.steps_done()));
    const std::string text = fmt::format("the program ended it at step {}", simulation.steps_done());
    files_->outputs.interrupt(text);
    end_files("interrupted", text, true);
  });
}

void LiveSimulation::end_files(const std::string& reason, const std::string& text, bool sound) {
  finished_ = true;
  Simulation& simulation = get();
  files_->progress.finish(simulation.steps_done(),
                          parallel::max_over_ranks(simulation.scene().comm, simulation.step_seconds()));
  if (!text.empty()) files_->progress.log(text);
  files_->outputs.write_report(reason, text, sound);
  prepared_.folder.lock.reset();
}

int LiveSimulation::end_all(MPI_Comm, int, void*, void*) {
  for (LiveSimulation* const one : living()) one->files_.reset(), one->prepared_ = {};
  return MPI_SUCCESS;
}

std::vector<LiveSimulation*>& LiveSimulation::living() {
  static std::vector<LiveSimulation*> all;
  return all;
}

void LiveSimulation::end_alone(const std::string& text) const {
  fmt::print(stderr, "silt: {}\n", text);
  std::fflush(nullptr);
  MPI_Abort(MPI_COMM_WORLD, 1);
  std::abort();
}

}  // namespace silt
