#include "coupler/balance/weighted_cut.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "lbm/blocks/equal_cut.hpp"
#include "parallel/collectives.hpp"
#include "parallel/messages.hpp"

namespace silt::coupler {

using lbm::CellBox;
using lbm::Int3;

namespace {

// ---- the plane that divides a part of the domain between two groups of ranks ----

struct CutPlane {
  int axis = -1, below = 0;                                  // axis; cells of the lower part
  double largest = std::numeric_limits<double>::infinity();  // work per rank in the part with more of it
  double face = 0;
};

/// Returns an item's work in its first cells along an axis.
std::int64_t work_below(const WorkItem& item, int axis, int cells) {
  return item.work * cells / item.box.size[axis];
}

CutPlane best_across(int axis, const CellBox& box, const lbm::CutRoom& room,
                     std::span<const std::uint64_t> layers) {
  const auto range = room.along(axis, box.size);
  if (range.empty()) return {};
  const double all = double(std::accumulate(layers.begin(), layers.end(), std::uint64_t(0)));
  const double even = double(box.size[axis]) * room.lower_leaves / (room.lower_leaves + room.upper_leaves);
  CutPlane best;
  std::uint64_t below = 0;
  for (int at = 1; at <= range.last; ++at) {
    below += layers[at - 1];
    if (at < range.first) continue;
    const double largest =
        std::max(double(below) / room.lower_leaves, (all - double(below)) / room.upper_leaves);
    if (best.axis < 0 || largest < best.largest ||
        (largest == best.largest && std::abs(at - even) < std::abs(best.below - even)))
      best = {axis, at, largest, lbm::cost_of_face(axis) * double(box.cells() / box.size[axis])};
  }
  return best;
}

/// A part of the domain: its cells, the work of each, and this rank's items in it.
struct Part {
  CellBox box;
  std::int64_t work_of_a_cell;
  std::vector<WorkItem> items;
  int edge = lbm::usual_edge;  // of a rank's part, if there is space

  std::int64_t work() const {
    std::int64_t sum = work_of_a_cell * box.cells();
    for (const WorkItem& item : items) sum += item.work;
    return sum;
  }
  std::vector<std::uint64_t> work_of_layers() const;
  CutPlane best_plane(const lbm::CutRoom&, std::vector<std::uint64_t> layers) const;
  std::pair<Part, Part> divided(const CutPlane&) const;
};

/// Returns the work of the items in each layer of cells, for one axis after another.
std::vector<std::uint64_t> Part::work_of_layers() const {
  std::vector<std::uint64_t> layers(box.size.x + box.size.y + box.size.z, 0);
  for (const WorkItem& item : items) {
    std::size_t first = 0;
    for (int d = 0; d < 3; first += box.size[d++])
      for (int k = 0; k < item.box.size[d]; ++k)
        layers[first + item.box.lower[d] - box.lower[d] + k] +=
            work_below(item, d, k + 1) - work_below(item, d, k);
  }
  return layers;
}

/// Returns the plane that divides the work best in proportion to the numbers of ranks, given all ranks' work
/// of layers. Among planes that are nearly as good it is that of the least face, then the nearest to an equal
/// division of cells. Nearly as good is by work per rank; the tolerances of successive planes multiply.
/// Without a fluid, where bodies communicate in every sweep, a small face is worth more than balance.
CutPlane Part::best_plane(const lbm::CutRoom& room, std::vector<std::uint64_t> layers) const {
  const double nearly_as_well = work_of_a_cell > 0 ? 1.01 : 1.05;
  std::array<CutPlane, 3> planes;
  std::size_t first = 0;
  for (int d = 0; d < 3; first += box.size[d++]) {
    const auto across = std::span(layers).subspan(first, box.size[d]);
    for (std::uint64_t& layer : across) layer += std::uint64_t(work_of_a_cell * (box.cells() / box.size[d]));
    planes[d] = best_across(d, box, room, across);
  }
  const CutPlane* best =
      &*std::min_element(planes.begin(), planes.end(),
                         [](const CutPlane& a, const CutPlane& b) { return a.largest < b.largest; });
  const double bound = nearly_as_well * best->largest;
  for (const CutPlane& plane : planes)
    if (plane.largest <= bound && plane.face < best->face) best = &plane;
  return *best;
}

/// Returns the parts below and above a plane, without items that have no work there.
std::pair<Part, Part> Part::divided(const CutPlane& plane) const {
  const int axis = plane.axis, at = box.lower[axis] + plane.below;
  Part lower{box, work_of_a_cell, {}, edge}, upper = lower;
  lower.box.size[axis] = plane.below;
  upper.box.lower[axis] = at, upper.box.size[axis] -= plane.below;
  for (const WorkItem& item : items) {
    WorkItem below = item, above = item;
    const int cells = std::clamp(at - item.box.lower[axis], 0, item.box.size[axis]);
    below.box.size[axis] = cells;
    below.work = work_below(item, axis, cells);
    above.box.lower[axis] += cells, above.box.size[axis] -= cells;
    above.work -= below.work;
    if (below.work > 0) lower.items.push_back(below);
    if (above.work > 0) upper.items.push_back(above);
  }
  return {std::move(lower), std::move(upper)};
}

// ---- parallel bisection ----

/// A part of the domain and the ranks that divide it.
class Bisection {
 public:
  Bisection(MPI_Comm all, Part part) : part_(std::move(part)) { MPI_Comm_dup(all, &group_); }
  ~Bisection() { MPI_Comm_free(&group_); }
  Bisection(const Bisection&) = delete;
  Bisection& operator=(const Bisection&) = delete;

