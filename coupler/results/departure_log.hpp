#pragma once
// departures.csv: the bodies that left a run, a line each.
#include <filesystem>
#include <span>

#include "coupler/case/units.hpp"
#include "coupler/body_turnover.hpp"

namespace silt::coupler {

class DepartureLog {
 public:
  /// resumed_at: the step at which a run goes on, after which nothing is kept; -1 for a new run. FileError.
  DepartureLog(const std::filesystem::path& folder, std::int64_t resumed_at, const Units&);
  /// Adds lines; the file is there from the first one on. FileError.
  void append(std::span<const Departure>);

 private:
  std::filesystem::path path_;
  Units units_;
};

/// Returns "3 bodies have left: 12, 15 by z-high, 14 by outflow[0]", with the first few ids.
std::string departures_text(std::span<const Departure>);

}  // namespace silt::coupler
