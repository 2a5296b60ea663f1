#include "coupler/heat/heat_flow.hpp"

#include <algorithm>
#include <bit>
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

namespace {

/// Returns the conditions of the temperature at the sides: an inlet brings the reference temperature if it
/// has no other.
std::array<lbm::SideCondition, 6> heat_sides(const HeatSpec& heat, const std::array<BoundarySpec, 6>& sides) {
  std::array<lbm::SideCondition, 6> all;
  for (int side = 0; side < 6; ++side) {
    const SideHeat& of = heat.sides[side];
    if (sides[side].is_periodic()) continue;
    all[side] = lbm::heat_side(side, of.flux);
    if (sides[side].is_outlet()) all[side].kind = lbm::SideKind::open;
    if (!of.temperature && !sides[side].is_inlet()) continue;
    all[side].kind = lbm::SideKind::temperature;
    all[side].value = of.temperature.value_or(0);
  }
  return all;
}

}  // namespace

template <class T>
HeatFlow<T>::HeatFlow(const HeatSpec& spec, const std::array<BoundarySpec, 6>& sides, lbm::Fluid<T>& fluid,
                      ParallelBodyExchange& exchange)
    : spec_(spec),
      fluid_(fluid),
      exchange_(exchange),
      temperature_(fluid, spec, heat_sides(spec, sides)),
      links_(fluid.blocks().size()),
      pockets_(fluid.domain(), fluid.comm()),
      passed_on_(std::min(1.0, spec.diffusivity)) {}

template <class T>
const BodyHeat& HeatFlow<T>::spec_of(const rigid::BodySet& bodies, std::size_t row) const {
  static const BodyHeat insulating;
  if (row < bodies.first_wall()) return spec_.kinds.empty() ? insulating : spec_.kinds[bodies.kind[row]];
  const std::size_t curved = bodies.size() - spec_.walls.size();  // rows of [[walls]] are last
  return row < curved ? insulating : spec_.walls[row - curved];
}

template <class T>
lbm::SurfaceHeat HeatFlow<T>::surface(const rigid::BodySet& bodies, std::size_t row) const {
  const BodyHeat& spec = spec_of(bodies, row);
  const CouplingState& state = coupling_of(bodies, row);
  const lbm::HeatSpec* const lacks = spec_.has_gradient() ? &spec_ : nullptr;
  if (!spec.temperature) return {true, 0, state.heat_owed.by_each_link, lacks};
  if (row >= bodies.first_wall()) return {false, *spec.temperature, 0};  // walls have the gradient
  return {false, spec.capacity > 0 ? state.temperature.numbers[0] : *spec.temperature, 0, lacks};
}

template <class T>
void HeatFlow<T>::begin_step(const rigid::BodySet& bodies) {
  sums_.assign(bodies.size() * width, 0);
}

template <class T>
void HeatFlow<T>::change_cells(std::span<const BlockMap> maps, const ChangedCells& changed,
                               const rigid::BodySet& bodies) {
  const auto take = [&](const CoveredCell& cell, int sign) {
    const std::size_t row = bodies.row_of(cell.body->id);
    const lbm::SurfaceHeat of = row < bodies.size() ? surface(bodies, row) : lbm::SurfaceHeat{};
    if (sign < 0) set_uncovered(maps[cell.block], cell, of);
    if (row >= bodies.size()) return;
    sums(row)[heat] += sign * lbm::heat_quanta(temperature_.at(cell.block, cell.cell) - of.temperature);
    sums(row)[cells] += sign;
  };
  for (const CoveredCell& cell : changed.covered) take(cell, +1);
  for (const CoveredCell& cell : changed.uncovered) take(cell, -1);
}

/// Keeps the populations that arrive from fluid. The others and that at rest make a cell of the surface's
/// temperature, or, if it insulates, of the mean that arrives.
template <class T>
void HeatFlow<T>::set_uncovered(const BlockMap& map, const CoveredCell& at, const lbm::SurfaceHeat& surface) {
  const auto g = [&](int i) -> T& { return temperature_.arriving(at.block, at.cell, i); };
  double from_fluid = 0;
  int count = 0;
  bool is_known[D3Q7::directions] = {};
  for (int i = 1; i < D3Q7::directions; ++i) {
    is_known[i] = map.was_and_is_fluid(at.cell - D3Q7::c[i]);
    if (is_known[i]) from_fluid += double(g(i)), ++count;
  }
  const double mean = count > 0 ? from_fluid / (count * D3Q7::w(1)) : 0,
               temperature = surface.insulates ? mean : surface.temperature;
  double sum = 0;
  for (int i = 1; i < D3Q7::directions; ++i) {
    if (!is_known[i]) {
      const int from = lbm::opposite(i);
      g(i) = T(is_known[from] ? 2 * D3Q7::w(1) * temperature - double(g(from)) : D3Q7::w(1) * temperature);
    }
    sum += double(g(i));
  }
  g(0) = T(temperature - sum);
}

template <class T>
void HeatFlow<T>::list_links(int b, const BlockMap& map, const BlockLinks<T>& block) {
  lbm::wait(fluid_.device());
  links_[b].resize(block.surfaces.size());
  for (std::size_t k = 0; k < block.surfaces.size(); ++k) {
    links_[b][k].clear();
    for (const lbm::LinkGroup& group : block.surfaces[k].links.groups)
      lbm::add_heat_links(
          temperature_.blocks()[b], block.surfaces[k].links, group,
          [&](Int3 cell) { return map.solid.test(cell); }, links_[b][k]);
  }
}

