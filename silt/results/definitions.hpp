#pragma once
// Definitions of accumulated results, stored in checkpoints beside their sums, so that a resumed run can tell
// whether the sums belong to what it computes now. Sums with another definition are restarted.
#include <string>
#include <vector>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "silt/case/case.hpp"

namespace silt {

// ---- names in /state of a checkpoint ----

/// Returns the name of number k of a quantity's history.
std::string history_name(const QuantitySpec&, std::size_t k);
/// Returns the name of the mean of a series' column, by index, for the next row.
std::string mean_name(const ColumnsSpec&, std::size_t column);
/// Returns the name of the definition of results whose names are, or begin with, `of`.
std::string definition_name(const std::string& of);
inline constexpr const char *watch_name = "steady", *flow_mean_name = "mean";

// ---- definitions, in lattice units: everything that changes the sums ----

std::string definition_of(const QuantitySpec&);
std::string definition_of(const Case&, const ColumnsSpec&, std::size_t column);
std::string definition_of(const Case&, const SteadySpec&);
std::string definition_of(const MeanSpec&);

/// Returns whether a checkpoint has a result with this name and definition.
bool holds(const adapters::CheckpointReader&, const std::string& name, const std::string& definition);

/// Returns a warning for each accumulated result of the case that restarts, since the checkpoint has another
/// definition or none.
std::vector<Diagnostic> begun_anew(const adapters::CheckpointReader&, const Case&);

}  // namespace silt
