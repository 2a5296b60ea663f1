#pragma once
// Private to adapters/hdf5: the order of ids that lie on many ranks.
#include <optional>
#include <span>

#include "adapters/hdf5/slice_exchange.hpp"

namespace silt::adapters::hdf5 {

/// Where rows that lie on many ranks go in the order of their ids.
struct IdOrder {
  std::uint64_t total = 0;                 // rows of all ranks
  std::vector<std::size_t> rows;           // this rank's, by id
  std::vector<SliceExchange::Run> places;  // of these among those of all ranks
  std::optional<std::uint64_t> twice;  // the least id that is there more than once, the same on every rank
};

/// Collective. Each rank sorts the ids of a share of the range between the least and the greatest of all, so
/// that none has many more than any other if ids are nearly dense.
IdOrder order_by_id(MPI_Comm, std::span<const std::uint64_t> ids);

}  // namespace silt::adapters::hdf5
