#pragma once
// Private to adapters/hdf5: values of a long array, scattered over the ranks, on the ranks that write or read
// its slices: rank r has the r-th of equal slices in one piece. And the order of rows by their ids.
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "parallel/messages.hpp"

namespace silt::adapters::hdf5 {

class SliceExchange {
 public:
  /// Run is a number of consecutive elements of the array.
  struct Run {
    std::uint64_t first, length;
  };

  /// Plans the exchange; collective. The runs are those of which this rank has (or wants) the values, in
  /// ascending order; to write, no element may be in the runs of two ranks. Slices are cut between groups of
  /// `grain` elements. A rank remembers its runs, those of its slice, and the ranks they are on. Throws on
  /// every rank where two ranks share 2^31 elements or more. Lack of memory throws on all ranks, too.
  SliceExchange(MPI_Comm, std::uint64_t elements, const std::vector<Run>& runs, std::uint64_t grain = 1);

  MPI_Comm comm() const { return comm_; }
  std::uint64_t slice_begin() const { return begin_; }
  std::uint64_t slice_size() const { return size_; }

  /// Returns this rank's slice, zero where no rank has a value. `values`: those of the runs, one after the
  /// other, of so many bytes each. Collective.
  std::vector<std::byte> to_slice(std::size_t element, std::vector<std::byte> values) const;
  /// Returns the values of this rank's runs, from everybody's slices. Collective.
  std::vector<std::byte> from_slice(std::size_t element, const std::vector<std::byte>& slice) const;

 private:
  struct Partner {
    int rank;
    std::size_t first, count;  // elements, among all that go to or come from partners
  };
  bool is_alone() const;
  int slice_of(std::uint64_t element) const;
  std::uint64_t begin_of(int rank) const;
  void split(const std::vector<Run>& runs, parallel::Messages& asked);
  void add_pieces(const parallel::Messages&);
  std::vector<std::byte> swap(std::size_t element, const std::vector<Partner>& from,
                              const std::vector<Partner>& to, const std::vector<std::byte>& values) const;

  parallel::OwnCommunicator comm_;
  int ranks_ = 1;
  std::uint64_t groups_, grain_, begin_ = 0, size_ = 0;
  std::vector<Partner> slices_, holders_;  // that have slices of the runs here; runs of the slice here
  std::vector<Run> pieces_;                // of this slice, counted from its start, holder by holder
};

/// IdOrder says where rows that lie on many ranks go in the order of their ids.
struct IdOrder {
  std::uint64_t total = 0;                 // rows of all ranks
  std::vector<std::size_t> rows;           // this rank's, by id
  std::vector<SliceExchange::Run> places;  // of these among those of all ranks
  std::optional<std::uint64_t> twice;  // the least id that is there more than once, the same on every rank
};

/// Collective. Each rank sorts the ids of a share of the range between the least and the greatest of all, so
/// that none has many more than any other if ids are nearly dense.
IdOrder order_by_id(MPI_Comm, std::span<const std::uint64_t> ids);

/// Collective. Calls take(piece) on rank 0 for pieces of what each rank has, rank after rank: those given, or
/// the bytes cut into pieces; none is longer than `longest`. If take throws, every rank throws in the end.
using TakePiece = std::function<void(std::span<const std::byte>)>;
void hand_to_rank_0(MPI_Comm, const std::vector<std::vector<std::byte>>& pieces, std::size_t longest,
                    const TakePiece& take);
void hand_to_rank_0(MPI_Comm, std::span<const std::byte>, std::size_t longest, const TakePiece& take);

/// Adds a run to ascending ones: to the last of them, if it goes on there.
inline void append_run(std::vector<SliceExchange::Run>& runs, SliceExchange::Run more) {
  if (!runs.empty() && runs.back().first + runs.back().length == more.first)
    runs.back().length += more.length;
  else
    runs.push_back(more);
}

}  // namespace silt::adapters::hdf5
