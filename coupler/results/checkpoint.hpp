#pragma once
// Leaving a run and coming back to it, to the bit, on any number of ranks.
#include <filesystem>
#include <optional>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "coupler/case/case_file.hpp"
#include "coupler/results/quantities.hpp"
#include "coupler/results/steady_watch.hpp"
#include "coupler/simulation.hpp"

namespace silt::coupler {

/// Collective. Writes FOLDER/checkpoint_STEP.h5 and keeps the case's number of them. Returns its path.
/// std::runtime_error on every rank; earlier checkpoints are then untouched.
std::filesystem::path write_checkpoint(const Simulation&, const Quantities&,
                                       const std::filesystem::path& folder, const adapters::Provenance&,
                                       const std::optional<SteadyWatch>& = {});

/// Collective. Writes FOLDER/stopped_STEP.h5, the state in which a guard has stopped a run: a checkpoint that
/// no run goes on from unless told to (silt resume --checkpoint), and that does not count among those kept.
/// Returns its path. Errors as above.
std::filesystem::path write_stopped_state(const Simulation&, const Quantities&,
                                          const std::filesystem::path& folder, const adapters::Provenance&,
                                          const std::optional<SteadyWatch>& = {});

/// Returns what the checkpoint remembers of its case, for case_to_resume.
CaseOrigin read_origin(const adapters::CheckpointReader&);

/// Collective. Returns the state to go on from; its set_populations reads from the reader, which must still
/// be there when the simulation is made.
SavedState read_state(const adapters::CheckpointReader&, const Case&);

/// Returns what Quantities had gathered, for its set_history.
std::vector<QuantityHistory> read_history(const adapters::CheckpointReader&, const Case&);

/// Returns the watch a case asks for, as it was; fresh where the run watched something else; none without
/// run.steady.
std::optional<SteadyWatch> read_steady_watch(const adapters::CheckpointReader&, const Case&);

}  // namespace silt::coupler
