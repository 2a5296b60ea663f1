#include "coupler/forces/fluid_forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "cpu/isa.hpp"
#include "cpu/prefetch.hpp"
#include "lbm/walls/cut_links.hpp"

namespace silt::coupler {

using rigid::Vec3;

namespace {

/// Sets the motion of an image of a body that moves with this velocity and angular velocity.
void set_motion(lbm::SurfaceMotion& m, const Vec6& motion, const Reflection& of) {
  for (int d = 0; d < 3; ++d)
    m.v[d] = of.of_vector(d) * motion[d], m.omega[d] = of.of_axial(d) * motion[3 + d];
}

bool is_at_rest(const lbm::SurfaceMotion& m) {
  return Vec3(m.v[0], m.v[1], m.v[2]).isZero(0) && Vec3(m.omega[0], m.omega[1], m.omega[2]).isZero(0);
}

/// Returns the load and the resistance of a body from those of its mirror image.
lbm::LinkSums reflected(lbm::LinkSums sums, const Reflection& of) {
  for (int d = 0; d < 3; ++d) sums.force[d] *= of.of_vector(d), sums.torque[d] *= of.of_axial(d);
  return sums;
}
lbm::ResistanceSums reflected(lbm::ResistanceSums sums, const Reflection& of) {
  std::int64_t* h = sums.h;
  for (int d = 0; d < RowSums::push_width; ++d) {
    sums.push[d] *= of.of_motion(d);
    for (int e = d; e < RowSums::push_width; ++e) *h++ *= of.of_motion(d) * of.of_motion(e);
  }
  return sums;
}

void add_sums(const lbm::LinkSums& load, const lbm::ResistanceSums& resistance, std::size_t row,
              RowSums& sums) {
  std::int64_t* const force = sums.force(row);
  for (int d = 0; d < 3; ++d) force[d] += load.force[d], force[3 + d] += load.torque[d];
  std::int64_t *const h = sums.resistance(row), *const push = sums.push(row);
  for (int e = 0; e < RowSums::resistance_width; ++e) h[e] += resistance.h[e];
  for (int e = 0; e < RowSums::push_width; ++e) push[e] += resistance.push[e];
}
template <class T>
void add_sums(const SurfaceLinks<T>& of, RowSums& sums) {
  if (of.reflection.any())
    add_sums(reflected(of.sums, of.reflection), reflected(of.resistance, of.reflection), of.row, sums);
  else
    add_sums(of.sums, of.resistance, of.row, sums);
}

// Mass owed to the fluid. Over all links of a body the mass carried by its motion sums to zero, since every
// line of cells that enters the body leaves it. Where bodies touch without a cell between them, or a body
// touches a wall, links are missing, and the excess of the others is the change of the gap's volume. The body
// returns it through all its links in the next step.

/// Returns whether a ball crosses a side through which fluid flows. Its missing links close no gap.
bool crosses_open_side(const lbm::Domain& domain, const Vec3& centre, double radius) {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true}) {
      const double inside = upper ? domain.cells()[axis] - centre[axis] : centre[axis];
      if (domain.side(axis, upper).is_open(axis) && inside < radius) return true;
    }
  return false;
}

/// Sets the mass that an owned body owes after a step in which its links moved with this velocity and angular
/// velocity, and what each link returns in the next step. The exponent is that of the resistance
/// (lbm::ResistanceSums).
template <class T>
void owe_mass(rigid::BodySet& bodies, std::size_t row, const RowSums& sums, const Vec6& motion,
              int exponent) {
  constexpr double resistance_quantum = lbm::resistance_quantum<T>, mass_quantum = lbm::excess_quantum<T>;
  const std::int64_t *const h = sums.resistance(row), *const push = sums.push(row);
  // 6 w |c|^2 is 1/3 along every link
  const std::int64_t links = std::llround(3 * double(h[0] + h[6] + h[11]) * resistance_quantum);
  double carried = 0;
  for (int d = 0; d < 6; ++d) carried += double(push[d]) * std::ldexp(motion[d], d < 3 ? 0 : exponent);
  OwedMass& owed = coupling_of(bodies, row).mass_owed;
  owed.all += std::llround(carried * resistance_quantum / mass_quantum) - links * owed.by_each_link;
  owed.by_each_link = links > 0 ? owed.all / links : 0;
}

}  // namespace

