#include "coupler/results/departure_log.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <map>

#include "adapters/hdf5/system_reason.hpp"
#include "coupler/case/case_error.hpp"
#include "coupler/results/csv_rows.hpp"
#include "coupler/results/result_folder.hpp"

namespace silt::coupler {
namespace {

constexpr const char* columns = "step,time,id,by,x,y,z\n";

}  // namespace

DepartureLog::DepartureLog(const std::filesystem::path& folder, std::int64_t resumed_at, const Units& units)
    : path_(folder / "departures.csv"), units_(units) {
  if (resumed_at >= 0) remove_rows_after(path_, resumed_at - 1);
}

void DepartureLog::append(std::span<const Departure> departures) {
  if (departures.empty()) return;
  const bool fresh = !std::filesystem::exists(path_);
  std::ofstream file(path_, std::ios::app);
  if (fresh) file << columns;
  const double cell = units_.cell_size;
  for (const Departure& d : departures)
    file << fmt::format("{},{},{},{},{},{},{}\n", d.step, static_cast<double>(d.step) * units_.time_step,
                        d.id, way_text(static_cast<int>(d.way)), d.position[0] * cell, d.position[1] * cell,
                        d.position[2] * cell);
  file.close();
  if (!file) throw FileError(path_.string() + ": cannot be written: " + adapters::system_reason(errno));
}

std::string departures_text(std::span<const Departure> departures) {
  constexpr std::size_t most_ids = 5;
  std::map<std::int64_t, std::vector<std::string>> ids;
  for (const Departure& d : departures) ids[d.way].push_back(std::to_string(d.id));
  std::string text =
      fmt::format("{} {} left: ", departures.size(), departures.size() > 1 ? "bodies have" : "body has");
  for (auto& [way, list] : ids) {
    const std::size_t count = list.size();
    list.resize(std::min(count, most_ids));
    if (way != ids.begin()->first) text += "; ";
    text += fmt::format("{}{} by {}", joined(list),
                        count > most_ids ? fmt::format(", ... ({} in all)", count) : "",
                        way_text(static_cast<int>(way)));
  }
  return text;
}

}  // namespace silt::coupler
