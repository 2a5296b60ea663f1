#pragma once
// Private to adapters/hdf5: the tables of a checkpoint, /bodies by id and /impulses body after body, written
// and read by all ranks, each a slice of the rows.
#include <map>
#include <span>

#include "adapters/hdf5/checkpoint_file.hpp"
#include "adapters/hdf5/file.hpp"

namespace silt::adapters::hdf5 {

/// Writes both tables; collective. open(bytes) opens the file on rank 0, with room for so many bytes more, to
/// create the datasets. Returns the datasets' checksums (rank 0; elsewhere undefined) by name. Throws on
/// every rank, a body that is there twice among the reasons.
std::map<std::string, std::uint64_t> write_body_tables(MPI_Comm, const Path&,
                                                       const std::function<File(std::uint64_t bytes)>& open,
                                                       const OwnedRows&,
                                                       std::span<const rigid::HolderColumn>);

/// Returns this rank's slice of the bodies; collective. The file is open on each rank.
CheckpointReader::Bodies read_body_tables(MPI_Comm, const File&, std::span<const rigid::HolderColumn>);

}  // namespace silt::adapters::hdf5
