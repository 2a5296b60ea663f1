#include "coupler/balance/weighted_cut.hpp"

#include "coupler/balance/best_plane.hpp"
#include "lbm/equal_cut.hpp"
#include "parallel/collectives.hpp"
#include "parallel/messages.hpp"

namespace silt::coupler {

using lbm::CellBox;
using lbm::Int3;

namespace {

/// A part of the domain and the ranks that cut it.
class Bisection {
 public:
  Bisection(MPI_Comm all, Int3 cells, std::int64_t work_of_a_cell, std::vector<WorkItem> items)
      : box_{{}, cells}, work_of_a_cell_(work_of_a_cell), items_(std::move(items)) {
    MPI_Comm_dup(all, &group_);
  }
  ~Bisection() { MPI_Comm_free(&group_); }
  Bisection(const Bisection&) = delete;
  Bisection& operator=(const Bisection&) = delete;

  void go() {
    for (int ranks; (ranks = parallel::ranks_of(group_)) > 1;) cut(ranks);
  }

  /// The node that this rank tells of: that of the cut above which it is the first rank. None: of rank 0.
  struct Node {
    std::int32_t number = -1;
    lbm::Cut cut{};
  };
  const Node& node() const { return node_; }
  std::int64_t work() const {
    std::int64_t sum = work_of_a_cell_ * box_.cells();
    for (const WorkItem& item : items_) sum += item.work;
    return sum;
  }

 private:
  /// The work of each layer of cells across each axis, one axis after the other.
  std::vector<std::uint64_t> layers() const {
    std::vector<std::uint64_t> work = work_of_layers(box_, items_);
    parallel::sum_over_ranks(group_, std::span(work));
    add_cells(box_, work_of_a_cell_, work);
    return work;
  }

  void cut(int ranks) {
    const lbm::CutRoom room = lbm::room_to_cut(box_.size, ranks);
    const CutPlane best = best_plane(box_, room, layers(), nearly_as_well(work_of_a_cell_));
    const int here = parallel::rank_of(group_), at = box_.lower[best.axis] + best.below;
    const bool upper = here >= room.lower_leaves;
    if (here == room.lower_leaves) node_ = {number_, {best.axis, at, room.lower_leaves}};
    number_ += upper ? room.lower_leaves : 1;
    const int other_size = upper ? room.lower_leaves : room.upper_leaves;
    const int own_size = ranks - other_size, own_place = here - (upper ? room.lower_leaves : 0);
    const int partner =
        (upper ? 0 : room.lower_leaves) + int(std::int64_t(own_place) * other_size / own_size);
    divide_items(best.axis, at, upper, partner);
    box_.size[best.axis] = upper ? box_.size[best.axis] - best.below : best.below;
    if (upper) box_.lower[best.axis] = at;
    MPI_Comm half;
    MPI_Comm_split(group_, upper, here, &half);
    MPI_Comm_free(&group_);
    group_ = half;
  }

  /// Keeps what is on this rank's side of a plane and sends the rest to a rank of the other side.
  void divide_items(int axis, int at, bool upper, int partner) {
    parallel::Messages messages(group_);
    std::vector<WorkItem> kept, given;
    for (const WorkItem& item : items_) {
      const auto [below, above] = parted(item, axis, at);
      if (below.work > 0) (upper ? given : kept).push_back(below);
      if (above.work > 0) (upper ? kept : given).push_back(above);
    }
    if (!given.empty()) parallel::put(messages.to(partner), std::span<const WorkItem>(given));
    messages.unannounced();
    items_ = std::move(kept);
    for (const parallel::Messages::Message& m : messages.received())
      for (parallel::ByteReader reader(m.bytes); !reader.done();) items_.push_back(reader.take<WorkItem>());
  }

  MPI_Comm group_ = MPI_COMM_NULL;
  CellBox box_;
  std::int32_t number_ = 0;  // of the node that comes next
  std::int64_t work_of_a_cell_;
  std::vector<WorkItem> items_;
  Node node_;
};

WeightedCut with_work(MPI_Comm comm, lbm::CutTree tree, std::int64_t mine) {
  const int ranks = parallel::ranks_of(comm);
  const std::int64_t sum = parallel::sum_over_ranks(comm, mine);
  return {std::move(tree), parallel::max_over_ranks(comm, double(mine)), double(sum) / ranks};
}

}  // namespace

WeightedCut weighted_cut(MPI_Comm comm, Int3 cells, std::int64_t work_of_a_cell,
                         std::vector<WorkItem> items) {
  Bisection bisection(comm, cells, work_of_a_cell, std::move(items));
  bisection.go();
  const int ranks = parallel::ranks_of(comm);
  std::vector<lbm::Cut> nodes(ranks - 1);
  for (const Bisection::Node& node :
       parallel::gathered(comm, std::span(&bisection.node(), 1), parallel::Told::everybody))
    if (node.number >= 0) nodes[node.number] = node.cut;
  return with_work(comm, {cells, std::move(nodes)}, bisection.work());
}

WeightedCut present_cut(MPI_Comm comm, const lbm::Domain& domain, std::int64_t work_of_a_cell,
                        const std::vector<WorkItem>& items) {
  const int rank = parallel::rank_of(comm);
  std::int64_t mine = 0;
  for (const lbm::BlockPlace& place : domain.blocks_of(rank)) mine += work_of_a_cell * place.box.cells();
  for (const WorkItem& item : items) mine += item.work;
  return with_work(comm, domain.tree(), mine);
}

}  // namespace silt::coupler