  void go() {
    for (int ranks; (ranks = parallel::ranks_of(group_)) > 1;) cut(ranks);
  }

  /// The tree node that this rank reports: that of the cut above which it is the first rank. Rank 0 has none.
  struct Node {
    std::int32_t number = -1;
    lbm::Cut cut{};
  };
  const Node& node() const { return node_; }
  std::int64_t work() const { return part_.work(); }

 private:
  void cut(int ranks) {
    const lbm::CutRoom room = lbm::room_to_cut(part_.box.size, ranks, part_.edge);
    std::vector<std::uint64_t> layers = part_.work_of_layers();
    parallel::sum_over_ranks(group_, std::span(layers));
    const CutPlane plane = part_.best_plane(room, std::move(layers));
    const int here = parallel::rank_of(group_);
    const bool upper = here >= room.lower_leaves;
    if (here == room.lower_leaves)
      node_ = {number_, {plane.axis, part_.box.lower[plane.axis] + plane.below, room.lower_leaves}};
    number_ += upper ? room.lower_leaves : 1;
    const int other_size = upper ? room.lower_leaves : room.upper_leaves;
    const int own_size = ranks - other_size, own_place = here - (upper ? room.lower_leaves : 0);
    auto [below, above] = part_.divided(plane);
    part_ = std::move(upper ? above : below);
    exchange_items((upper ? below : above).items,
                   (upper ? 0 : room.lower_leaves) + int(std::int64_t(own_place) * other_size / own_size));
    MPI_Comm half;
    MPI_Comm_split(group_, upper, here, &half);
    MPI_Comm_free(&group_);
    group_ = half;
  }

  /// Sends items to a rank on the other side of a plane, and receives that rank's.
  void exchange_items(const std::vector<WorkItem>& items, int partner) {
    parallel::Messages messages(group_);
    if (!items.empty()) parallel::put(messages.to(partner), std::span(items));
    messages.exchange_sparse();
    for (const parallel::Messages::Message& m : messages.received())
      for (parallel::ByteReader reader(m.bytes); !reader.done();)
        part_.items.push_back(reader.read<WorkItem>());
  }

  MPI_Comm group_ = MPI_COMM_NULL;
  Part part_;
  std::int32_t number_ = 0;  // of the next node
  Node node_;
};

WeightedCut with_work(MPI_Comm comm, lbm::CutTree tree, std::int64_t mine) {
  const int ranks = parallel::ranks_of(comm);
  const std::int64_t sum = parallel::sum_over_ranks(comm, mine);
  return {{parallel::max_over_ranks(comm, double(mine)), double(sum) / ranks}, std::move(tree)};
}

}  // namespace

WeightedCut weighted_cut(MPI_Comm comm, Int3 cells, std::int64_t work_of_a_cell, std::vector<WorkItem> items,
                         int edge) {
  Bisection bisection(comm, {{{}, cells}, work_of_a_cell, std::move(items), edge});
  bisection.go();
  const int ranks = parallel::ranks_of(comm);
  std::vector<lbm::Cut> nodes(ranks - 1);
  for (const Bisection::Node& node :
       parallel::gathered(comm, std::span(&bisection.node(), 1), parallel::GatherTo::all_ranks))
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

// ---- prediction ----

namespace {

void divide(const Part& part, int ranks, std::vector<double>& shares) {
  if (ranks == 1) return shares.push_back(double(part.work()));
  const lbm::CutRoom room = lbm::room_to_cut(part.box.size, ranks);
  const auto [lower, upper] = part.divided(part.best_plane(room, part.work_of_layers()));
  divide(lower, room.lower_leaves, shares);
  divide(upper, room.upper_leaves, shares);
}

WorkShares summed(const std::vector<double>& shares) {
  return {*std::max_element(shares.begin(), shares.end()),
          std::accumulate(shares.begin(), shares.end(), 0.) / double(shares.size())};
}

}  // namespace

WorkShares foreseen_cut(lbm::Int3 cells, std::int64_t work_of_a_cell, std::vector<WorkItem> items,
                        int ranks) {
  std::vector<double> shares;
  divide({{{}, cells}, work_of_a_cell, std::move(items)}, ranks, shares);
  return summed(shares);
}

WorkShares shares_of(const lbm::Domain& domain, std::int64_t work_of_a_cell,
                     const std::vector<WorkItem>& items) {
  std::vector<double> shares(domain.ranks(), 0);
  for (int b = 0; b < domain.blocks(); ++b)
    shares[domain.rank_of(b)] += double(work_of_a_cell * domain.block(b).box.cells());
  for (const WorkItem& item : items) {
    lbm::Int3 middle;
    for (int d = 0; d < 3; ++d) middle[d] = item.box.lower[d] + item.box.size[d] / 2;
    shares[domain.rank_at(middle)] += double(item.work);
  }
  return summed(shares);
}

}  // namespace silt::coupler
