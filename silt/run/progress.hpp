#pragma once
// The progress of a run for the user: a line that keeps itself up to date on a terminal, else (or if the
// environment variable SILT_PLAIN is set) one every few seconds; run.log has it too. That of other ranks is
// silent.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

#include "silt/case/units.hpp"

namespace silt {

/// The measure of a run's progress: the steps at which it begins and ends, and the cells of a step.
struct RunExtent {
  std::int64_t first_step = 0, steps = 0;
  double fluid_cells = 0;  // 0: there is no fluid
  Units units;
};

class Progress {
 public:
  /// `loud`: this is the rank that tells. `prints`: not only to the log.
  Progress(const RunExtent&, bool loud, bool prints = true);
  ~Progress();
  Progress(const Progress&) = delete;

  /// Appends to this file from now on. std::runtime_error if it cannot be opened.
  void open_log(const std::filesystem::path&);
  /// Shows a line to the user and writes it to the log.
  void say(const std::string&);
  /// Writes a line to the log only.
  void log(const std::string&);
  /// Call after every step: prints now and then. The speed follows from `seconds_in_steps`, as in the report.
  void step(std::int64_t step, double seconds_in_steps);
  /// Prints the last state of the line, if the log has been opened.
  void finish(std::int64_t step, double seconds_in_steps);

 private:
  using Clock = std::chrono::steady_clock;
  std::string line(std::int64_t step, double seconds_in_steps) const;
  void show(const std::string& line);
  void clear_line();

  const RunExtent run_;
  const bool loud_, prints_;
  const bool terminal_;
  std::FILE* log_ = nullptr;
  Clock::time_point begin_, shown_, logged_;
  std::size_t width_ = 0;  // of the line on the terminal
};

}  // namespace silt