ForceOutOfRange::ForceOutOfRange(rigid::BodyId id)
    : std::overflow_error(
          "is not a number, or is above 32 lattice units on one link, its torque included: the flow around "
          "it has become unstable"),
      on(id) {}

template <class T>
FluidForces<T>::FluidForces(const CouplingSpec& spec, ParallelBodyExchange& exchange, int substeps,
                            double relaxation_time)
    : spec_(spec),
      exchange_(exchange),
      time_(exchange.world(), spec, substeps, relaxation_time, lbm::resistance_quantum<T>),
      sums_(spec.force == ForceForm::exact) {}

template <class T>
void FluidForces<T>::start(std::span<const BlockMap> maps, rigid::BodySet& bodies) {
  if (!is_exact()) return;
  RowSums cells(true);
  cells.reset(bodies.size());
  add_cells(maps, cells);
  exchange_.sum_to_owners(bodies, cells.all(), cells.width());
  for (std::size_t row = 0; row < bodies.owned; ++row) begin_debt(bodies, row, cells);
}

template <class T>
void FluidForces<T>::begin(const lbm::Fluid<T>& fluid, std::span<const BlockMap> maps,
                           std::span<BlockLinks<T>> links, rigid::BodySet& bodies,
                           const BodyChanges& changes) {
  domain_ = &fluid.domain();
  bodies_ = &bodies;
  changes_ = &changes;
  outcome_ = {};
  sums_.reset(bodies.size());
  covered_.add_to(sums_, bodies);
  if (is_exact()) add_cells(maps, sums_);
  for (std::size_t b = 0; b < maps.size(); ++b) {
    const auto& masks = maps[b].masks;
    links[b].slots = lbm::link_slots(fluid.blocks()[b], lbm::flipped(fluid.parity()));
    for (std::size_t k = 0; k < masks.size(); ++k) {
      SurfaceLinks<T>& surface = links[b].surfaces[k];
      surface.row = masks[k].row, surface.sums = {}, surface.finished = false;
      surface.left = std::uint32_t(surface.links.groups.size());
      surface.links.age = T(double(fluid.passes()) - coupling_of(bodies, surface.row).mapped.middle());
      const Vec6 motion = motion_of_links(bodies, surface.row);
      set_motion(surface.motion, motion, surface.reflection);
      surface.motion.mass_by_link = coupling_of(bodies, surface.row).mass_owed.by_each_link;
    }
    links[b].begin_step(double(fluid.passes()), fluid.domain(), maps[b].box.lower);
  }
}

/// A new body gains nothing from the cells it took, since they were not fluid cells that it covered.
template <class T>
void FluidForces<T>::settle(rigid::BodySet& bodies, std::size_t row) {
  if (!is_exact()) return;
  if (!changes_->is_new(bodies.id[row])) return settle_debt(bodies, row, sums_);
  begin_debt(bodies, row, sums_);
  if (bodies.is_dynamic(row)) outcome_.debts_begun.add(impulse_debt(bodies, row));
}

/// Returns velocity and angular velocity of the body's links.
template <class T>
Vec6 FluidForces<T>::motion_of_links(rigid::BodySet& bodies, std::size_t row) const {
  Vec6 motion;
  motion << bodies.velocity[row], bodies.angular_velocity[row];
  return time_.is_implicit() ? Vec6(motion + coupling_of(bodies, row).foreseen_change()) : motion;
}

template <class T>
void FluidForces<T>::owe(rigid::BodySet& bodies, std::size_t row, const Vec6& motion) const {
  const double radius = time_.world().bounding_radii[bodies.shape[row]];
  if (crosses_open_side(*domain_, bodies.position[row], radius))
    coupling_of(bodies, row).mass_owed = {};
  else
    owe_mass<T>(bodies, row, sums_, motion, lbm::resistance_exponent(radius));
}

template <class T>
void FluidForces<T>::apply(lbm::Block<T>& block, const BlockLinks<T>& links, SurfaceLinks<T>& surface,
                           const lbm::LinkGroup& group, const lbm::NextGroup<T>& next, bool at_hand) {
  static const bool last_cache_is_far = silt::last_cache_is_far();
  const bool far = !at_hand || last_cache_is_far;
  lbm::apply_cut_links<T>({block, links.slots, surface.links, group, next, links.pairs_across, &listed_, far},
                          surface.motion, spec_.force, surface.sums);
}

