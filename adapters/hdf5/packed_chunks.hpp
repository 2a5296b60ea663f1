#pragma once
// Private to adapters/hdf5: compressed datasets of a lattice, in chunks of rows of a plane. Each rank packs
// those of its slab, and rank 0 writes them: HDF5's own way for several ranks leaves all of them waiting
// where one fails.
#include "adapters/hdf5/slab_exchange.hpp"

namespace silt::adapters::hdf5 {

struct Packing {
  hsize_t chunk_rows;
  int level;  // of gzip, from 1 to 9, after a shuffle of bytes
};

/// Creates a dataset [z][y][x] or [z][y][x][c].
Handle create_packed(const File&, const std::string& name, hid_t type, const std::vector<hsize_t>& shape,
                     Packing);

/// Writes such a dataset; collective, and an error is every rank's. The slabs are cut between groups of
/// chunk_rows rows; `file` is open on rank 0, and nullptr elsewhere.
void write_packed(MPI_Comm, const SlabExchange&, const File* file, const std::string& name, Packing,
                  std::size_t value_bytes, std::size_t element, std::vector<std::byte> values);

}  // namespace silt::adapters::hdf5
