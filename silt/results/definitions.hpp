#pragma once
// What the accumulated results of a case are of: texts that go into a checkpoint beside the sums, by which a
// resumed run tells whether these are of what it asks for now. Sums of another definition begin anew.
#include <string>
#include <vector>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "silt/case/case.hpp"

namespace silt {

// ---- names in /state of a checkpoint ----

/// A number of a quantity's QuantityHistory.
std::string history_name(const QuantitySpec&, std::size_t k);
/// The mean of a column (by its place) of a series, up to the row to come.
std::string mean_name(const ColumnsSpec&, std::size_t column);
/// The text of what has such a name, or begins so.
std::string definition_name(const std::string& of);
inline constexpr const char *watch_name = "steady", *flow_mean_name = "mean";

// ---- definitions, in lattice units: all that changes what is summed ----

std::string definition_of(const QuantitySpec&);
std::string definition_of(const Case&, const ColumnsSpec&, std::size_t column);
std::string definition_of(const Case&, const SteadySpec&);
std::string definition_of(const MeanSpec&);

/// Returns whether a checkpoint holds what has the name, and of this definition.
bool holds(const adapters::CheckpointReader&, const std::string& name, const std::string& definition);

/// Returns a warning of each accumulated result of the case that does not have what it is of, because the
/// checkpoint holds it of another definition, or not at all.
std::vector<Diagnostic> begun_anew(const adapters::CheckpointReader&, const Case&);

}  // namespace silt