template <class T>
void HeatFlow<T>::find_pockets(std::span<const BlockMap> maps, const rigid::BodySet& bodies) {
  pockets_.clear();
  for (std::size_t b = 0; b < maps.size(); ++b)
    for (std::size_t k = 0; k < links_[b].size(); ++k) {
      if (spec_of(bodies, maps[b].masks[k].row).temperature) continue;
      for (lbm::HeatLink& l : links_[b][k]) {
        const Int3 solid = temperature_.blocks()[b].cell_at(l.cell) + D3Q7::c[l.direction];
        l.pocket = pockets_.place_of(maps[b], solid, l.direction);
      }
    }
  pockets_.list_shared();
}

template <class T>
template <class Visit>
void HeatFlow<T>::for_surfaces(std::span<const BlockLinks<T>> blocks, Visit&& visit) {
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (std::size_t k = 0; k < links_[b].size(); ++k) {
      const SurfaceLinks<T>& of = blocks[b].surfaces[k];
      visit(of.row, lbm::SurfaceHeatLinks<T>(temperature_.blocks()[b], temperature_.parity(), of.links,
                                             of.motion, links_[b][k]));
    }
}

template <class T>
void HeatFlow<T>::exchange_heat(std::span<const BlockLinks<T>> blocks, rigid::BodySet& bodies) {
  for_surfaces(blocks, [&](std::size_t row, const lbm::SurfaceHeatLinks<T>& of) {
    if (!spec_of(bodies, row).temperature) of.tell_pockets(spec_, pockets_.told());
  });
  pockets_.exchange();
  for_surfaces(blocks, [&](std::size_t row, const lbm::SurfaceHeatLinks<T>& of) {
    const lbm::HeatSums found = of.apply(surface(bodies, row), pockets_.told());
    sums(row)[heat] += found.heat, sums(row)[conductance] += found.conductance;
    sums(row)[links] += of.count();
  });
  of_walls_.resize(bodies.walls);
  for (std::size_t w = 0; w < bodies.walls; ++w) of_walls_[w] = sums(bodies.first_wall() + w)[heat];
  exchange_.sum_to_owners(bodies, sums_, width);
  std::vector<double> changes(bodies.size() * shared, 0.0);  // of temperature; then the heat owed, as it is
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    owe(bodies, row);
    double* const to = changes.data() + row * shared;
    const OwedHeat& owed = coupling_of(bodies, row).heat_owed;
    to[0] = foreseen_change(bodies, row);
    to[1] = std::bit_cast<double>(owed.all), to[2] = std::bit_cast<double>(owed.by_each_link);
  }
  exchange_.share_with_copies(bodies, changes, shared);
  for (std::size_t row = bodies.owned; row < bodies.owned + bodies.copies; ++row) {
    const double* const of = changes.data() + row * shared;
    coupling_of(bodies, row).heat_owed = {std::bit_cast<std::int64_t>(of[1]),
                                          std::bit_cast<std::int64_t>(of[2])};
  }
  if (std::ranges::any_of(spec_.kinds, [](const BodyHeat& kind) { return kind.capacity > 0; }))
    correct(blocks, bodies, changes);
  for (std::size_t row = 0; row < bodies.owned; ++row) {  // passes on a share of what has not been yet
    double& flow = coupling_of(bodies, row).heat_flow.numbers[0];
    flow += passed_on_ * (got(row) - flow);
  }
}

/// Adds to the heat that an owned row owes: what an insulating one got; of one with a heat capacity what the
/// cells that it covers beyond those that it uncovers hold at its temperature.
template <class T>
void HeatFlow<T>::owe(rigid::BodySet& bodies, std::size_t row) {
  CouplingState& state = coupling_of(bodies, row);
  const std::int64_t* const of = sums(row);
  if (!spec_of(bodies, row).temperature) {
    state.heat_owed.all += of[heat];
    state.heat_owed.by_each_link = of[links] > 0 ? state.heat_owed.all / of[links] : 0;
  } else if (spec_of(bodies, row).capacity > 0) {
    state.heat_owed.all += lbm::heat_quanta(double(of[cells]) * state.temperature.numbers[0]);
  }
}

/// Returns the change of temperature of an owned row by which its links must be corrected.
template <class T>
double HeatFlow<T>::foreseen_change(const rigid::BodySet& bodies, std::size_t row) const {
  const BodyHeat& spec = spec_of(bodies, row);
  if (spec.capacity == 0) return 0;
  return (got(row) + spec.source) /
         (bodies.mass[row] * spec.capacity + double(sums(row)[conductance]) * lbm::heat_quantum);
}

/// Corrects the links of bodies with a heat capacity for their changes of temperature, and warms these by
/// what the fluid has then lost.
template <class T>
void HeatFlow<T>::correct(std::span<const BlockLinks<T>> blocks, rigid::BodySet& bodies,
                          std::span<const double> changes) {
  for_surfaces(blocks, [&](std::size_t row, const lbm::SurfaceHeatLinks<T>& of) {
    if (const double change = changes[shared * row]; change != 0) sums(row)[heat] += of.correct(change);
  });
  exchange_.sum_to_owners(bodies, sums_, width);
  std::vector<double> temperatures(bodies.size());
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const BodyHeat& spec = spec_of(bodies, row);
    double& temperature = coupling_of(bodies, row).temperature.numbers[0];
    if (spec.capacity > 0) temperature += (got(row) + spec.source) / (bodies.mass[row] * spec.capacity);
    temperatures[row] = temperature;
  }
  exchange_.share_with_copies(bodies, temperatures, 1);
  for (std::size_t row = bodies.owned; row < bodies.owned + bodies.copies; ++row)
    coupling_of(bodies, row).temperature.numbers[0] = temperatures[row];
}

template class HeatFlow<float>;
template class HeatFlow<double>;

}  // namespace silt::coupler
