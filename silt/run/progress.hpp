#pragma once
// Shows the progress of a run: on a terminal one line that is updated, else (or if the environment variable
// SILT_PLAIN is set) a line every few seconds; and in run.log. Ranks other than 0 print nothing.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

#include "silt/case/units.hpp"

namespace silt {

/// The first and last step of a run, and the number of fluid cells per step.
struct RunExtent {
  std::int64_t first_step = 0, steps = 0;
  double fluid_cells = 0;  // 0: no fluid
  Units units;
};

class Progress {
 public:
  /// `loud`: this rank reports. `prints`: to the terminal, too, and not only to the log.
  Progress(const RunExtent&, bool loud, bool prints = true);
  ~Progress();
  Progress(const Progress&) = delete;

  /// Appends to this file from now on. Throws std::runtime_error if it cannot be opened.
  void open_log(const std::filesystem::path&);
  /// Prints a line and writes it to the log.
  void say(const std::string&);
  /// Writes a line to the log only.
  void log(const std::string&);
  /// Call after every step; prints at intervals. The speed follows from `seconds_in_steps`, as in the report.
  void step(std::int64_t step, double seconds_in_steps);
  /// Prints the last state, if the log has been opened.
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