template <class T>
void FluidForces<T>::apply_inner(lbm::Block<T>& block, BlockLinks<T>& links, GroupRange groups,
                                 bool at_hand) {
  const auto& inner = links.inner;
  const std::uint32_t end = groups.end;
  std::uint32_t soon = groups.begin + 2;
  links.for_groups(inner, groups.begin, end, [&](auto& surface, const auto& group, const auto& next) {
    apply(block, links, surface, group, next, at_hand);
    if (!time_.is_implicit()) return;
    if (soon < end) prefetch_row(links.surfaces[inner[soon].surface]);
    ++soon;
    if (--surface.left == 0 && surface.links.frame.whole) finish_body(block, links, surface);
  });
}

/// Prefetches a row that finish_body may need soon.
template <class T>
void FluidForces<T>::prefetch_row(const SurfaceLinks<T>& surface) {
  if (surface.left != 1) return;
  const std::int64_t* const row = sums_.force(surface.row);
  for (int n = 0; n < sums_.width(); n += 8) prefetch_to_write(row + n);
  prefetch_to_write(&bodies_->force[surface.row]), prefetch_to_write(&bodies_->torque[surface.row]);
  prefetch_to_read(&bodies_->inertia_B[surface.row]);
  prefetch_to_read(&bodies_->stored_impulses[surface.row]);
}

/// Does at once what move() would do later, for a body whose links are all in this block.
template <class T>
void FluidForces<T>::finish_body(lbm::Block<T>& block, const BlockLinks<T>& links, SurfaceLinks<T>& surface) {
  const std::size_t row = surface.row;
  if (row >= bodies_->owned || !bodies_->is_dynamic(row) || surface.sums.invalid) return;
  add_sums(surface, sums_);
  settle(*bodies_, row);
  surface.finished = true;
  const Vec6 motion = motion_of_links(*bodies_, row), d = time_.apply_links(*bodies_, row, sums_);
  owe(*bodies_, row, motion + d);
  if (d.isZero(0)) return;
  lbm::SurfaceMotion increment;
  set_motion(increment, d, surface.reflection);
  for (const lbm::LinkGroup& group : surface.links.groups)  // still in cache
    lbm::correct_cut_links<T>({block, links.slots, surface.links, group}, increment);
}

template <class T>
void FluidForces<T>::apply_rims(lbm::Fluid<T>& fluid, std::span<BlockLinks<T>> links) {
  for (std::size_t b = 0; b < links.size(); ++b) {
    const auto& rim = links[b].rim;
    links[b].for_groups(rim, 0, rim.size(), [&](auto& surface, const auto& group, const auto& next) {
      apply(fluid.blocks()[b], links[b], surface, group, next, false);
    });
    links[b].apply_at_once(fluid.blocks()[b], spec_.force);
    for (const SurfaceLinks<T>& surface : links[b].surfaces) {
      if (surface.sums.invalid)
        outcome_.out_of_range = std::min(outcome_.out_of_range, bodies_->id[surface.row]);
    }
  }
}

/// Sums the links of unfinished bodies over blocks, at their owners, except sums out of range.
template <class T>
void FluidForces<T>::gather(std::span<const BlockLinks<T>> links, const rigid::BodySet& bodies) {
  for (const BlockLinks<T>& block : links)
    for (const SurfaceLinks<T>& surface : block.surfaces)
      if (!surface.finished && !surface.sums.invalid) add_sums(surface, sums_);
  outcome_.wall_loads.resize(bodies.walls);
  for (std::size_t w = 0; w < bodies.walls; ++w)
    std::copy_n(sums_.force(bodies.first_wall() + w), RowSums::force_width, outcome_.wall_loads[w].begin());
  exchange_.sum_to_owners(bodies, sums_.all(), sums_.width());
}

