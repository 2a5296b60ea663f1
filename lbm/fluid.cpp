#include "lbm/fluid.hpp"

#include <algorithm>

#include "lbm/blocks/local_blocks.hpp"
#include "lbm/collision/heat_rates.hpp"
#include "lbm/passes/passes.hpp"
#include "parallel/communicator.hpp"

namespace silt::lbm {

namespace {
/// Returns the blocks whose arrays a new fluid may take. Populations of a fluid in its other parity would lie
/// elsewhere in the same array.
template <class T>
std::span<const Block<T>> blocks_to_take(const Fluid<T>* before) {
  if (!before || before->parity() != Parity::settled) return {};
  return before->blocks();
}
}  // namespace

double half_push(const std::array<double, 3>& force, int i) {
  return 1.5 * D3Q19::w(i) * (D3Q19::c[i].x * force[0] + D3Q19::c[i].y * force[1] + D3Q19::c[i].z * force[2]);
}

template <class T>
Fluid<T>::Fluid(const Domain& domain, const CollisionSpec& spec, MPI_Comm comm, Device device,
                const Fluid* before)
    : domain_(domain),
      spec_(spec),
      rates_(std::make_unique<CollisionRates<T>>(spec)),
      comm_(comm),
      device_(device),
      blocks_(local_blocks<T, D3Q19>(domain, parallel::rank_of(comm), device, blocks_to_take(before))),
      pass_(domain, comm, device, *rates_, blocks_),
      halo_(domain_, comm, blocks_, pass_.orders(), {spec.force, spec.reversed_at_outlets()}, device) {}

template <class T>
Fluid<T>::~Fluid() = default;

template <class T>
void Fluid<T>::set_force(const std::array<double, 3>& force) {
  spec_.force = force;
  *rates_ = CollisionRates<T>(spec_);
  rates_->heat = heat_rates_.get();
  halo_.set_force(force);
}

template <class T>
void Fluid<T>::carry(Carried& carried, const HeatSpec& heat, std::span<Block<T, D3Q7>> blocks) {
  carried_ = &carried;
  heat_rates_ = std::make_unique<HeatRates<T>>(heat, spec_);
  rates_->heat = heat_rates_.get();
  for (std::size_t b = 0; b < blocks_.size(); ++b) blocks_[b].carry(blocks[b]);
  pass_.pass_no_array_whole();  // cells of no block have no temperature
}

template <class T>
void Fluid<T>::set_side_velocity(int side, const std::array<double, 3>& velocity) {
  domain_.set_side_velocity(side, velocity);
  halo_.take_side_velocities(domain_, blocks_);
}

template <class T>
void Fluid<T>::take_and_keep_excess() {
  if (is_given_up_) return;
  given_up_.resize(blocks_.size());
  for (std::size_t b = 0; b < blocks_.size(); ++b) keep_excess(b);
  is_given_up_ = true;
  for (Block<T>& block : blocks_)
    if (block.excess()) passes_on<T>(device_).take_excess(block, parity());
  wait(device_);
}

/// Records the amounts that the cells of a block give up.
template <class T>
void Fluid<T>::keep_excess(std::size_t b) {
  const Block<T>& block = blocks_[b];
  given_up_[b].assign(block.excess() ? block.excess_cells() : 0, {});
  for_cells({}, block.size(), [&](Int3 x) {
    if (!block.has_excess(x.y, x.z)) return;
    const std::ptrdiff_t cell = block.cell(x);
    const ExcessQuanta<T> excess = block.excess()[cell];
    if (excess == 0) return;
    const auto g = [&](int i) { return arriving(int(b), x, i); };
    const GivenUp<T> given = lbm::given_up<T>(T(excess), block.stress_share(), g);
    given_up_[b][std::size_t(cell)] = {given.axis, given.diagonal};
  });
}

template <class T>
void Fluid<T>::begin_pass() {
  pass_.begin();
  halo_.start(flipped(parity()));
  if (carried_) carried_->start_exchange(flipped(parity()));
}

template <class T>
void Fluid<T>::stream_collide() {
  begin_pass();
  for (int b = 0; b < int(blocks_.size()); ++b) {
    if (parts(b) == 0) continue;
    const RowRange inner = pass_order(b).inner();
    const int slices = device_ == Device::gpu ? 1 : 8;  // between checks for messages
    const int planes = std::max(1, (inner.z1 - inner.z0 + slices - 1) / slices);
    for (int z = inner.z0; z < inner.z1; z += planes)
      collide_rows(b, {inner.y0, inner.y1, z, std::min(z + planes, inner.z1)});
  }
  end_pass();
}

template <class T>
void Fluid<T>::read(int b, const CellBox& box, int i, double* g) const {
  for (int z = 0; z < box.size.z; ++z)
    for (int y = 0; y < box.size.y; ++y, g += box.size.x) {
      const T* const row =
          blocks_[b].data() + blocks_[b].arriving(i, parity()) + blocks_[b].cell(box.lower + Int3{0, y, z});
      std::copy_n(row, box.size.x, g);
    }
}

template <class T>
void Fluid<T>::write(int b, const CellBox& box, int i, const double* g) {
  for (int z = 0; z < box.size.z; ++z)
    for (int y = 0; y < box.size.y; ++y, g += box.size.x) {
      T* const row = &arriving(b, box.lower + Int3{0, y, z}, i);
      std::transform(g, g + box.size.x, row, [](double x) { return T(x); });
    }
}

/// Returns sum(g), where g[i] points to the population i that arrives at a cell.
template <class T>
template <class Sum>
auto Fluid<T>::for_arriving(int b, Int3 x, Sum&& sum) const {
  const Block<T>& block = blocks_[b];
  const T* g[D3Q19::directions];
  for (int i = 0; i < D3Q19::directions; ++i)
    g[i] = block.data() + block.arriving(i, parity()) + block.cell(x);
  return sum(g);
}

template <class T>
Moments Fluid<T>::moments(int b, Int3 x) const {
  const ExcessQuanta<T>* const excess = blocks_[b].excess();
  return for_arriving(b, x, [&](const T* const(&g)[D3Q19::directions]) {
    return excess ? moments_of(g, 0, excess[blocks_[b].cell(x)], blocks_[b].stress_share())
                  : moments_of(g, 0);
  });
}

template <class T>
typename ListedCells<T>::Block Fluid<T>::listed_block(int b) {
  Block<T>& block = blocks_[b];
  typename ListedCells<T>::Block listed{{}, {}, block.data(), block.excess(), block.stress_share()};
  for (int i = 0; i < D3Q19::directions; ++i)
    listed.arriving[i] = block.arriving(i, parity()), listed.step[i] = block.step(i);
  return listed;
}

template <class T>
ListedCells<T> Fluid<T>::listed(std::span<const LocalCell> cells, CellLists<T>& lists) {
  lists.cells.host().resize(cells.size());
  for (std::size_t k = 0; k < cells.size(); ++k)
    lists.cells.host()[k] = {std::uint32_t(blocks_[cells[k].block].cell(cells[k].cell)),
                             std::uint32_t(cells[k].block)};
  lists.cells.send();
  return listed_again(lists);
}

template <class T>
ListedCells<T> Fluid<T>::listed_again(CellLists<T>& lists) {
  lists.blocks.host().clear();
  for (int b = 0; b < int(blocks_.size()); ++b) lists.blocks.host().push_back(listed_block(b));
  return {lists.cells.device(), std::int64_t(lists.cells.size()), lists.blocks.send()};
}

template <class T>
std::span<const Moments> Fluid<T>::moments(std::span<const LocalCell> cells) {
  std::pmr::vector<Moments>& found = cell_moments_.host();
  found.resize(cells.size());
  passes_on<T>(device_).gather_moments(listed(cells, listed_), cell_moments_.make_room());
  cell_moments_.fetch(), wait(device_);
  return found;
}

template <class T>
void Fluid<T>::moments(int b, const CellBox& box, MomentArrays& moments) const {
  moments.resize(box.cells());
  std::int64_t n = 0;
  for (int z = 0; z < box.size.z; ++z)
    for (int y = 0; y < box.size.y; ++y, n += box.size.x)
      for_arriving(b, box.lower + Int3{0, y, z},
                   [&](const T* const(&g)[D3Q19::directions]) { moments.sum(g, n, box.size.x); });
}

template <class T>
CellTotals Fluid<T>::totals(int b, const LocalRows& of) const {
  CellTotals found;
  passes_on<T>(Device::cpu).total_rows(blocks_[b], parity(), {&of, 1}, spec_.force, &found);
  return found;
}

template <class T>
void Fluid<T>::totals(int b, std::span<const LocalRows> of, CellTotals* totals_of) const {
  passes_on<T>(device_).total_rows(blocks_[b], parity(), of, spec_.force, totals_of);
}

template <class T>
void Fluid<T>::give_masses(std::span<const LocalCell> cells, std::span<const std::int64_t> masses) {
  if (cells.empty()) return;
  for (const auto& [b, x] : cells)
    blocks_[b].hold_excess({x.y, x.y + 1, x.z, x.z + 1}, T(spec_.bulk_stress_given_up()), device_);
  cell_masses_.host().assign(masses.begin(), masses.end());
  passes_on<T>(device_).give_masses(listed(cells, listed_), cell_masses_.send());
  wait(device_);
}

template <class T>
std::size_t Fluid<T>::bytes() const {
  std::size_t n = 0;
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    if (b == 0 || !blocks_[b].shares_array(blocks_[b - 1])) n += blocks_[b].bytes();
  return n;
}

template class Fluid<float>;
template class Fluid<double>;

}  // namespace silt::lbm
