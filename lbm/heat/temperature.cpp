#include "lbm/heat/temperature.hpp"

#include "lbm/blocks/local_blocks.hpp"
#include "parallel/communicator.hpp"

namespace silt::lbm {

namespace {

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
Temperature<T>::Temperature(Fluid<T>& fluid, const HeatSpec& spec, const std::array<SideCondition, 6>& sides)
    : fluid_(fluid),
      domain_(with_sides(fluid.domain(), sides)),
      spec_(spec),
      blocks_(local_blocks<T, D3Q7>(domain_, parallel::rank_of(fluid.comm()), fluid.device())),
      none_idle_(blocks_.size(), 0),
      halo_(domain_, fluid.comm(), blocks_, fluid.pass_orders(), {}, fluid.device()) {
  fluid.carry(*this, spec, blocks_);
}

template <class T>
double Temperature<T>::at(int b, Int3 cell) const {
  double sum = 0;
  for (int i = 0; i < D3Q7::directions; ++i) sum += arriving(b, cell, i);
  return sum;
}

template <class T>
void Temperature<T>::set(int b, Int3 cell, double temperature, const std::array<double, 3>& u) {
  for (int i = 0; i < D3Q7::directions; ++i) arriving(b, cell, i) = T(heat_equilibrium(i, temperature, u));
}

template <class T>
std::size_t Temperature<T>::bytes() const {
  std::size_t n = 0;
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    if (b == 0 || !blocks_[b].shares_array(blocks_[b - 1])) n += blocks_[b].bytes();
  return n;
}

template class Temperature<float>;
template class Temperature<double>;

}  // namespace silt::lbm
