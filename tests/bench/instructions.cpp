// Instructions a cell of the dense kernel and a link of a coupled step take (256-bit build): what a change
// costs, without a clock. tests/bench/instructions.py compares them with those on record.
//   scripts/bench instructions [--json FILE]
#include <mpi.h>

#include <cstdio>
#include <string>

#include "coupler/case_file.hpp"
#include "coupler/simulation.hpp"
#include "lbm/isa.hpp"
#include "tests/bench/figures.hpp"
#include "tests/bench/instruction_count.hpp"
#include "tests/bench/layers_of_spheres.hpp"

namespace silt::bench {
namespace {

constexpr int edge = 32;  // cells
constexpr double cells = double(edge) * edge * edge;

template <class T>
void count_kernel(const std::string& name, const std::array<double, 3>& force) {
  const std::array<lbm::SideCondition, 6> periodic{};
  lbm::Fluid<T> fluid(lbm::Domain({edge, edge, edge}, periodic, std::nullopt, 1), {0.8, 1. / 6, false, force},
                      MPI_COMM_SELF);
  count_piece(name, [&] {
    for (int t = 0; t < 2; ++t) fluid.stream_collide(), fluid.exchange();
  });
}

void count_step(const std::string& name, coupler::Simulation& s) {
  for (int t = 0; t < 4; ++t) s.step();
  count_piece(name, [&] {
    for (int t = 0; t < 2; ++t) s.step();
  });
}

/// scheme and time: of a scene whose links are counted.
std::string scene(const std::string& scheme, const std::string& time) {
  return layers_of_spheres(16, edge, scheme, time);
}

constexpr std::pair<const char*, const char*> couplings[] = {
    {"bounce-back", "explicit"}, {"cli", "explicit"}, {"cli", "implicit"}, {"parabolic", "implicit"}};

void pieces() {
  lbm::flush_denormals_to_zero();
  count_kernel<float>("cell.single", {});
  count_kernel<float>("cell.single.force", {1e-6, 0, 0});
  count_kernel<double>("cell.double", {});
  for (const auto& [scheme, time] : couplings) {
    coupler::Simulation s(coupler::read_case_text(scene(scheme, time), "links"), MPI_COMM_SELF);
    count_step(std::string("step.") + scheme + "." + time, s);
  }
}

void run(const Options& o) {
  if (o.others == std::vector<std::string>{"--pieces"}) return pieces();
  require_no_others(o);
  const auto counts = count_instructions("--pieces");
  Figures out;
  const auto add = [&](const std::string& key, double value) {
    printf("%-32s %8.2f\n", key.c_str(), value);
    out.figures["instructions." + key] = value;
  };
  for (const std::string name : {"cell.single", "cell.single.force", "cell.double"})
    add(name, counts.at(name) / (2 * cells));
  for (const auto& [scheme, time] : couplings) {
    coupler::Simulation s(coupler::read_case_text(scene(scheme, time), "links"), MPI_COMM_SELF);
    const std::string key = std::string(scheme) + "." + time;
    add("link." + key, (counts.at("step." + key) - counts.at("cell.single.force")) / (2 * double(s.links())));
  }
  out.write(o.json);
}

}  // namespace
}  // namespace silt::bench

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int code = 0;
  try {
    silt::bench::run(silt::bench::options_of(argc, argv));
  } catch (const std::exception& e) {
    fprintf(stderr, "%s\n", e.what());
    code = 2;
  }
  MPI_Finalize();
  return code;
}
