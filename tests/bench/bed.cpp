// The fluidised bed of cases/fluidised-bed, with few and with many spheres, in both precisions, on one core:
// million cells a second, all cells counted. In turn in one run, with the bandwidth bound of the same number
// of cells.
//   scripts/bench bed [--quick] [--json FILE]      (--quick: the same scenes for less long)
#include <cstdio>
#include <memory>
#include <string>

#include "silt/simulation.hpp"
#include "tests/bench/bound.hpp"
#include "tests/bench/figures.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::bench::bed {
namespace {

// Steps: the bodies get going; one sample, an even number and whole rounds of mapping (mapping_poses.cpp).
constexpr int warm_up = 18, window = 18;

struct Bed {
  std::string key;
  int spheres;
  bool single;
  std::unique_ptr<Simulation> simulation;
  Spread mlups;
  double solid = 0;
};

Bed make_bed(int spheres, bool single) {
  std::vector<std::string> changes = {
      std::string("fill[0].count=") + std::to_string(spheres),
      std::string("fluid.precision=\"") + (single ? "single" : "double") + "\""};
  if (spheres < 100) changes.push_back("fill[0].box=[[0, 0, 1], [64, 64, 61]]");
  Bed bed{std::to_string(spheres) + (single ? ".single" : ".double"), spheres, single, nullptr, {}};
  using namespace testing;
  const std::string text = file_text(SILT_SOURCE_DIR "/cases/fluidised-bed/case.toml");
  bed.simulation.reset(new Simulation(simulation_of(text, MPI_COMM_SELF, changes)));
  return bed;
}

double cells_of(const Simulation& simulation) {
  const lbm::Int3 n = simulation.scene().domain.cells();
  return double(n.x) * n.y * n.z;
}

void sample(Bed& bed) {
  Simulation& s = *bed.simulation;
  bed.mlups.add(window * cells_of(s) * 1e-6 / seconds([&] {
                  for (int t = 0; t < window; ++t) s.step();
                }));
}

/// Share of each stage in the time since `before`, in words.
std::string stage_shares(const coupler::StageSeconds& before, const coupler::StageSeconds& after) {
  double all = 0;
  for (std::size_t k = 0; k < after.size(); ++k) all += after[k] - before[k];
  std::string text;
  for (std::size_t k = 0; k < after.size(); ++k) {
    const int percent = int(std::lround(100 * (after[k] - before[k]) / all));
    if (percent)
      text += (text.empty() ? "" : ", ") + std::string(coupler::stage_names[k]) + " " +
              std::to_string(percent) + " %";
  }
  return text;
}

}  // namespace

void run(const Options& o) {
  require_no_others(o);
  const int repetitions = o.quick ? 1 : 7;
  std::vector<Bed> beds;
  for (const int spheres : {63, 225})
    for (const bool single : {true, false}) beds.push_back(make_bed(spheres, single));
  std::vector<coupler::StageSeconds> before;
  for (Bed& bed : beds) {
    for (int t = 0; t < warm_up; ++t) bed.simulation->step();
    bed.solid = 1 - double(bed.simulation->checked_totals().fluid_cells) / cells_of(*bed.simulation);
    before.push_back(bed.simulation->stage_seconds());
  }
  const auto cells = std::ptrdiff_t(cells_of(*beds[0].simulation));
  Bound<float> single_bound(cells);
  Bound<double> double_bound(cells);
  for (int r = 0; r < repetitions; ++r) {
    single_bound.sample(window, [] {});
    double_bound.sample(window, [] {});
    for (Bed& bed : beds) sample(bed);
  }
  Figures out;
  for (std::size_t k = 0; k < beds.size(); ++k) {
    const Bed& bed = beds[k];
    const Spread& bound = bed.single ? single_bound.best() : double_bound.best();
    printf("bed %3d spheres (%4.1f %% solid) %s  %6.1f MLUPS (%.1f to %.1f), bound %.0f\n    %s\n",
           bed.spheres, 100 * bed.solid, bed.single ? "single" : "double", bed.mlups.middle(),
           bed.mlups.lowest(), bed.mlups.highest(), bound.middle(),
           stage_shares(before[k], bed.simulation->stage_seconds()).c_str());
    out.figures["bed." + bed.key + ".mlups"] = bed.mlups.middle();
    out.table.push_back(Json::object({{"spheres", bed.spheres},
                                      {"solid", bed.solid},
                                      {"precision", bed.single ? "single" : "double"},
                                      {"mlups", bed.mlups.middle()},
                                      {"mlups_lowest", bed.mlups.lowest()},
                                      {"mlups_highest", bed.mlups.highest()},
                                      {"bound_mlups", bound.middle()}}));
  }
  out.write(o.json);
}

}  // namespace silt::bench::bed