template <class T>
void FluidForces<T>::move(lbm::Fluid<T>& fluid, std::span<BlockLinks<T>> links, rigid::BodySet& bodies) {
  std::vector<std::uint8_t> finished(bodies.size(), 0);
  for (const BlockLinks<T>& block : links)
    for (const SurfaceLinks<T>& surface : block.surfaces)
      if (surface.finished) finished[surface.row] = 1;
  std::vector<double> corrections(bodies.size() * 6, 0.0);
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (finished[row]) continue;
    settle(bodies, row);
    Eigen::Map<Vec6> correction(corrections.data() + row * 6);
    const Vec6 motion = motion_of_links(bodies, row);
    if (bodies.is_dynamic(row))
      correction = time_.apply_links(bodies, row, sums_);
    else
      add_link_force(bodies, row, sums_);
    owe(bodies, row, motion + correction);
  }
  share(bodies, corrections);
  for (std::size_t b = 0; b < links.size(); ++b) correct(fluid.blocks()[b], links[b], bodies, corrections);
}

/// Sends to copies the corrections (6 per row), the foreseen changes, and the mass that each link returns.
template <class T>
void FluidForces<T>::share(rigid::BodySet& bodies, std::span<double> corrections) const {
  constexpr int width = 14;
  std::vector<double> changes(bodies.size() * width, 0.0);
  const auto change = [&](std::size_t row) { return Eigen::Map<Vec6>(changes.data() + row * width); };
  const auto foreseen = [&](std::size_t row) { return Eigen::Map<Vec6>(changes.data() + row * width + 6); };
  const auto correction = [&](std::size_t row) { return Eigen::Map<Vec6>(corrections.data() + row * 6); };
  const auto owed = [&](std::size_t row) { return changes.data() + row * width + 12; };
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const CouplingState& state = coupling_of(bodies, row);
    change(row) = correction(row), foreseen(row) = state.foreseen_change();
    owed(row)[0] = double(state.mass_owed.all), owed(row)[1] = double(state.mass_owed.by_each_link);
  }
  exchange_.share_with_copies(bodies, changes, width);
  for (std::size_t row = bodies.owned; row < bodies.owned + bodies.copies; ++row) {
    CouplingState& state = coupling_of(bodies, row);
    correction(row) = change(row), state.foreseen_change() = foreseen(row);
    state.mass_owed = {std::int64_t(owed(row)[0]), std::int64_t(owed(row)[1])};
  }
}

/// Corrects the links of bodies not finished during the pass for these changes of velocity (6 per row).
template <class T>
void FluidForces<T>::correct(lbm::Block<T>& block, BlockLinks<T>& links, const rigid::BodySet& bodies,
                             std::span<const double> corrections) {
  std::vector<typename BlockLinks<T>::Group> open;
  std::vector<lbm::SurfaceIncrement> increments;
  links.for_bodies([&](std::uint32_t body, std::size_t k) {
    const SurfaceLinks<T>& surface = links.surfaces[k];
    const Eigen::Map<const Vec6> change(corrections.data() + surface.row * 6);
    if (!bodies.is_dynamic(surface.row) || change.isZero(0)) return;
    lbm::SurfaceMotion m;
    set_motion(m, change, surface.reflection);
    increments.push_back({{m.v[0], m.v[1], m.v[2]}, {m.omega[0], m.omega[1], m.omega[2]}, body});
  });
  if (links.at_once.device() != Device::cpu) return links.at_once.correct(block, increments);
  for (std::uint32_t k = 0; k < links.surfaces.size(); ++k) {
    SurfaceLinks<T>& surface = links.surfaces[k];
    if (surface.finished || !bodies.is_dynamic(surface.row)) continue;
    set_motion(surface.motion, Eigen::Map<const Vec6>(corrections.data() + surface.row * 6),
               surface.reflection);
    if (!is_at_rest(surface.motion))
      for (std::uint32_t g = 0; g < surface.links.groups.size(); ++g) open.push_back({k, g});
  }
  lbm::ListedLinks listed;
  links.for_groups(open, 0, open.size(), [&](const auto& surface, const auto& group, const auto& next) {
    lbm::correct_cut_links<T>({block, links.slots, surface.links, group, next, nullptr, &listed, true},
                              surface.motion);
  });
}

template <class T>
const LinkOutcome& FluidForces<T>::finish(lbm::Fluid<T>& fluid, std::span<BlockLinks<T>> links,
                                          rigid::BodySet& bodies) {
  apply_rims(fluid, links);
  gather(links, bodies);
  move(fluid, links, bodies);
  return outcome_;
}

template class FluidForces<float>;
template class FluidForces<double>;

}  // namespace silt::coupler
