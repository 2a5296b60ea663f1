#include "silt/run/prepare_run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <thread>

#include "adapters/automatic/collision_factory.hpp"
#include "lbm/walls/cut_links.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_file.hpp"
#include "silt/placement/given_bodies.hpp"
#include "silt/results/body_output.hpp"
#include "silt/results/checkpoint.hpp"
#include "silt/results/definitions.hpp"
#include "silt/run/run_estimate.hpp"

namespace silt {

namespace fs = std::filesystem;

namespace {

/// Returns an argument, quoted for a shell if necessary.
std::string quoted(const std::string& argument) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) || std::strchr("/._-+=:,@%", c); };
  const std::string path = argument.starts_with('-') ? "./" + argument : argument;
  if (!path.empty() && std::all_of(path.begin(), path.end(), plain)) return path;
  std::string text = "'";
  for (const char c : path) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// Throws errors of building the scene early, while ranks can still report them together.
void require_buildable(const Case& setup, int ranks) {
  if (const std::string why = unusable(setup.device); !why.empty())
    throw CaseError(setup.place("run.device"),
                    fmt::format("run.device is \"{}\": {}", device_names[std::size_t(setup.device)], why));
  const lbm::Domain domain = coupler::make_domain(setup, ranks);
  for (int b = 0; setup.fluid && !setup.coarsening && setup.has_surfaces() && b < domain.blocks(); ++b)
    if (domain.block(b).box.cells() > lbm::most_cells_with_links)
      throw CaseError(
          setup.place(setup.block_cells ? "domain.blocks" : "domain.size"),
          fmt::format(
              "a block of {} cells has bodies or walls in it; at most {} are possible: use more ranks, "
              "or smaller domain.blocks",
              domain.block(b).box.cells(), lbm::most_cells_with_links));
  adapters::make_backend(setup.contacts.backend);
  adapters::make_broad_phase("auto", setup.contacts.backend);
}

/// Returns the memory, in bytes, of all machines of the ranks. Collective.
double memory_of_machines(MPI_Comm comm) {
  MPI_Comm machine;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  const bool speaks = parallel::rank_of(machine) == 0;
  MPI_Comm_free(&machine);
  const double here = speaks ? 1. * sysconf(_SC_PHYS_PAGES) * sysconf(_SC_PAGE_SIZE) : 0;
  return parallel::sum_over_ranks(comm, here);
}

/// Throws CaseError if the fluid does not fit this memory, even with the coarsest cells alone.
void require_memory(const Case& setup, double here) {
  const double needed = fluid_memory(setup) / (setup.coarsening ? 1 << 3 * setup.coarsening->levels : 1);
  if (needed > here)
    throw CaseError(
        setup.place("domain.size"),
        fmt::format("the fluid needs {:.0f} GB, and the machines of this run have {:.0f} GB together: "
                    "use larger cells, or more machines",
                    needed / 1e9, here / 1e9));
}

/// Chooses a GPU of its machine for each rank, and adds warnings. Collective.
void choose_card(const Case& setup, MPI_Comm comm, std::vector<Diagnostic>& warnings) {
  MPI_Comm machine;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  const std::string note = choose(setup.device, parallel::rank_of(machine), parallel::ranks_of(machine));
  MPI_Comm_free(&machine);
  if (!note.empty()) warnings.push_back({Diagnostic::Severity::warning, setup.place("run.device"), note});
}

/// Returns the number of machines like this one, with one rank per core, that the ranks of a check need.
double machines_for(int ranks) {
  const double cores = std::max(1u, std::thread::hardware_concurrency());
  return ranks > parallel::ranks_of(MPI_COMM_WORLD) ? std::ceil(ranks / cores) : 1;
}

/// Reads a case on rank 0 and broadcasts its files; checks it, makes the run's quantities. Collective.
template <class Read>
std::unique_ptr<Case> judged_once(const fs::path& directory, MPI_Comm comm, PreparedRun& prepared,
                                  Read&& read) {
  CaseSource source;
  std::unique_ptr<Case> setup;
  parallel::on_rank_0(comm, [&] {
    source = read_source(directory);
    setup = std::make_unique<Case>(read(source));
  });
  broadcast(comm, source);
  parallel::together(comm, [&] {
    if (!setup) setup = std::make_unique<Case>(read(source));
  });
  parallel::together(comm, [&] {
    prepared.warnings = require_runnable(*setup);
    prepared.quantities = std::make_unique<Quantities>(*setup);
    if (setup->steady) prepared.steady.emplace(setup->steady->change);
  });
  require_memory(*setup, memory_of_machines(comm));
  parallel::together(comm, [&] { require_buildable(*setup, parallel::ranks_of(comm)); });
  choose_card(*setup, comm, prepared.warnings);
  return setup;
}

