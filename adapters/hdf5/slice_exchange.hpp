#pragma once
// Private to adapters/hdf5: redistribution of a long array between scattered values and slices: rank r has
// the r-th of equal, contiguous slices. Also the order of rows by id.
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "adapters/hdf5/result_file.hpp"
#include "parallel/messages.hpp"

namespace silt::adapters::hdf5 {

class SliceExchange {
 public:
  /// A range of consecutive elements.
  struct Run {
    std::uint64_t first, length;
  };

  /// Plans the exchange; collective. `runs`: the elements whose values this rank has (or needs), ascending;
  /// for writing the runs of two ranks must not overlap. Slices consist of groups of `grain` elements. A rank
  /// stores its own runs, those of its slice, and their ranks. Throws on every rank if two ranks exchange
  /// 2^31 elements or more, or if memory is exhausted.
  SliceExchange(MPI_Comm, std::uint64_t elements, const std::vector<Run>& runs, std::uint64_t grain = 1);

  MPI_Comm comm() const { return comm_; }
  std::uint64_t slice_begin() const { return begin_; }
  std::uint64_t slice_size() const { return size_; }

  /// Collective. Returns this rank's slice, else zero. `values`: of the runs, `element` bytes each.
  std::vector<std::byte> to_slice(std::size_t element, std::vector<std::byte> values) const;
  /// Returns the values of this rank's runs from the slices of all ranks. Collective.
  std::vector<std::byte> from_slice(std::size_t element, const std::vector<std::byte>& slice) const;

 private:
  struct Partner {
    int rank;
    std::size_t first, count;  // elements, in the buffer of all partners
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
  std::vector<Partner> slices_,
      holders_;              // ranks with slices of this rank's runs; ranks with runs of this slice
  std::vector<Run> pieces_;  // runs in this slice, relative to its start, by holder
};

/// The order by id of rows distributed over the ranks.
struct IdOrder {
  std::uint64_t total = 0;                 // rows of all ranks
  std::vector<std::size_t> rows;           // this rank's rows, sorted by id
  std::vector<SliceExchange::Run> places;  // of these rows among those of all ranks
  std::optional<std::uint64_t> twice;      // the least id that occurs more than once, the same on every rank
};

/// Collective. Each rank sorts the ids of an equal part of the range from the least to the greatest id, so
/// that the load is balanced if ids are nearly dense.
IdOrder order_by_id(MPI_Comm, std::span<const std::uint64_t> ids);

/// Collective. Calls take(piece) on rank 0 for the pieces of every rank in rank order: those given, or the
/// given bytes in pieces of at most `longest`. If take throws, every rank throws at the end.
using UsePiece = std::function<void(std::span<const std::byte>)>;
void gather_in_pieces(MPI_Comm, const std::vector<std::vector<std::byte>>& pieces, std::size_t longest,
                      const UsePiece& take);
void gather_in_pieces(MPI_Comm, std::span<const std::byte>, std::size_t longest, const UsePiece& take);

/// Appends a run to ascending ones, merging it with the last if they are contiguous.
inline void append_run(std::vector<SliceExchange::Run>& runs, SliceExchange::Run more) {
  if (!runs.empty() && runs.back().first + runs.back().length == more.first)
    runs.back().length += more.length;
  else
    runs.push_back(more);
}

// Redistribution of boxes of cells of an array [z][y][x], or of a list of the cells of all boxes, with one or
// more numbers per cell.
//
// The rows of a block are short and scattered over the file. So the ranks first exchange rows such that each
// has a slab of whole lattice rows, and then write or read it contiguously:
//
//   boxes  --pack-->  rows by z, y, x  --SliceExchange-->  lattice rows ny nz r / ranks to
//                                                          ny nz (r + 1) / ranks

class SlabExchange {
 public:
  /// Collective. `cells`: of the lattice. Throws on every rank for a box outside the lattice.
  SlabExchange(MPI_Comm, std::array<int, 3> cells, std::vector<CellBox> boxes);
  /// Plans the exchange of a list: the boxes of all ranks in rank order.
  SlabExchange(MPI_Comm, std::vector<CellBox> boxes);

  const std::vector<CellBox>& boxes() const { return boxes_; }

  /// Packs this rank's cells (local): calls fill(box, buffer) for every nonempty box, x fastest, and returns
  /// all cells by z, y, x (for a list, box after box). `element`: bytes per cell.
  std::vector<std::byte> pack(std::size_t element, const std::function<void(std::size_t, void*)>& fill) const;
  /// The inverse of pack (local): calls take(box, cells).
  void unpack(const std::vector<std::byte>& packed, std::size_t element,
              const std::function<void(std::size_t, const void*)>& take) const;

  /// Returns the exchange of the packed cells. A slice is a slab of whole rows, zero for cells of no rank.
  const SliceExchange& slices() const { return *slices_; }

 private:
  struct Row {
    lbm::Int3 first;
    std::size_t length, box, offset;  // offset: in cells, within the box
  };
  std::vector<SliceExchange::Run> list_rows();

  std::array<int, 3> lattice_{};
  std::vector<CellBox> boxes_;
  std::vector<Row> rows_;  // by z, y, x; empty for a list
  std::size_t cells_ = 0;
  std::optional<SliceExchange> slices_;
};

/// The positions of this rank's tiles' entries in a list over all tiles, by z, y, x of the tile.
struct TileRuns {
  std::uint64_t total = 0;  // entries of all tiles
  std::vector<SliceExchange::Run> mine;
};

TileRuns runs_of_tiles(MPI_Comm, const ListedTiles&);  // collective

}  // namespace silt::adapters::hdf5
