#pragma once
// Saves and resumes runs, bitwise and on any number of ranks; starts a run from the end of another with other
// parameters (`[initial]` of a case, cases/README.md).
#include <filesystem>
#include <optional>
#include <string>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "coupler/flow.hpp"
#include "lbm/blocks/lattice.hpp"
#include "lbm/levels/level_cut.hpp"
#include "silt/case/case_file.hpp"
#include "silt/results/flow_mean.hpp"
#include "silt/results/quantities.hpp"
#include "silt/results/steady_watch.hpp"
#include "silt/simulation.hpp"

namespace silt {

/// What a run has accumulated over its steps, besides the state.
struct RunHistory {
  const Quantities& quantities;
  const SteadyWatch* steady = nullptr;
  const FlowMean* mean = nullptr;
};

/// Writes FOLDER/checkpoint_STEP.h5, keeps the case's number of checkpoints, and returns the path. Files with
/// another `name` (stopped_STEP.h5 is the state at which a guard stopped) are not counted, and resume uses
/// them only with --checkpoint. Collective. Throws std::runtime_error on every rank and leaves earlier
/// checkpoints untouched.
std::filesystem::path write_checkpoint(const Simulation&, const RunHistory&,
                                       const std::filesystem::path& folder, const adapters::Provenance&,
                                       const std::string& name = "checkpoint");

/// Returns what the checkpoint stores about its case, for case_to_resume.
CaseOrigin read_origin(const adapters::CheckpointReader&);

/// Returns the state to resume, without populations. Collective.
SavedState read_state(const adapters::CheckpointReader&, const Case&);

/// Makes the resumed simulation with its populations. Collective.
std::unique_ptr<Simulation> resumed_simulation(const adapters::CheckpointReader&, Case, MPI_Comm);

/// Returns the history of Quantities for set_history; none for other definitions (definitions.hpp).
std::vector<QuantityHistory> read_history(const adapters::CheckpointReader&, const Case&);

/// Returns the sums of unfinished rows of [[output.series]] for Quantities::set_means, without rows and
/// columns whose definitions have changed.
SeriesMeans read_means(const adapters::CheckpointReader&, const Case&);

/// Returns the watch of a case: restored, new if the run watched something else, none without run.steady.
std::optional<SteadyWatch> read_steady_watch(const adapters::CheckpointReader&, const Case&);

/// Lists of texts are stored as lines.
std::string joined_lines(const std::vector<std::string>&);
std::vector<std::string> split_lines(const std::string&);

/// Returns the columns of CouplingState in checkpoints.
std::vector<adapters::AttachedColumn> saved_columns();

/// Throws std::runtime_error with dataset, row, value and allowed range for the first invalid number in this
/// rank's slice of bodies and stored impulses; checksums do not ensure a valid state. next_id: first unused
/// id.
void require_possible(const Case&, const adapters::CheckpointReader::Bodies&, rigid::BodyId next_id);

// ---- populations of the fluid (populations.cpp) ----

void write_populations(adapters::CheckpointWriter&, const Case&, const coupler::Flow&);

/// Reads populations into a flow whose cells have the levels of the file (saved_levels). Those of a
/// temperature are left out if the flow has none.
void read_populations(const adapters::CheckpointReader&, const Case&, coupler::Flow&);

/// Returns why the file's populations do not fit a case (lattice, precision or levels), or "". Either may
/// have a temperature without the other.
std::string fault_of_populations(const adapters::CheckpointReader&, const Case&);
/// Returns whether the file has populations of a temperature.
bool has_temperature(const adapters::CheckpointReader&);

/// Returns the levels of cells in a box of finest cells, aligned with the coarsest cells, as disjoint boxes.
/// `coarsest` is the coarsest level of the case. Collective.
std::vector<lbm::LevelBox> saved_levels(const adapters::CheckpointReader&, int coarsest, const lbm::CellBox&);

// ---- another run's start (start_from.cpp, other_fluid.cpp) ----

/// The factors that convert the temperature of an earlier run.
struct HeatScales {
  double shift = 0;            // its reference temperature less that of this run
  double off_equilibrium = 1;  // of the populations: what keeps the gradient
};

/// The factors that convert the fluid of an earlier run to the lattice units of this run.
struct FluidScales {
  double length = 1;  // the width of its cells in those of the earlier run
  double velocity = 1, pressure = 1;
  double off_equilibrium = 1;      // of the populations: what keeps the rate of strain
  std::optional<HeatScales> heat;  // none: not both runs have a temperature

  int populations() const { return lbm::D3Q19::directions + (heat ? lbm::D3Q7::directions : 0); }
};

/// Converts the fluid: velocity, pressure, rate of strain and temperature stay what they are in the units of
/// the case.
void rescale_populations(coupler::FluidFields&, const FluidScales&);

/// Collective. Sets the fluid to that of an earlier run, at the same places, on cells of another width; both
/// have one level of cells.
void interpolate_populations(const adapters::CheckpointReader&, const Case&, coupler::FluidFields&,
                             const FluidScales&);

/// Writes what a start from the checkpoint needs to know of its run, besides the state.
void write_origin_of_start(adapters::CheckpointWriter&, const Case&, std::int64_t step);

/// Returns the state at the start of the case, without populations. Collective. Throws std::runtime_error on
/// every rank if the case cannot start from the checkpoint.
SavedState start_from(const adapters::CheckpointReader&, const Case&);

/// Adds warnings of keys without effect since the checkpoint gives the same.
void find_idle_keys_at_start(const adapters::CheckpointReader&, const Case&, std::vector<Diagnostic>&);

/// Makes the simulation that starts at step 0 from the checkpoint. Collective; throws likewise.
std::unique_ptr<Simulation> simulation_from(const adapters::CheckpointReader&, Case, MPI_Comm);

}  // namespace silt
