#pragma once
// Leaving a run and coming back to it, to the bit, on any number of ranks.
#include <filesystem>
#include <optional>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "coupler/results/quantities.hpp"
#include "coupler/results/steady_watch.hpp"
#include "coupler/simulation.hpp"

namespace silt::coupler {

/// Collective. Writes FOLDER/checkpoint_STEP.h5 and keeps the case's number of them. Returns its path.
/// std::runtime_error on every rank; earlier checkpoints are then untouched.
std::filesystem::path write_checkpoint(const Simulation&, const Quantities&,
                                       const std::filesystem::path& folder, const adapters::Provenance&,
                                       const std::optional<SteadyWatch>& = {});

/// The case a checkpoint's run goes on with: what `directory` holds now, with the --set of the run that wrote
/// the checkpoint and then those given. Only [run], [output] and [[quantities]] may differ from what it began
/// with: else CaseError, saying where.
Case case_to_resume(const adapters::CheckpointReader&, const std::filesystem::path& directory,
                    const std::vector<std::string>& overrides);

/// Collective. set_populations reads from the reader, which must still be there when the simulation is made.
SavedState read_state(const adapters::CheckpointReader&, const Case&);

/// What Quantities had gathered; give it to set_history.
std::vector<QuantityHistory> read_history(const adapters::CheckpointReader&, const Case&);

/// The watch a case asks for, as it was; fresh where the run watched something else. None without run.steady.
std::optional<SteadyWatch> read_steady_watch(const adapters::CheckpointReader&, const Case&);

}  // namespace silt::coupler
