#include "coupler/heat/heat_pockets.hpp"

#include <algorithm>
#include <set>

#include "parallel/communicator.hpp"

namespace silt::coupler {

using lbm::D3Q7;
using lbm::Int3;
using lbm::pocket_links;

namespace {

bool is_in(const lbm::Domain& domain, Int3 cell) {
  for (int d = 0; d < 3; ++d)
    if (!domain.periodic(d) && (cell[d] < 0 || cell[d] >= domain.cells()[d])) return false;
  return true;
}

lbm::SlotRun slots_of(std::int32_t place) {
  constexpr std::uint32_t numbers = sizeof(lbm::PocketLink) / sizeof(double);
  return {0, numbers * std::uint32_t(place), 1, numbers};
}

}  // namespace

HeatPockets::HeatPockets(const lbm::Domain& domain, MPI_Comm comm)
    : domain_(domain), rank_(parallel::rank_of(comm)), slots_(comm, 8) {}

void HeatPockets::clear() {
  pockets_.clear(), told_.clear(), slots_.clear();
}

/// Links from opposite sides do not share a pocket: what is between them may be a thin wall. Ranks without a
/// link that shares it do not list it.
HeatPockets::Pocket HeatPockets::found(const BlockMap& map, Int3 solid) const {
  Pocket pocket{-1, {}};
  const auto is_fluid = [&](int i) {
    const Int3 cell = solid - D3Q7::c[i];
    return !map.solid.test(cell) && is_in(domain_, map.box.lower + cell);
  };
  for (int i = 1; i < D3Q7::directions; ++i) {
    const bool leads = is_fluid(i) && !is_fluid(lbm::opposite(i));
    pocket.owners[i - 1] = leads ? domain_.rank_at(domain_.wrapped(map.box.lower + solid - D3Q7::c[i])) : -1;
  }
  return pocket;
}

std::int32_t HeatPockets::place_of(const BlockMap& map, Int3 solid, int i) {
  if (!is_in(domain_, map.box.lower + solid)) return -1;
  const Pocket pocket = found(map, solid);
  if (pocket.owners[i - 1] < 0 || std::ranges::count(pocket.owners, -1) > pocket_links - 2) return -1;
  const Int3 g = domain_.wrapped(map.box.lower + solid), n = domain_.cells();
  const auto [at, is_new] = pockets_.try_emplace((std::int64_t(g.z) * n.y + g.y) * n.x + g.x, pocket);
  if (is_new) {
    at->second.first = std::int32_t(told_.size());
    told_.resize(told_.size() + pocket_links);
  }
  return at->second.first + i - 1;
}

void HeatPockets::list_shared() {
  for (const auto& [cell, pocket] : pockets_) {
    std::set<int> others(pocket.owners, pocket.owners + pocket_links);
    others.erase(-1), others.erase(rank_);
    for (int k = 0; k < pocket_links; ++k) {
      const int owner = pocket.owners[k];
      if (owner == rank_)
        for (const int rank : others) slots_.sent(rank).add(slots_of(pocket.first + k));
      else if (owner >= 0)
        slots_.received(owner).add(slots_of(pocket.first + k));
    }
  }
}

void HeatPockets::exchange() {
  static_assert(std::is_standard_layout_v<lbm::PocketLink>);
  double* const values = reinterpret_cast<double*>(told_.data());
  const double* const from = values;
  slots_.start({&from, 1});
  slots_.finish({&from, 1}, {&values, 1});
}

}  // namespace silt::coupler