/// As on_rank_0, but throws a FileError of rank 0 as such on every rank. Collective.
template <class Make>
ReadyFolder folder_on_rank_0(MPI_Comm comm, Make&& make) {
  ReadyFolder ready;
  int of_system = 0;
  const auto attempt = [&] {
    try {
      ready = make();
    } catch (const FileError&) {
      of_system = 1;
      throw;
    }
  };
  try {
    parallel::on_rank_0(comm, attempt);
  } catch (const std::exception& error) {
    parallel::broadcast(comm, of_system);
    if (of_system) throw FileError(error.what());
    throw;
  }
  return ready;
}

/// Opens the first sound checkpoint, notes those skipped; throws the first error if none. Collective.
std::unique_ptr<adapters::CheckpointReader> first_sound_checkpoint(
    const std::vector<adapters::StepFile>& there, MPI_Comm comm, std::string& note) {
  std::exception_ptr first;
  for (const adapters::StepFile& checkpoint : there) try {
      return std::make_unique<adapters::CheckpointReader>(comm, checkpoint.path);
    } catch (const std::runtime_error& error) {  // on every rank
      if (!first) first = std::current_exception();
      note += fmt::format("{}passed over: {}", note.empty() ? "" : "\n", error.what());
    }
  std::rethrow_exception(first);
}

/// Opens the checkpoint with which a case starts, and adds warnings about it; null without one. Collective.
std::unique_ptr<adapters::CheckpointReader> checkpoint_of_start(const Case& setup, MPI_Comm comm,
                                                                std::vector<Diagnostic>& warnings) {
  if (!setup.start) return nullptr;
  const fs::path from = setup.directory / setup.start->from;
  auto there = adapters::list_checkpoints(from);
  if (from.extension() == ".h5") there = {{0, from}};
  if (there.empty())
    throw CaseError(setup.place("initial.from"),
                    fs::exists(from)
                        ? fmt::format("initial.from is '{}', and there is no checkpoint in {}; let the other "
                                      "run write one at its end (output.checkpoint), or name one",
                                      setup.start->from, from.string())
                        : fmt::format("initial.from is '{}', and {} does not exist; name the folder of the "
                                      "other run's results, from that of the case",
                                      setup.start->from, from.lexically_normal().string()));
  std::string note;
  auto reader = first_sound_checkpoint(there, comm, note);
  if (!note.empty()) warnings.push_back({Diagnostic::Severity::warning, setup.place("initial.from"), note});
  find_idle_keys_at_start(*reader, setup, warnings);
  return reader;
}

}  // namespace

std::string examine_case(const RunOptions& options) {
  const Case setup = read_case(options.directory, options.overrides);
  auto warnings = require_runnable(setup);
  const int ranks = options.ranks > 0 ? options.ranks : parallel::ranks_of(MPI_COMM_WORLD);
  require_memory(setup, memory_of_machines(MPI_COMM_WORLD) * machines_for(ranks));
  require_buildable(setup, ranks);
  require_sound_start(setup, coupler::make_domain(setup, 1), MPI_COMM_SELF);
  const Quantities quantities(setup);
  if (setup.output.bodies.every > 0) drawn_kinds(setup);
  const auto start = checkpoint_of_start(setup, MPI_COMM_SELF, warnings);
  const auto there = start ? start_from(*start, setup).bodies.records : std::vector<rigid::BodyRecord>();
  const RunEstimate estimate = estimate_run(setup, there, ranks);
  if (const auto found = time_warning(setup, estimate)) warnings.push_back(*found);
  if (const auto found = disk_warning(setup, estimate.disk, result_folder(options)))
    warnings.push_back(*found);
  warnings.insert(warnings.end(), estimate.doubts.begin(), estimate.doubts.end());
  const std::string begins =
      start ? fmt::format("  {:<24}  {}\n", "begins at the end of", start->path().lexically_normal().string())
            : "";
  return derived_table(setup) + begins + estimate_table(setup, estimate) + listed(warnings);
}

RunExtent PreparedRun::extent() const {
  const Case& setup = simulation->setup();
  return {first_step, setup.steps, setup.fluid ? setup.volume() : 0, setup.units};
}

void PreparedRun::watch() {
  const Case& setup = simulation->setup();
  if (!steady || simulation->steps_done() % setup.steady->every != 0) return;
  steady->look(quantities->evaluate(*simulation, setup.steady->quantity));
}

