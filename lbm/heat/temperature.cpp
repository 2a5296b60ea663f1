#include "lbm/heat/temperature.hpp"

#include "lbm/heat/carry_heat.hpp"

namespace silt::lbm {

namespace {

template <class T>
std::vector<Block<T, D3Q7>> blocks_like(const Fluid<T>& fluid) {
  std::vector<Block<T, D3Q7>> blocks;
  for (const Block<T>& block : fluid.blocks()) blocks.emplace_back(block.box());
  return blocks;
}

Domain with_sides(const Domain& domain, const std::array<SideCondition, 6>& sides) {
  return Domain(domain.tree(), sides, domain.ranks(), domain.level());
}

}  // namespace

SideCondition heat_side(int side, double flux) {
  SideCondition condition{SideKind::bounce};
  condition.velocity[side / 2] = (side % 2 == 0 ? 1 : -1) * flux / (6 * D3Q7::w(1));  // see wall_addend()
  return condition;
}

template <class T>
Temperature<T>::Temperature(const Fluid<T>& fluid, const HeatSpec& spec,
                            const std::array<SideCondition, 6>& sides)
    : fluid_(fluid),
      domain_(with_sides(fluid.domain(), sides)),
      spec_(spec),
      rates_(spec, fluid.spec().force),
      blocks_(blocks_like(fluid)),
      none_idle_(blocks_.size(), 0),
      parity_(fluid.parity()),
      halo_(domain_, fluid.comm(), blocks_, fluid.pass_orders(), {}, fluid.device()) {}

template <class T>
void Temperature<T>::carry(int b, RowRange rows) {
  static const CarryHeat<T> kernel = SILT_CHOSEN(carry_heat<T>)();
  kernel(blocks_[b], fluid_.blocks()[b], parity_, rates_, rows);
}

template <class T>
void Temperature<T>::begin_pass() {
  for (int d = 0; d < 3; ++d) rates_.half_force[d] = T(fluid_.spec().force[d] / 2);
  for (int b = 0; b < int(blocks_.size()); ++b)
    for (const RowRange& rows : fluid_.pass_order(b).shell())
      if (fluid_.parts(b) > 0) carry(b, rows);
  halo_.start(flipped(parity_));
}

template <class T>
void Temperature<T>::collide(int b, int part) {
  carry(b, fluid_.pass_order(b).rows_of(part));
}

template <class T>
void Temperature<T>::stream_collide() {
  begin_pass();
  for (int b = 0; b < int(blocks_.size()); ++b)
    for (int part = 0; part < fluid_.parts(b); ++part) collide(b, part);
  end_pass();
}

template <class T>
double Temperature<T>::at(int b, Int3 cell) const {
  double sum = 0;
  for (int i = 0; i < D3Q7::directions; ++i) sum += arriving(b, cell, i);
  return sum;
}

template <class T>
void Temperature<T>::set(int b, Int3 cell, double temperature, const std::array<double, 3>& u) {
  for (int i = 0; i < D3Q7::directions; ++i) {
    const Int3 c = D3Q7::c[i];
    arriving(b, cell, i) = T(D3Q7::w(i) * temperature * (1 + 4 * (c.x * u[0] + c.y * u[1] + c.z * u[2])));
  }
}

template <class T>
std::size_t Temperature<T>::bytes() const {
  std::size_t n = 0;
  for (const auto& block : blocks_) n += block.bytes();
  return n;
}

template class Temperature<float>;
template class Temperature<double>;

}  // namespace silt::lbm
