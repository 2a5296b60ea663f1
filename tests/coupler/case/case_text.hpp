#pragma once
// Small cases for the tests of reading and judging, put together from their sections.
#include <fstream>
#include <iterator>
#include <string>

#include "coupler/case/case_check.hpp"
#include "coupler/case/case_file.hpp"

namespace silt::coupler::testing {

/// A runnable scene of one ball in a box of 32 cells, lattice units; replace a section to try something.
struct CaseText {
  std::string units = "[units]\nsystem = \"lattice\"\n";
  std::string domain =
      "[domain]\nsize = [32, 32, 32]\nboundary = { x = \"periodic\", y = \"periodic\", z = [\"no-slip\", "
      "\"no-slip\"] }\n";
  std::string fluid = "[fluid]\nrelaxation_time = 0.8\n";
  std::string rest;
  std::string shapes = "[[shapes]]\nname = \"ball\"\ntype = \"sphere\"\nradius = 4\n";
  std::string bodies = "[[bodies]]\nshape = \"ball\"\ndensity = 1.2\nposition = [16, 16, 16]\n";
  std::string run = "[run]\nsteps = 100\n";

  std::string text() const { return units + domain + fluid + rest + shapes + bodies + run; }
  Case read(const std::vector<std::string>& overrides = {}) const {
    return read_case_text(text(), "case.toml", overrides);
  }
};

/// The same in SI: a millimetre a cell, a fluid of 1000 kg/m3.
inline CaseText si_case() {
  CaseText c;
  c.units = "[units]\nsystem = \"si\"\ncell_size = 1e-3\ntime_step = 1e-2\n";
  c.domain =
      "[domain]\nsize = [0.032, 0.032, 0.032]\nboundary = { x = \"periodic\", y = \"periodic\", z = "
      "[\"no-slip\", \"no-slip\"] }\n";
  c.fluid = "[fluid]\ndensity = 1000\nkinematic_viscosity = 1e-5\n";
  c.shapes = "[[shapes]]\nname = \"ball\"\ntype = \"sphere\"\nradius = 4e-3\n";
  c.bodies = "[[bodies]]\nshape = \"ball\"\ndensity = 1200\nposition = [0.016, 0.016, 0.016]\n";
  return c;
}

inline std::string file_text(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The text of the error that reading and judging gives, or "".
template <class F>
std::string error_of(F&& f) {
  try {
    f();
  } catch (const CaseError& error) {
    return error.what();
  }
  return "";
}

}  // namespace silt::coupler::testing
