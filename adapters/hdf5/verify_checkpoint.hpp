#pragma once
// Private to adapters/hdf5: checks that a checkpoint is whole, and lists its columns.
#include "adapters/hdf5/checkpoint_file.hpp"
#include "adapters/hdf5/checksum.hpp"
#include "adapters/hdf5/table.hpp"
#include "rigid/bodies/body_set.hpp"

namespace silt::adapters::hdf5 {

inline const char* const checkpoint_format = "silt checkpoint";

/// A stored impulse as a row: plain, in the order of the bodies.
struct ImpulseRow {
  rigid::BodyId partner;
  std::int8_t image[3];
  std::uint64_t feature;
  double impulse[3];
};

/// Of rigid::BodyRecord, in /bodies: its own members, then those of its holder state.
std::vector<Column> record_columns(std::span<const HolderColumn> = {});
const std::vector<Column>& impulse_columns();  // of ImpulseRow, in /impulses

/// The names of the datasets in a group, in alphabetical order; none where there is no such group.
std::vector<std::string> dataset_names(const File&, const std::string& group);

/// Writes a contiguous dataset of one rank with its checksum.
void write_checked(File&, const std::string& name, hid_t type, const std::vector<hsize_t>& shape,
                   const void* data, std::size_t bytes);
/// Reads it back whole; throws where its checksum differs.
std::vector<std::byte> read_checked(const File&, const std::string& name, hid_t type,
                                    std::size_t bytes_a_row);

/// Collective: reads the whole file, shared out over the ranks by pieces, and compares format, version and
/// every checksum. Throws Error (the same text on every rank) that says what is wrong.
void verify_checkpoint(MPI_Comm, const Path&);

}  // namespace silt::adapters::hdf5
