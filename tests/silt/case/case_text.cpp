#include "tests/silt/case/case_text.hpp"

#include <fmt/format.h>

#include "coupler/flow.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_file.hpp"
#include "silt/placement/given_bodies.hpp"
#include "silt/placement/place_bodies.hpp"
#include "silt/results/quantities.hpp"
#include "silt/simulation.hpp"

namespace silt::testing {

std::string domain_of(const std::array<int, 3>& cells, const std::string& boundary) {
  return fmt::format("[domain]\nsize = [{}, {}, {}]\nboundary = {}\n", cells[0], cells[1], cells[2],
                     boundary);
}

std::string shape_of(const std::string& name, const std::string& type, const std::string& sizes) {
  return fmt::format("[[shapes]]\nname = \"{}\"\ntype = \"{}\"\n{}\n", name, type, sizes);
}

std::string sphere_of(const std::string& name, double diameter) {
  return shape_of(name, "sphere", fmt::format("diameter = {}", diameter));
}

std::string body_of(const std::string& shape, double density, const std::string& lines) {
  return fmt::format("[[bodies]]\nshape = \"{}\"\ndensity = {}\n{}\n", shape, density, lines);
}

std::string fill_of(const std::string& shape, double density, int count, const std::string& lines) {
  return fmt::format("[[fill]]\nshape = \"{}\"\ndensity = {}\ncount = {}\n{}\n", shape, density, count,
                     lines);
}

Case read_case_text(const std::string& text, const Overrides& overrides) {
  CaseSource source{"case.toml", text, {}};
  return read_case(source, overrides);
}

Simulation simulation_of(const std::string& text, MPI_Comm comm, const Overrides& overrides) {
  return {read_case_text(text, overrides), comm};
}

std::vector<Diagnostic> judgement(const Case& setup, MPI_Comm comm) {
  auto list = check_case(setup);
  if (has_errors(list)) return list;
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  const lbm::Domain domain = make_domain(setup, ranks);
  try {
    require_sound_start(setup, domain, comm);
    place_bodies(setup, domain, comm);
  } catch (const CaseError& error) {
    list.insert(list.end(), error.diagnostics().begin(), error.diagnostics().end());
  }
  return list;
}

std::string fault_of(const Case& setup, MPI_Comm comm) {
  auto list = judgement(setup, comm);
  std::erase_if(list, [](const Diagnostic& d) { return d.severity == Diagnostic::Severity::warning; });
  return list.empty() ? "" : CaseError(std::move(list)).what();
}

Case CaseText::read(const Overrides& overrides) const {
  return read_case_text(text(), overrides);
}

std::string CaseText::fault(const Overrides& overrides) const {
  std::string text;
  const std::string unread = error_of([&] { text = fault_of(read(overrides)); });
  return unread + text;
}

Simulation CaseText::start(MPI_Comm comm, const Overrides& overrides) const {
  return simulation_of(text(), comm, overrides);
}

std::vector<double> values_of(Simulation& simulation) {
  Quantities quantities(simulation.setup());
  quantities.observe(simulation);
  while (simulation.steps_done() < simulation.setup().steps) {
    simulation.step();
    quantities.observe(simulation);
  }
  std::vector<double> values;
  for (const auto& [name, value] : quantities.evaluate(simulation)) values.push_back(value);
  return values;
}

std::vector<double> CaseText::values(MPI_Comm comm, const Overrides& overrides) const {
  Simulation simulation = start(comm, overrides);
  return values_of(simulation);
}

CaseText si_case() {
  CaseText c;
  c.units = "[units]\nsystem = \"si\"\ncell_size = 1e-3\ntime_step = 1e-2\n";
  c.domain =
      "[domain]\nsize = [0.032, 0.032, 0.032]\nboundary = { x = \"periodic\", y = \"periodic\", z = "
      "[\"no-slip\", \"no-slip\"] }\n";
  c.fluid = "[fluid]\ndensity = 1000\nkinematic_viscosity = 1e-5\n";
  c.shapes = shape_of("ball", "sphere", "radius = 4e-3");
  c.bodies = body_of("ball", 1200, "position = [0.016, 0.016, 0.016]");
  return c;
}

}  // namespace silt::testing
