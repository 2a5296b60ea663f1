#include "coupler/run/abort_alone.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "adapters/json/json.hpp"
#include "coupler/results/result_folder.hpp"

namespace silt::coupler {

namespace fs = std::filesystem;

namespace {

/// Writes the report into the open file and gives it its name, if it could be created.
void leave_report(const adapters::Json& report, int file, const fs::path& part, const fs::path& name) {
  const std::string content = report.text() + "\n";
  std::error_code ignored;  // it has been said on stderr
  if (file >= 0 && write(file, content.data(), content.size()) == ssize_t(content.size()) && fsync(file) == 0)
    fs::rename(part, name, ignored);
  else
    fs::remove(part, ignored);
}

}  // namespace

void abort_alone(const Simulation& simulation, const fs::path& folder, Exit code, const std::string& reason,
                 const std::string& text) {
  const fs::path part = folder / last_words;
  const int file = open(part.c_str(), O_CREAT | O_EXCL | O_WRONLY, 0644);
  if (file >= 0 || errno != EEXIST) {
    fmt::print(stderr, "\nsilt: {}\n", text);
    std::fflush(stderr);
    adapters::Json report = adapters::Json::object();
    report["exit_reason"] = reason;
    report["exit_text"] = text;
    report["steps"] = simulation.steps_done();
    report["ranks"] = simulation.scene().ranks;
    leave_report(report, file, part, folder / "report.json");
    if (std::FILE* log = std::fopen((folder / "run.log").c_str(), "a")) {
      fmt::print(log, "{}\n", text);
      std::fclose(log);
    }
  } else {
    sleep(1);  // whoever speaks comes to its end first
  }
  MPI_Abort(simulation.scene().comm, int(code));
  std::abort();
}

}  // namespace silt::coupler
