#pragma once
// Private to adapters/hdf5: rows of a plain struct as one dataset a member ("columns"), and rows of all ranks
// on rank 0.
#include <span>
#include <type_traits>
#include <vector>

#include "adapters/hdf5/file.hpp"

namespace silt::adapters::hdf5 {

/// Column describes a member of a row: dataset name, offset and type in memory, numbers a row, unit.
struct Column {
  const char* name;
  std::size_t offset;
  enum Type { uint64, int64, int32, int8, uint8, float64 } type;
  int components = 1;
  std::string unit = "";

  std::size_t bytes() const;  // a row's
  hid_t memory_type() const;  // little-endian in the file alike: bits are kept
};

/// Returns the column's values of all rows, one after the other.
std::vector<std::byte> gather_column(const Column&, const void* rows, std::size_t row_bytes, std::size_t n);
/// Reverses gather_column: puts the values into the rows.
void scatter_column(const Column&, const std::vector<std::byte>&, void* rows, std::size_t row_bytes);

/// Returns the rows of all ranks on rank 0 (in rank order) and nothing elsewhere; collective. There must be
/// fewer than 2^31 rows in all.
template <class Row>
std::vector<Row> gather_rows(MPI_Comm comm, std::span<const Row> mine) {
  static_assert(std::is_trivially_copyable_v<Row>);
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  MPI_Datatype type;
  MPI_Type_contiguous(sizeof(Row), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  const int n = static_cast<int>(mine.size());
  std::vector<int> counts(rank == 0 ? ranks : 0), offsets(counts.size());
  MPI_Gather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm);
  std::size_t total = 0;
  for (std::size_t r = 0; r < counts.size(); ++r) {
    offsets[r] = static_cast<int>(total);
    total += counts[r];
  }
  std::vector<Row> all(total);
  MPI_Gatherv(mine.data(), n, type, all.data(), counts.data(), offsets.data(), type, 0, comm);
  MPI_Type_free(&type);
  return all;
}

}  // namespace silt::adapters::hdf5