bool PreparedRun::has_ended() const {
  return simulation->steps_done() >= simulation->setup().steps || is_steady();
}

std::string PreparedRun::text_of_end() const {
  if (!is_steady()) return "";
  const Case& setup = simulation->setup();
  return fmt::format("{} is steady at {}, to {} of it, and ends the run at step {} of {} (run.steady)",
                     setup.steady->quantity, shown(steady->state().value), shown(setup.steady->change),
                     simulation->steps_done(), setup.steps);
}

std::string arguments_of(const RunOptions& options) {
  return quoted(options.directory.string()) + (options.out ? " --out " + quoted(options.out->string()) : "");
}

fs::path result_folder(const RunOptions& options) {
  if (options.out) return *options.out;
  const bool is_file = options.directory.extension() == ".toml";
  return (is_file ? options.directory.parent_path() : options.directory) / "out";
}

PreparedRun prepare_scene(const RunOptions& options, MPI_Comm comm) {
  PreparedRun prepared;
  const auto setup = judged_once(options.directory, comm, prepared,
                                 [&](CaseSource& source) { return read_case(source, options.overrides); });
  if (const auto reader = checkpoint_of_start(*setup, comm, prepared.warnings)) {
    prepared.started_from = reader->path().lexically_normal();
    prepared.simulation = simulation_from(*reader, std::move(*setup), comm);
  } else {
    prepared.simulation = std::make_unique<Simulation>(std::move(*setup), comm);
    prepared.simulation->start_quietly();
  }
  const Scene& made = prepared.simulation->scene();
  if (const auto found = inlet_warning(made.setup, prepared.simulation->bodies(), made.world, comm))
    prepared.warnings.push_back(*found);
  if (prepared.simulation->setup().output.mean) prepared.mean.emplace(*prepared.simulation);
  return prepared;
}

PreparedRun prepare_run(const RunOptions& options, MPI_Comm comm, const fs::path& folder) {
  PreparedRun prepared = prepare_scene(options, comm);
  const Scene& made = prepared.simulation->scene();
  if (const auto found = disk_warning(made.setup, disk_needed(made.setup, made.at_start.body_count), folder))
    prepared.warnings.push_back(*found);
  prepared.folder = folder_on_rank_0(comm, [&] { return prepare_result_folder(folder, options.overwrite); });
  return prepared;
}

PreparedRun prepare_resume(const RunOptions& options, MPI_Comm comm, const fs::path& folder) {
  require_folder(folder);
  auto there = adapters::list_checkpoints(folder);
  const bool is_nothing = there.empty() && !options.checkpoint;
  ReadyFolder ready;
  if (!is_nothing ||
      fs::exists(folder))  // where a run may be before its first checkpoint, which the lock tells
    ready = folder_on_rank_0(comm, [&] { return return_to_result_folder(folder); });
  if (is_nothing) {
    parallel::on_rank_0(comm, [&] { read_source(options.directory); });  // throws if there is no such case
    throw std::runtime_error(
        fmt::format("{}: there is no checkpoint to go on from; start the run with: silt run {}",
                    folder.string(), arguments_of(options)));
  }
  if (options.checkpoint) there = {{0, *options.checkpoint}};
  const auto first_sound = first_sound_checkpoint(there, comm, ready.note);
  const adapters::CheckpointReader& reader = *first_sound;
  PreparedRun prepared;
  const CaseOrigin origin = read_origin(reader);
  if (const auto earlier = earlier_options(origin, options.overrides); !earlier.empty())
    prepared.earlier_options =
        fmt::format(", where {} of the earlier run still holds, until it is set again", earlier);
  const auto setup = judged_once(options.directory, comm, prepared, [&](CaseSource& source) {
    return case_to_resume(origin, source, options.overrides);
  });
  parallel::together(comm, [&] {
    prepared.quantities->set_history(read_history(reader, *setup));
    prepared.quantities->set_means(read_means(reader, *setup));
    prepared.steady = read_steady_watch(reader, *setup);
    std::ranges::move(begun_anew(reader, *setup), std::back_inserter(prepared.warnings));
  });
  prepared.simulation = resumed_simulation(reader, std::move(*setup), comm);
  if (prepared.simulation->setup().output.mean) {
    prepared.mean.emplace(*prepared.simulation);
    prepared.mean->restore(reader, *prepared.simulation);
  }
  prepared.folder = std::move(ready);
  prepared.resumed = true;
  prepared.first_step = prepared.simulation->steps_done();
  return prepared;
}

}  // namespace silt
