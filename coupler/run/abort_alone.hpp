#pragma once
// The end of a run that one rank alone knows of, while the others wait for it somewhere.
#include <filesystem>

#include "coupler/run/run.hpp"
#include "coupler/simulation.hpp"

namespace silt::coupler {

/// Says what happened on stderr and in run.log, leaves a short report.json in the folder, and ends the whole
/// program with MPI_Abort. Of ranks that fail alone at the same time only one speaks: the one that can create
/// the file `last_words`.
[[noreturn]] void abort_alone(const Simulation&, const std::filesystem::path& folder, Exit,
                              const std::string& reason, const std::string& text);

}  // namespace silt::coupler
