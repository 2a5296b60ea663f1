#pragma once
// Private to adapters/hdf5: the checksums of a checkpoint's datasets, and whether a checkpoint is whole.
#include "adapters/hdf5/file.hpp"

namespace silt::adapters::hdf5 {

inline const char* const checkpoint_format = "silt checkpoint";

/// Returns what a run of values that starts at a global index (number of the value in the dataset) adds to a
/// dataset's checksum. The sum over all runs, modulo 2^64, does not depend on how the dataset is cut into
/// runs or on their order. Zero bits add nothing, so that cells that no rank holds need not be known.
std::uint64_t run_checksum(std::size_t value_bytes, const void* values, std::size_t n, std::uint64_t index);

/// Returns the checksum of a small dataset that one rank holds whole, of at least a byte.
std::uint64_t block_checksum(const std::string& content);

/// Reads the whole file (collective), shared out over the ranks by pieces of some megabytes, and compares
/// format, version and every checksum. Throws Error (the same text on every rank) that says what is wrong.
void verify_checkpoint(MPI_Comm, const Path&);

}  // namespace silt::adapters::hdf5
