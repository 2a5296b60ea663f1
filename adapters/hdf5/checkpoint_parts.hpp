#pragma once
// Private to adapters/hdf5: the parts of a checkpoint's code with files of their own.
#include <map>
#include <span>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "adapters/hdf5/file.hpp"

namespace silt::adapters::hdf5 {

// ---- checksums and verification (checkpoint_verify.cpp) ----

inline const char* const checkpoint_format = "silt checkpoint";

/// Returns the contribution to a dataset's checksum of n values from the global index on. The sum over all
/// runs, modulo 2^64, does not depend on how the dataset is divided into runs or on their order. Zero bits
/// add nothing, so cells of no rank need not be known.
std::uint64_t run_checksum(std::size_t value_bytes, const void* values, std::size_t n, std::uint64_t index);

/// Returns the checksum of a small, nonempty dataset.
std::uint64_t block_checksum(const std::string& content);

/// Reads the whole file, with pieces of some megabytes distributed over the ranks, and compares format,
/// version and every checksum. Collective. Throws the same Error on every rank.
void verify_checkpoint(MPI_Comm, const Path&);

// ---- the tables /bodies and /impulses, of which each rank has a slice of the rows
// (checkpoint_body_tables.cpp) ----

/// Writes both tables; collective. open(bytes) opens the file on rank 0, with space for these bytes, to
/// create the datasets. Returns the datasets' checksums by name (defined on rank 0). Throws on every rank,
/// for example if a body occurs twice.
std::map<std::string, std::uint64_t> write_body_tables(MPI_Comm, const Path&,
                                                       const std::function<File(std::uint64_t bytes)>& open,
                                                       const OwnedRows&, std::span<const AttachedColumn>);

/// Returns this rank's slice of the bodies; collective. The file is open on every rank.
CheckpointReader::Bodies read_body_tables(MPI_Comm, const File&, std::span<const AttachedColumn>);

}  // namespace silt::adapters::hdf5
