#include "coupler/run/complete_run.hpp"

#include <fmt/format.h>

#include "coupler/case/case.hpp"
#include "coupler/case/case_check.hpp"
#include "coupler/guard.hpp"
#include "coupler/results/report.hpp"
#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt::coupler {

std::string complete_text(const PreparedRun& prepared) {
  const Case& setup = prepared.simulation->setup();
  const std::int64_t step = prepared.simulation->steps_done();
  if (step >= setup.steps)
    return fmt::format(
        "the run is complete: it has done {} of {} steps{}; to go on, raise run.steps (--set "
        "run.steps={})\n",
        step, setup.steps, earlier_options_text(prepared), 2 * setup.steps);
  if (prepared.steady && prepared.steady->steady())
    return fmt::format(
        "the run is complete: {} was steady at step {}; to go on, lower run.steady.change (--set "
        "run.steady.change={})\n",
        setup.steady->quantity, step, shown(setup.steady->change / 10));
  return "";
}

bool lacks_final_report(const std::filesystem::path& folder, const Simulation& simulation) {
  const std::int64_t step = simulation.steps_done();
  if (step > simulation.setup().steps) return false;
  int lacks = 0;
  parallel::on_rank_0(simulation.scene().comm,
                      [&] { lacks = !is_final_report(folder / "report.json", step); });
  parallel::broadcast(simulation.scene().comm, lacks);
  return lacks;
}

}  // namespace silt::coupler
