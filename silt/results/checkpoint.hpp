#pragma once
// Leaving a run and coming back to it, bitwise, on any number of ranks; and the start of a run from the end
// of another one, with other parameters (`[initial]` of a case, cases/README.md).
#include <filesystem>
#include <optional>
#include <string>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "coupler/flow.hpp"
#include "lbm/levels/level_cut.hpp"
#include "silt/case/case_file.hpp"
#include "silt/results/flow_mean.hpp"
#include "silt/results/quantities.hpp"
#include "silt/results/steady_watch.hpp"
#include "silt/simulation.hpp"

namespace silt {

/// Collective. Writes FOLDER/checkpoint_STEP.h5 and keeps the case's number of them. Under another name no
/// run goes on from it but by silt resume --checkpoint, and it does not count among those kept:
/// stopped_STEP.h5 is the state in which a guard has stopped a run. Returns its path. std::runtime_error on
/// every rank; earlier checkpoints are then untouched.
std::filesystem::path write_checkpoint(const Simulation&, const Quantities&,
                                       const std::filesystem::path& folder, const adapters::Provenance&,
                                       const std::optional<SteadyWatch>& = {},
                                       const std::string& name = "checkpoint", const FlowMean* = nullptr);

/// Returns what the checkpoint remembers of its case, for case_to_resume.
CaseOrigin read_origin(const adapters::CheckpointReader&);

/// Collective. Returns the state to go on from, but for the populations of the fluid.
SavedState read_state(const adapters::CheckpointReader&, const Case&);

/// Collective. Makes the simulation that goes on from it, populations and all.
std::unique_ptr<Simulation> resumed_simulation(const adapters::CheckpointReader&, Case, MPI_Comm);

/// Returns what Quantities had gathered, for its set_history; of other definitions (definitions.hpp) nothing.
std::vector<QuantityHistory> read_history(const adapters::CheckpointReader&, const Case&);

/// Returns what rows of [[output.series]] had gathered, for Quantities::set_means; nothing of other rows or
/// of columns of other definitions than the run had.
SeriesMeans read_means(const adapters::CheckpointReader&, const Case&);

/// Returns the watch of a case, as it was; fresh if the run watched something else; none without run.steady.
std::optional<SteadyWatch> read_steady_watch(const adapters::CheckpointReader&, const Case&);

/// Returns the columns of CouplingState that checkpoints have.
std::vector<adapters::AttachedColumn> saved_columns();

/// Throws std::runtime_error for the first number of this rank's slice of the bodies and of their stored
/// impulses that no run can go on from: the dataset, the row, what was found and what may be. A file may have
/// every checksum right and still not be one that a run wrote. next_id: the first that no body has had.
void require_possible(const Case&, const adapters::CheckpointReader::Bodies&, rigid::BodyId next_id);

// ---- the populations of the fluid (populations.cpp) ----

void write_populations(adapters::CheckpointWriter&, const Case&, const coupler::Flow&);

/// Reads the populations into a flow whose cells are of the levels that the file says (saved_levels).
void read_populations(const adapters::CheckpointReader&, const Case&, coupler::Flow&);

/// Returns why a file's populations cannot be those of a case (another lattice or precision, other levels);
/// empty where they can.
std::string fault_of_populations(const adapters::CheckpointReader&, const Case&);

/// Collective. Returns the levels of the cells in a box of finest ones, whose faces are faces of cells of the
/// widest level: as boxes that do not overlap. `coarsest`: that of the case.
std::vector<lbm::LevelBox> saved_levels(const adapters::CheckpointReader&, int coarsest, const lbm::CellBox&);

// ---- another run's start (start_from.cpp, other_cells.cpp) ----

/// How the lattice units of a run differ from those of the one that it begins with: factors of what a fluid
/// has.
struct FluidScales {
  double length = 1;  // the width of its cells in those of the earlier run
  double velocity = 1, pressure = 1, off_equilibrium = 1;  // off_equilibrium keeps the rate of strain
};

/// Collective. Gives the fluid what that of an earlier run on cells of another width has at the same places;
/// one level of cells each.
void interpolate_populations(const adapters::CheckpointReader&, const Case&, coupler::FluidFields&,
                             const FluidScales&);

/// Writes what a start from a checkpoint asks of the run that wrote it, besides its state.
void write_origin_of_start(adapters::CheckpointWriter&, const Case&, std::int64_t step);

/// Collective. Returns the state with which the case begins, but for the populations of the fluid.
/// std::runtime_error on every rank for a checkpoint that the case cannot begin with.
SavedState start_from(const adapters::CheckpointReader&, const Case&);

/// Adds warnings of keys of the case that do nothing since the checkpoint says the same.
void find_idle_keys_at_start(const adapters::CheckpointReader&, const Case&, std::vector<Diagnostic>&);

/// Collective. Makes the simulation that begins, at step 0, with what the checkpoint holds; errors as above.
std::unique_ptr<Simulation> simulation_from(const adapters::CheckpointReader&, Case, MPI_Comm);

}  // namespace silt
