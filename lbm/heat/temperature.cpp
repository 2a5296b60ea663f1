#include "lbm/heat/temperature.hpp"

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
Temperature<T>::Temperature(Fluid<T>& fluid, const HeatSpec& spec, const std::array<SideCondition, 6>& sides)
    : fluid_(fluid),
      domain_(with_sides(fluid.domain(), sides)),
      spec_(spec),
      blocks_(blocks_like(fluid)),
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
