#pragma once
// Private to adapters/hdf5: the parts of a checkpoint that have a file of their own.
#include <map>
#include <span>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "adapters/hdf5/file.hpp"

namespace silt::adapters::hdf5 {

// ---- checksums, and whether a checkpoint is whole (verify_checkpoint.cpp) ----

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

// ---- the tables /bodies by id and /impulses body after body, each rank a slice of the rows
// (body_tables.cpp) ----

/// Writes both tables; collective. open(bytes) opens the file on rank 0, with room for so many bytes more, to
/// create the datasets. Returns the datasets' checksums (rank 0; elsewhere undefined) by name. Throws on
/// every rank, a body that is there twice among the reasons.
std::map<std::string, std::uint64_t> write_body_tables(MPI_Comm, const Path&,
                                                       const std::function<File(std::uint64_t bytes)>& open,
                                                       const OwnedRows&, std::span<const HolderColumn>);

/// Returns this rank's slice of the bodies; collective. The file is open on each rank.
CheckpointReader::Bodies read_body_tables(MPI_Comm, const File&, std::span<const HolderColumn>);

}  // namespace silt::adapters::hdf5
