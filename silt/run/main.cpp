// The program `silt`: its command line.
#include <fmt/format.h>
#include <mpi.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "cpu/isa.hpp"
#include "device/device.hpp"
#include "parallel/together.hpp"
#include "silt/case/case_error.hpp"
#include "silt/case/case_file.hpp"
#include "silt/results/build_info.hpp"
#include "silt/run/run.hpp"

namespace silt {
namespace {

struct CommandLine {
  RunOptions run;
  std::vector<std::string> unset;
  std::string case_directory, out, backend, device, checkpoint, file;
  std::int64_t steps = 0;
};

/// Makes options; --backend, --device and --steps stand for --set, and --unset is applied last.
RunOptions options_of(const CommandLine& line) {
  RunOptions options = line.run;
  options.directory = line.case_directory;
  if (!line.out.empty()) options.out = line.out;
  if (!line.checkpoint.empty()) options.checkpoint = line.checkpoint;
  if (!line.device.empty()) options.overrides.push_back("run.device=\"" + line.device + "\"");
  if (!line.backend.empty()) options.overrides.push_back("contacts.backend=\"" + line.backend + "\"");
  if (line.steps > 0) options.overrides.push_back(fmt::format("run.steps={}", line.steps));
  for (const std::string& key : line.unset) options.overrides.push_back(key + "=");
  return options;
}

Exit check(const CommandLine& line, bool loud) {
  try {
    const std::string found = examine_case(options_of(line));
    if (loud) fmt::print("{}", found);
    return Exit::done;
  } catch (const std::exception& error) {
    if (loud) fmt::print(stderr, "{}\n", parallel::text_of(error));
    return Exit::bad_case;
  }
}

Exit info(const CommandLine& line, bool loud) {
  if (!loud) return Exit::done;
  try {
    fmt::print("{}", describe_case(line.file));
    return Exit::done;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", parallel::text_of(error));
    return Exit::bad_case;
  }
}

/// Prints every key of a case whose path begins with a text, one per line.
Exit keys(const std::string& beginning, bool loud) {
  if (!loud) return Exit::done;
  bool found = false;
  for (const KeySection& section : case_keys())
    for (const KeyText& key : section.keys) {
      const std::string path = section.path + (section.path.empty() ? "" : ".") + key.name;
      if (!path.starts_with(beginning)) continue;
      found = true;
      fmt::print("{}  {}{}{}; default {}: {}\n", path, key.type, key.unit.empty() ? "" : ", ", key.unit,
                 key.fallback, key.meaning);
    }
  if (found) return Exit::done;
  fmt::print(stderr, "no key of a case begins with '{}'; `silt keys` lists all\n", beginning);
  return Exit::bad_case;
}

/// Accepts positive numbers, but not nan as CLI::PositiveNumber does, and without its message about the
/// largest double. Writes whole numbers as such, e.g. 1e3.
const CLI::Validator above_zero(
    [](std::string& text) {
      constexpr double exact = 0x1p53;
      double x = 0;
      const bool good = CLI::detail::lexical_cast(text, x) && std::isfinite(x) && x > 0;
      if (good && x <= exact && x == std::trunc(x)) text = fmt::format("{:.0f}", x);
      return good ? "" : fmt::format("{} is not a number above 0", text);
    },
    "");

const CLI::Validator with_a_value(complaint_of_set, "");
const CLI::Validator without_a_value(complaint_of_unset, "");

void add_case(CLI::App& command, CommandLine& line) {
  command.add_option("CASE", line.case_directory, "case directory, or a .toml file")->required();
  command.add_option("--set", line.run.overrides, "key.path=value: another value for a key of the case")
      ->take_all()
      ->expected(1)
      ->check(with_a_value)
      ->type_name("KEY=VALUE");
  command
      .add_option("--unset", line.unset,
                  "key.path: the case without this key, table or entry of a list, after all --set")
      ->take_all()
      ->expected(1)
      ->check(without_a_value)
      ->type_name("KEY");
}

void add_run(CLI::App& command, CommandLine& line) {
  add_case(command, line);
  command.add_option("--out", line.out, "folder for the results (CASE/out)")->type_name("DIR");
  command.add_option("--device", line.device, "where the fluid's passes run: cpu, gpu, host")
      ->type_name("NAME");
  command.add_option("--steps", line.steps, "short for --set run.steps=N")
      ->transform(above_zero)
      ->type_name("N");
  command
      .add_option("--time-limit", line.run.time_limit,
                  "stop with a checkpoint after so many seconds of wall-clock time")
      ->transform(above_zero)
      ->type_name("SECONDS");
}

/// Returns e.g. "Open MPI v4.1.4".
std::string mpi_version() {
  char text[MPI_MAX_LIBRARY_VERSION_STRING];
  int length = 0;
  MPI_Get_library_version(text, &length);
  const std::string all(text, length);
  return all.substr(0, all.find_first_of(",\n"));
}

std::string version_text() {
  const std::string card = unusable(Device::gpu).empty() ? "\n" + description(Device::gpu) : "";
  return fmt::format("silt {} ({}), {}, {}\n{}, {}{}", build_info().version, build_info().commit,
                     build_info().compiler, instruction_set(), mpi_version(), build_info().libraries, card);
}

/// Returns the error for a first word that is not a subcommand, or "".
std::string wrong_subcommand(const CLI::App& app, const std::string& word) {
  if (word.empty() || word[0] == '-') return "";
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  if (std::count(names.begin(), names.end(), word) > 0) return "";
  return fmt::format("silt: there is no subcommand '{}'{}\n", word, suggestion(word, names));
}

Exit main_on(MPI_Comm comm, int argc, char** argv) {
  const int rank = parallel::rank_of(comm);
  const bool loud = rank == 0;
  CommandLine line;
  CLI::App app("Silt: rigid bodies in a fluid, both fully resolved");
  app.footer(
      "exit codes: 0 done, 1 a file could not be written or the like, 2 bad case or usage, 3 stopped by a "
      "guard,\n"
      "4 interrupted, with a checkpoint\n"
      "environment variables: SILT_PLAIN, SILT_ISA, SILT_LAST_CACHE (cases/README.md)");
  app.set_version_flag("--version", version_text);
  app.require_subcommand(1);
  CLI::App* run =
      app.add_subcommand("run", "runs a case; results of an earlier run are moved to out.1, out.2, ...");
  CLI::App* resume = app.add_subcommand(
      "resume", "continues from the newest checkpoint, with the --set and --steps of the earlier run");
  CLI::App* checks =
      app.add_subcommand("check", "says what is wrong with a case and what follows from it; runs nothing");
  CLI::App* infos = app.add_subcommand("info", "says what a case is and what results it has");
  CLI::App* lists =
      app.add_subcommand("keys", "lists the keys that a case may have, as cases/README.md does");
  lists->add_option("BEGINNING", line.file, "only those that begin so: fluid, output.slices");
  add_run(*run, line);
  run->add_option("--backend", line.backend, "collision backend: auto, analytic, bullet, fcl")
      ->type_name("NAME");
  run->add_flag("--overwrite,--force", line.run.overwrite,
                "delete the results of an earlier run instead of moving them");
  add_run(*resume, line);
  resume->add_option("--checkpoint", line.checkpoint, "go on from this one")->type_name("FILE");
  add_case(*checks, line);
  checks
      ->add_option("-n,--ranks", line.run.ranks,
                   "estimate a run on this number of ranks (by default the present one)")
      ->transform(above_zero)
      ->type_name("N");
  infos->add_option("WHAT", line.file, "a case or a folder of results")->required();
  if (const std::string complaint = wrong_subcommand(app, argc > 1 ? argv[1] : ""); !complaint.empty()) {
    if (loud) fmt::print(stderr, "{}", complaint);
    return Exit::bad_case;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (loud) app.exit(error);
    return error.get_exit_code() == 0 ? Exit::done : Exit::bad_case;
  }
  if (const std::string complaint = environment_error(); !complaint.empty()) {
    if (loud) fmt::print(stderr, "silt: {}\n", complaint);
    return Exit::bad_case;
  }
  if (checks->parsed()) return check(line, loud);
  if (infos->parsed()) return info(line, loud);
  if (lists->parsed()) return keys(line.file, loud);
  return resume->parsed() ? resume_case(options_of(line), comm) : run_case(options_of(line), comm);
}

}  // namespace
}  // namespace silt

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // so that writes beyond `ulimit -f` fail like others
  silt::start_mpi(&argc, &argv);
  int code = 1;
  try {
    code = int(silt::main_on(MPI_COMM_WORLD, argc, argv));
  } catch (const std::exception& error) {
    fmt::print(stderr, "silt: {}\n", silt::parallel::text_of(error));
    std::fflush(nullptr);
    MPI_Abort(MPI_COMM_WORLD, code);
  }
  MPI_Finalize();
  return code;
}
