#include "lbm/move_populations.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "parallel/communicator.hpp"
#include "parallel/transfers.hpp"

namespace silt::lbm {

namespace {

/// Cells that a block here shares with one of a rank, in the other cut.
struct Shared {
  int block;    // local index
  CellBox box;  // global
};
using SharedWith = std::map<int, std::vector<Shared>>;

CellBox overlap(const CellBox& a, const CellBox& b) {
  CellBox both;
  for (int d = 0; d < 3; ++d) {
    both.lower[d] = std::max(a.lower[d], b.lower[d]);
    both.size[d] = std::min(a.lower[d] + a.size[d], b.lower[d] + b.size[d]) - both.lower[d];
  }
  return both;
}

/// By rank, in an order that both ends of a message find.
SharedWith shared_cells(const Domain& here, const Domain& there, int rank) {
  SharedWith shared;
  for (const BlockPlace& mine : here.blocks_of(rank))
    there.tree().for_leaves_meeting(mine.box, [&](const CutTree::Leaf& leaf) {
      shared[there.rank_of(leaf.index)].push_back(
          {here.local_index(mine, rank), overlap(mine.box, leaf.box)});
    });
  for (auto& [other, list] : shared)
    std::sort(list.begin(), list.end(), [](const Shared& a, const Shared& b) {
      const Int3 p = a.box.lower, q = b.box.lower;
      return std::tie(p.z, p.y, p.x) < std::tie(q.z, q.y, q.x);
    });
  return shared;
}

/// Calls visit(first population of a row, cells) for the rows of boxes of a fluid's blocks, one direction.
template <class F, class Visit>
void for_rows(F& fluid, const std::vector<Shared>& list, int i, Visit&& visit) {
  for (const Shared& part : list) {
    auto& block = fluid.blocks()[part.block];
    const Int3 first = part.box.lower - block.box().lower;
    for (int z = 0; z < part.box.size.z; ++z)
      for (int y = 0; y < part.box.size.y; ++y)
        visit(block.data() + block.arriving(i, fluid.parity()) + block.cell(first + Int3{0, y, z}),
              part.box.size.x);
  }
}

std::size_t cells_in(const std::vector<Shared>& list) {
  std::size_t n = 0;
  for (const Shared& part : list) n += std::size_t(part.box.cells());
  return n;
}

template <class T>
struct Parcel {
  int rank;
  const std::vector<Shared>* cells;
  std::vector<T> buffer;
};

template <class T>
std::vector<Parcel<T>> parcels(const SharedWith& shared) {
  std::vector<Parcel<T>> list;
  for (const auto& [rank, cells] : shared) list.push_back({rank, &cells, std::vector<T>(cells_in(cells))});
  return list;
}

}  // namespace

template <class T>
void move_populations(const Fluid<T>& from, Fluid<T>& to) {
  const int rank = parallel::rank_of(to.comm());
  const SharedWith kept_there = shared_cells(from.domain(), to.domain(), rank);
  const SharedWith kept_here = shared_cells(to.domain(), from.domain(), rank);
  auto outgoing = parcels<T>(kept_there), incoming = parcels<T>(kept_here);
  parallel::Transfers transfers(to.comm(), 4);
  for (int i = 0; i < directions; ++i) {
    for (Parcel<T>& p : incoming) transfers.receive(p.rank, std::span(p.buffer));
    for (Parcel<T>& p : outgoing) {
      T* out = p.buffer.data();
      for_rows(from, *p.cells, i, [&](const T* row, int cells) { out = std::copy_n(row, cells, out); });
      transfers.send(p.rank, std::span(p.buffer));
    }
    transfers.wait();
    for (const Parcel<T>& p : incoming) {
      const T* in = p.buffer.data();
      for_rows(to, *p.cells, i, [&](T* row, int cells) {
        std::copy_n(in, cells, row);
        in += cells;
      });
    }
  }
}

template void move_populations(const Fluid<float>&, Fluid<float>&);
template void move_populations(const Fluid<double>&, Fluid<double>&);

}  // namespace silt::lbm
