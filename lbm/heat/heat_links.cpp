#include "lbm/heat/heat_links.hpp"

#include <algorithm>

namespace silt::lbm {

namespace {

/// The populations of a link: those that left the cell towards the surface and from it, the one that arrives
/// from behind, and the one that the surface returns.
template <class T>
class HeatSlots {
 public:
  HeatSlots(Block<T, D3Q7>& block, Parity parity) : data_(block.data()) {
    for (int i = 0; i < D3Q7::directions; ++i)
      leaving_[i] = block.leaving(i, parity), arriving_[i] = block.arriving(i, parity);
  }
  double out(const HeatLink& l) const { return data_[leaving_[l.direction] + l.cell]; }
  double against(const HeatLink& l) const { return data_[leaving_[opposite(l.direction)] + l.cell]; }
  double behind(const HeatLink& l) const { return data_[arriving_[l.direction] + l.cell]; }
  T& back(const HeatLink& l) const { return data_[arriving_[opposite(l.direction)] + l.cell]; }
  double temperature(const HeatLink& l) const {
    double sum = 0;
    for (int i = 0; i < D3Q7::directions; ++i) sum += double(data_[leaving_[i] + l.cell]);
    return sum;
  }

 private:
  T* data_;
  std::ptrdiff_t leaving_[D3Q7::directions], arriving_[D3Q7::directions];
};

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

template <class T>
double distance(const CutLinks<T>& links, const HeatLink& l) {
  return links.rate.empty() ? links.q[l.link] : links.q[l.link] + links.age * links.rate[l.link];
}

/// Returns what a moving surface sweeps of the heat at an insulated link.
template <class T>
double swept(const HeatSlots<T>& slots, const Block<T, D3Q7>& block, const CutLinks<T>& links,
             const SurfaceMotion& motion, const HeatLink& l) {
  const double u = velocity_along(links.frame, motion, block.cell_at(l.cell), D3Q7::c[l.direction]);
  return u == 0 ? 0 : slots.temperature(l) * u;
}

/// Returns c_i·G of a link.
double gradient_along(const SurfaceHeat& surface, const HeatLink& l) {
  return surface.fluid ? surface.fluid->gradient_along(l.direction) : 0;
}

/// Returns the temperature of a surface at a link, less the mean.
template <class T>
double temperature_at(const SurfaceHeat& surface, const Block<T, D3Q7>& block, const SurfaceFrame& frame,
                      const HeatLink& l, double q) {
  if (!surface.fluid) return surface.temperature;
  const std::array<double, 3> arm = arm_of(frame, block.cell_at(l.cell)), &g = surface.fluid->gradient;
  return surface.temperature - (arm[0] * g[0] + arm[1] * g[1] + arm[2] * g[2]) -
         q * gradient_along(surface, l);
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
void tell_pockets(Block<T, D3Q7>& block, Parity parity, const CutLinks<T>& links,
                  std::span<const HeatLink> along_axes, const SurfaceMotion& motion, const HeatSpec& fluid,
                  std::span<PocketLink> told) {
  const HeatSlots<T> slots(block, parity);
  const double of_gradient = D3Q7::w(1) * fluid.relaxation_time();  // as if from the middle of the pocket
  for (const HeatLink& l : along_axes)
    if (l.pocket >= 0)
      told[l.pocket] = {slots.out(l) - 0.5 * swept(slots, block, links, motion, l) -
                            of_gradient * fluid.gradient_along(l.direction),
                        pocket_share(distance(links, l), fluid.excess())};
}

template <class T>
void apply_heat_links(Block<T, D3Q7>& block, Parity parity, const CutLinks<T>& links,
                      std::span<const HeatLink> along_axes, const SurfaceHeat& surface,
                      const SurfaceMotion& motion, PocketLinks told, HeatSums& sums) {
  const HeatSlots<T> slots(block, parity);
  const double returned = double(surface.by_each_link) * heat_quantum;
  for (const HeatLink& l : along_axes) {
    const double out = slots.out(l);
    T& back = slots.back(l);
    if (surface.insulates) {
      const double from_others = l.pocket >= 0 ? from_pocket(told, l.pocket) : 0;
      const double conducted = surface.fluid ? surface.fluid->diffusivity * gradient_along(surface, l) : 0;
      back = T(out - swept(slots, block, links, motion, l) + from_others + returned - conducted);
    } else {
      const double q = distance(links, l);
      const HeatCoefficients k = coefficients(l, q);
      back = T(k.out * out + k.behind * slots.behind(l) + k.against * slots.against(l) +
               k.surface * temperature_at(surface, block, links.frame, l, q));
      sums.conductance += heat_quanta(k.surface);
    }
    sums.heat += heat_quanta(out - double(back));
  }
}

template <class T>
std::int64_t correct_heat_links(Block<T, D3Q7>& block, Parity parity, const CutLinks<T>& links,
                                std::span<const HeatLink> along_axes, double increment) {
  const HeatSlots<T> slots(block, parity);
  std::int64_t heat = 0;
  for (const HeatLink& l : along_axes) {
    T& back = slots.back(l);
    const T before = back;
    back = T(before + coefficients(l, distance(links, l)).surface * increment);
    heat += heat_quanta(slots.out(l) - double(back)) - heat_quanta(slots.out(l) - double(before));
  }
  return heat;
}

template void tell_pockets(Block<float, D3Q7>&, Parity, const CutLinks<float>&, std::span<const HeatLink>,
                           const SurfaceMotion&, const HeatSpec&, std::span<PocketLink>);
template void tell_pockets(Block<double, D3Q7>&, Parity, const CutLinks<double>&, std::span<const HeatLink>,
                           const SurfaceMotion&, const HeatSpec&, std::span<PocketLink>);
template void apply_heat_links(Block<float, D3Q7>&, Parity, const CutLinks<float>&, std::span<const HeatLink>,
                               const SurfaceHeat&, const SurfaceMotion&, PocketLinks, HeatSums&);
template void apply_heat_links(Block<double, D3Q7>&, Parity, const CutLinks<double>&,
                               std::span<const HeatLink>, const SurfaceHeat&, const SurfaceMotion&,
                               PocketLinks, HeatSums&);
template std::int64_t correct_heat_links(Block<float, D3Q7>&, Parity, const CutLinks<float>&,
                                         std::span<const HeatLink>, double);
template std::int64_t correct_heat_links(Block<double, D3Q7>&, Parity, const CutLinks<double>&,
                                         std::span<const HeatLink>, double);

}  // namespace silt::lbm
