#pragma once
// Private to adapters/hdf5: checks that a checkpoint is whole.
#include <string>
#include <vector>

#include "adapters/hdf5/checksum.hpp"
#include "adapters/hdf5/file.hpp"

namespace silt::adapters::hdf5 {

inline const char* const checkpoint_format = "silt checkpoint";

/// Returns the names of the datasets in a group, in alphabetical order; none where there is no such group.
std::vector<std::string> dataset_names(const File&, const std::string& group);

/// Reads the whole file (collective), shared out over the ranks by pieces of some megabytes, and compares
/// format, version and every checksum. Throws Error (the same text on every rank) that says what is wrong.
void verify_checkpoint(MPI_Comm, const Path&);

}  // namespace silt::adapters::hdf5
