// A scene pays nothing for what it does not contain: each row of a table (skip_rows.cpp) runs a scene through
// the program, and beside it a driver that calls only the passes the scene needs. Instructions (callgrind,
// 256-bit build) are exact, and those of the start do not count; times, taken in turn, say what caches add.
//   scripts/bench skip [--quick] [--instructions] [--json FILE]      (--instructions: no times)
#include <cstdio>
#include <string>

#include "tests/bench/figures.hpp"
#include "tests/bench/instruction_count.hpp"
#include "tests/bench/skip_rows.hpp"

namespace silt::bench::skip {
namespace {

constexpr int warm_up = 4, counted = 4;  // steps

/// Counts so many steps and twice as many: their difference knows nothing of a start.
void pieces() {
  for (Row& row : skip_rows())
    for (const auto& [which, run] : {std::pair{"scene", &row.scene}, std::pair{"driver", &row.driver}}) {
      (*run)(warm_up);
      for (const int times : {1, 2})
        count_piece(row.key + "." + which + "." + std::to_string(times), [&] { (*run)(times * counted); });
    }
}

/// Scene over driver, sample by sample in turn.
Spread times(Row& row, bool quick) {
  const auto sample = [](const Steps& run, int steps) { return seconds([&] { run(steps); }); };
  const double first = sample(row.scene, warm_up) + sample(row.driver, warm_up);
  const int steps = 2 * std::max(1, int((quick ? 0.002 : 0.02) * warm_up / first));
  Spread scene, driver;
  for (int r = 0; r < (quick ? 3 : 9); ++r) {
    scene.add(sample(row.scene, steps));
    driver.add(sample(row.driver, steps));
  }
  return ratio(scene, driver);
}

}  // namespace

void run(const Options& o) {
  if (o.others == std::vector<std::string>{"--pieces"}) return pieces();
  const bool timed = o.others != std::vector<std::string>{"--instructions"};
  if (timed) require_no_others(o);
  const auto counts = count_instructions("skip --pieces");
  Figures out;
  for (Row& row : skip_rows()) {
    const auto count = [&](const std::string& which) {
      return counts.at(row.key + which + ".2") - counts.at(row.key + which + ".1");
    };
    const double instructions = count(".scene") / count(".driver");
    printf("without %-62s instructions %.4f", row.without.c_str(), instructions);
    out.figures["skip." + row.key + ".ratio"] = instructions;
    Json line = Json::object({{"without", row.without}, {"instructions_scene_over_driver", instructions}});
    if (timed && row.timed) {
      const Spread time = times(row, o.quick);
      printf("  time %.3f (%.3f to %.3f)", time.middle(), time.lowest(), time.highest());
      out.figures["skip." + row.key + ".time_ratio"] = time.middle();
      line["time_scene_over_driver"] = time.middle();
      line["time_lowest"] = time.lowest(), line["time_highest"] = time.highest();
    }
    printf("\n");
    out.table.push_back(line);
  }
  out.write(o.json);
}

}  // namespace silt::bench::skip
