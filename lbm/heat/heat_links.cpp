#include "lbm/heat/heat_links.hpp"

#include <algorithm>

namespace silt::lbm {

namespace {

/// The coefficients of (H5): of out, of the two others, of the temperature of the surface.
struct HeatCoefficients {
  double out, behind, against, surface;
};
HeatCoefficients coefficients(const HeatLink& link, double q) {
  if (link.gap) {
    const double a = -0.5 / std::max(q, 0.5);
    return {a, 0, 1 + a, -0.25 * a};
  }
  const double b = (2 * q - 1) / (2 * q + 1);
  return {-1, b, b, 0.25 * (1 - b)};
}

/// Returns c_i·G of a link.
double gradient_along(const SurfaceHeat& surface, const HeatLink& l) {
  return surface.fluid ? surface.fluid->gradient_along(l.direction) : 0;
}

/// The share of a link in its pocket, (H6), and what it gets from there.
double pocket_share(double q, double excess) {
  const double k = std::clamp(q, 0.0, 1.0);
  return 2 * excess * k / (1 + (excess - 0.5) * k);
}
double from_pocket(PocketLinks all, std::int32_t place) {
  double shares = 0, sum = 0;
  for (const PocketLink& l : all.subspan(place - place % pocket_links, pocket_links))
    shares += l.share, sum += l.share * l.population;
  return shares > 0 ? all[place].share * (sum / shares - all[place].population) : 0;
}

}  // namespace

template <class T>
SurfaceHeatLinks<T>::SurfaceHeatLinks(Block<T, D3Q7>& block, Parity parity, const CutLinks<T>& links,
                                      const SurfaceMotion& motion, std::span<const HeatLink> along_axes)
    : block_(block), links_(links), motion_(motion), along_axes_(along_axes), data_(block.data()) {
  for (int i = 0; i < D3Q7::directions; ++i)
    leaving_[i] = block.leaving(i, parity), arriving_[i] = block.arriving(i, parity);
}

template <class T>
double SurfaceHeatLinks<T>::distance(const HeatLink& l) const {
  return links_.rate.empty() ? links_.q[l.link] : links_.q[l.link] + links_.age * links_.rate[l.link];
}

/// Returns what a moving surface sweeps of the heat at an insulated link.
template <class T>
double SurfaceHeatLinks<T>::swept(const HeatLink& l) const {
  const double u = velocity_along(links_.frame, motion_, block_.cell_at(l.cell), D3Q7::c[l.direction]);
  if (u == 0) return 0;
  double temperature = 0;
  for (int i = 0; i < D3Q7::directions; ++i) temperature += double(data_[leaving_[i] + l.cell]);
  return temperature * u;
}

/// Returns the temperature of a surface at a link, less the mean.
template <class T>
double SurfaceHeatLinks<T>::temperature_at(const SurfaceHeat& surface, const HeatLink& l, double q) const {
  if (!surface.fluid) return surface.temperature;
  const std::array<double, 3> arm = arm_of(links_.frame, block_.cell_at(l.cell)),
                              &g = surface.fluid->gradient;
  return surface.temperature - (arm[0] * g[0] + arm[1] * g[1] + arm[2] * g[2]) -
         q * gradient_along(surface, l);
}

template <class T>
void SurfaceHeatLinks<T>::tell_pockets(const HeatSpec& fluid, std::span<PocketLink> told) const {
  const double of_gradient = D3Q7::w(1) * fluid.relaxation_time();  // as if from the middle of the pocket
  for (const HeatLink& l : along_axes_)
    if (l.pocket >= 0)
      told[l.pocket] = {out(l) - 0.5 * swept(l) - of_gradient * fluid.gradient_along(l.direction),
                        pocket_share(distance(l), fluid.excess())};
}

template <class T>
HeatSums SurfaceHeatLinks<T>::apply(const SurfaceHeat& surface, PocketLinks told) const {
  const double returned = double(surface.by_each_link) * heat_quantum;
  HeatSums sums;
  for (const HeatLink& l : along_axes_) {
    const double given = out(l);
    T& returns = back(l);
    if (surface.insulates) {
      const double from_others = l.pocket >= 0 ? from_pocket(told, l.pocket) : 0;
      const double conducted = surface.fluid ? surface.fluid->diffusivity * gradient_along(surface, l) : 0;
      returns = T(given - swept(l) + from_others + returned - conducted);
    } else {
      const double q = distance(l);
      const HeatCoefficients k = coefficients(l, q);
      returns = T(k.out * given + k.behind * behind(l) + k.against * against(l) +
                  k.surface * temperature_at(surface, l, q));
      sums.conductance += heat_quanta(k.surface);
    }
    sums.heat += heat_quanta(given - double(returns));
  }
  return sums;
}

template <class T>
std::int64_t SurfaceHeatLinks<T>::correct(double increment) const {
  std::int64_t heat = 0;
  for (const HeatLink& l : along_axes_) {
    T& returns = back(l);
    const T before = returns;
    returns = T(before + coefficients(l, distance(l)).surface * increment);
    heat += heat_quanta(out(l) - double(returns)) - heat_quanta(out(l) - double(before));
  }
  return heat;
}

template class SurfaceHeatLinks<float>;
template class SurfaceHeatLinks<double>;

}  // namespace silt::lbm
