#pragma once
// Small scenes for tests as the text of a case, put together from its sections. Only case_text.cpp, which is
// compiled once, sees what they become: a test that looks at a Case includes its header itself.
#include <mpi.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "silt/case/case_error.hpp"
#include "tests/errors.hpp"

namespace silt {
struct Case;
class Simulation;
}  // namespace silt

namespace silt::testing {

using Overrides = std::vector<std::string>;

/// Returns [domain]; `boundary` in TOML.
std::string domain_of(const std::array<int, 3>& cells, const std::string& boundary = "\"periodic\"");
/// Returns an entry of [[shapes]]; `sizes` are its other lines.
std::string shape_of(const std::string& name, const std::string& type, const std::string& sizes);
std::string sphere_of(const std::string& name, double diameter);
/// Returns an entry of [[bodies]] or [[fill]]; `lines` are its other lines.
std::string body_of(const std::string& shape, double density, const std::string& lines);
std::string fill_of(const std::string& shape, double density, int count, const std::string& lines);

/// Reads a text as read_case does a file, which the messages call case.toml.
Case read_case_text(const std::string& text, const Overrides& = {});

/// Returns everything that is wrong or doubtful about a case: what it alone tells, then, if that lets it run,
/// what is found where its bodies are placed.
std::vector<Diagnostic> judgement(const Case&, MPI_Comm = MPI_COMM_SELF);
/// Returns the errors among them, as a run would give them, or "".
std::string fault_of(const Case&, MPI_Comm = MPI_COMM_SELF);

/// Runs to the last step; returns the values of [[quantities]] in their order.
std::vector<double> values_of(Simulation&);

/// Starts what a text describes.
Simulation simulation_of(const std::string& text, MPI_Comm = MPI_COMM_SELF, const Overrides& = {});

/// A runnable scene of one ball in a box of 32 cells, lattice units; replace a section to try something.
struct CaseText {
  std::string units = "[units]\nsystem = \"lattice\"\n";
  std::string domain =
      domain_of({32, 32, 32}, "{ x = \"periodic\", y = \"periodic\", z = [\"no-slip\", \"no-slip\"] }");
  std::string fluid = "[fluid]\nrelaxation_time = 0.8\n";
  std::string rest;
  std::string shapes = shape_of("ball", "sphere", "radius = 4");
  std::string bodies = body_of("ball", 1.2, "position = [16, 16, 16]");
  std::string run = "[run]\nsteps = 100\n";

  std::string text() const { return units + domain + fluid + rest + shapes + bodies + run; }
  Case read(const Overrides& = {}) const;
  /// Returns what is wrong with it when it is read and judged, or "".
  std::string fault(const Overrides& = {}) const;
  Simulation start(MPI_Comm, const Overrides& = {}) const;
  /// Returns values_of a simulation of it.
  std::vector<double> values(MPI_Comm, const Overrides& = {}) const;
};

/// Returns this scene in SI: a millimetre a cell, a fluid of 1000 kg/m3.
CaseText si_case();

inline std::string file_text(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The text of the error that reading and judging gives, or "".
template <class F>
std::string error_of(F&& f) {
  return tests::error_of<CaseError>(f);
}

}  // namespace silt::testing

namespace silt::coupler::testing {
using namespace silt::testing;  // tests of the coupler run scenes of the application
}
