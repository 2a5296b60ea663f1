#include "coupler/forces/fluid_forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "coupler/forces/cell_sums.hpp"
#include "coupler/forces/heavy_body.hpp"
#include "lbm/prefetch.hpp"
#include "rigid/response/warm_start.hpp"

namespace silt::coupler {

using rigid::Vec3;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

namespace {

/// The explicit step is stable up to an eigenvalue of 0.40 sqrt(tau - 1/2), within a fifth; at half of that
/// it is as accurate as the implicit one (scripts/accuracy/coupling_in_time.md).
constexpr double share_of_stable = 0.20;

double from_link_quanta(std::int64_t q) {
  return double(q) * lbm::link_quantum;
}

Vec6 force_of(const std::int64_t* row) {
  Vec6 f;
  for (int d = 0; d < 6; ++d) f[d] = from_link_quanta(row[d]);
  return f;
}

Mat6 stiffness_of(const std::int64_t* row, double quantum, int exponent) {
  const double quanta[3] = {quantum, std::ldexp(quantum, exponent), std::ldexp(quantum, 2 * exponent)};
  Mat6 h;
  int e = force_width;
  for (int r = 0; r < 6; ++r)
    for (int c = r; c < 6; ++c, ++e) h(r, c) = h(c, r) = double(row[e]) * quanta[(r >= 3) + (c >= 3)];
  return h;
}

Mat6 mass_matrix(const rigid::BodySet& bodies, std::size_t row) {
  Mat6 m = Mat6::Zero();
  m.topLeftCorner<3, 3>() = bodies.mass[row] * rigid::Mat3::Identity();
  rigid::Mat3 inertia = bodies.inertia_B[row];
  if (!bodies.is_isotropic(row)) {
    const rigid::Mat3 r = bodies.orientation[row].toRotationMatrix();
    inertia = r * inertia * r.transpose();
  }
  m.bottomRightCorner<3, 3>() = inertia;
  return m;
}

/// What contacts without a film will hold of a load: last step's, as far as they oppose it. A body that rests
/// stays where it is, so its surface must not return as if it were falling; one that was struck is not struck
/// again.
Vec3 held_by_contacts(const rigid::BodySet& bodies, std::size_t row, int substeps, const Vec3& load) {
  Vec3 contacts = Vec3::Zero();  // impulses of a sub-step
  for (const auto& s : bodies.stored_impulses[row])
    if (!(s.feature & rigid::film_feature))
      contacts += s.partner < bodies.id[row] ? s.impulse : Vec3(-s.impulse);
  const double opposing = -contacts.dot(load), square = contacts.squaredNorm();
  if (!(opposing > 0)) return Vec3::Zero();
  return std::min(opposing / square, double(substeps)) * contacts;
}

void set_motion(lbm::SurfaceMotion& m, const Vec3& v, const Vec3& w) {
  for (int d = 0; d < 3; ++d) m.v[d] = v[d], m.omega[d] = w[d];
}

bool is_at_rest(const lbm::SurfaceMotion& m) {
  return Vec3(m.v[0], m.v[1], m.v[2]).isZero(0) && Vec3(m.omega[0], m.omega[1], m.omega[2]).isZero(0);
}

template <class T>
void add_sums(std::int64_t* row, const SurfaceLinks<T>& surface, bool stiffness = true) {
  const lbm::LinkSums& sums = surface.sums;
  for (int d = 0; d < 3; ++d) row[d] += sums.force[d], row[3 + d] += sums.torque[d];
  if (stiffness)
    for (int e = 0; e < stiffness_width; ++e) row[force_width + e] += surface.stiffness.h[e];
}

/// Solves (M + H) delta = F + F_ext, gives the body the force of the links at that change, and returns it. A
/// heavy body takes the force as it is: 0.
template <class T>
Vec6 take_velocity_change(rigid::BodySet& bodies, const rigid::World& world, std::size_t row,
                          const std::int64_t* sums, const Vec3& gravity, int substeps, double heavy) {
  const int exponent = lbm::stiffness_exponent(world.bounding_radii[bodies.shape[row]]);
  const Mat6 h = stiffness_of(sums, lbm::stiffness_quantum<T>, exponent);
  const Vec6 f = force_of(sums);
  if (is_heavy(h, bodies.mass[row], bodies.inertia_B[row], heavy)) {
    bodies.add_force(row, f.head<3>()), bodies.add_torque(row, f.tail<3>());
    return Vec6::Zero();
  }
  const Mat6 m = mass_matrix(bodies, row);
  Vec6 external;
  external << bodies.force[row].value() + bodies.mass[row] * bodies.weight_factor[row] * gravity,
      bodies.torque[row].value();
  external.head<3>() += substeps * rigid::impulse_of_films(bodies, row);
  Vec6 load = f + external;
  load.head<3>() += held_by_contacts(bodies, row, substeps, load.head<3>());
  const Vec6 delta = (m + h).llt().solve(load);
  const Vec6 applied = f - h * delta;
  bodies.add_force(row, applied.head<3>()), bodies.add_torque(row, applied.tail<3>());
  return delta;
}

void add_cells(const CellSums& cells, std::int64_t* to) {
  to[0] += cells.count;
  for (int d = 0; d < 3; ++d) to[1 + d] += cells.coordinates[d];
}

/// Momentum and angular momentum about the centre of mass, in link quanta, that the body's cells have beyond
/// its volume if they move with it. `cells`: as in add_cells.
std::array<std::int64_t, 6> momentum_of_excess(const rigid::BodySet& bodies, std::size_t row,
                                               const std::int64_t* cells) {
  const double count = double(cells[0]), displaced = bodies.mass[row] * (1 - bodies.weight_factor[row]);
  const Vec3 moment = Vec3(double(cells[1]), double(cells[2]), double(cells[3])) +
                      count * (Vec3::Constant(0.5) - bodies.mapping_pose[row].position);
  const Vec3 &v = bodies.velocity[row], &w = bodies.angular_velocity[row];
  const Vec3 momentum = (count - displaced) * v + w.cross(moment), angular = moment.cross(v);
  std::array<std::int64_t, 6> quanta;
  for (int d = 0; d < 3; ++d) {
    quanta[d] = std::llrint(momentum[d] / lbm::link_quantum);
    quanta[3 + d] = std::llrint(angular[d] / lbm::link_quantum);
  }
  return quanta;
}

/// On every rank alike: throws if some body's sums left the range of the fixed point, or are not numbers.
void require_in_range(MPI_Comm comm, rigid::BodyId bad) {
  std::uint64_t mine = bad, first = 0;
  MPI_Allreduce(&mine, &first, 1, MPI_UINT64_T, MPI_MIN, comm);
  if (first != std::numeric_limits<std::uint64_t>::max())
    throw std::overflow_error(
        "the force on body " + std::to_string(first) +
        " is not a number or above 64 lattice units on one link; the flow around it has become "
        "unstable: choose a smaller units.time_step (lower velocities) or a larger relaxation time");
}

}  // namespace

Vec3 owed_impulse(const rigid::BodySet& bodies, std::size_t row) {
  const auto& owed = bodies.owed[row];
  return {from_link_quanta(owed[0]), from_link_quanta(owed[1]), from_link_quanta(owed[2])};
}

template <class T>
FluidForces<T>::FluidForces(const CouplingSpec& spec, const BodyExchange& exchange, int substeps)
    : spec_(spec),
      exchange_(exchange),
      cells_begin_(force_width + (spec.time == TimeCoupling::implicit_ ? stiffness_width : 0)),
      width_(cells_begin_ + (spec.force == ForceForm::exact ? cells_width : 0)),
      substeps_(substeps) {}

template <class T>
void FluidForces<T>::hand_over(rigid::BodyId id, const Vec3& momentum, const Vec3& arm) {
  const Vec3 torque = arm.cross(momentum);
  HandedOver h{id, {}};
  for (int d = 0; d < 3; ++d) {
    h.impulse[d] = std::llrint(momentum[d] / lbm::link_quantum);
    h.impulse[3 + d] = std::llrint(torque[d] / lbm::link_quantum);
  }
  handed_over_.push_back(h);
}

template <class T>
void FluidForces<T>::begin(const lbm::Fluid<T>& fluid, std::span<const BlockMap> maps,
                           std::span<BlockLinks<T>> links, rigid::BodySet& bodies) {
  bodies_ = &bodies;
  heavy_ = share_of_stable * std::sqrt(fluid.spec().relaxation_time - 0.5);
  rows_.assign(bodies.size() * width_, 0);
  for (const auto& h : handed_over_)
    if (const std::size_t row = bodies.row_of(h.id); row < bodies.size())
      for (int d = 0; d < 6; ++d) rows_[row * width_ + d] += h.impulse[d];
  handed_over_.clear();
  for (std::size_t b = 0; b < maps.size(); ++b) {
    const auto& masks = maps[b].masks;
    links[b].slots = lbm::link_slots(fluid.blocks()[b], lbm::flipped(fluid.parity()));
    if (spec_.force == ForceForm::exact)
      for (const BodyMask& mask : masks)
        add_cells(cells_of(maps[b].box, mask), rows_.data() + mask.row * width_ + cells_begin_);
    for (std::size_t k = 0; k < masks.size(); ++k) {
      SurfaceLinks<T>& surface = links[b].surfaces[k];
      surface.row = masks[k].row, surface.sums = {}, surface.finished = false;
      surface.left = std::uint32_t(surface.links.groups.size());
      set_motion(surface.motion, bodies.velocity[surface.row], bodies.angular_velocity[surface.row]);
    }
    links[b].gaps.set_velocities(links[b].surfaces);
  }
}

template <class T>
void FluidForces<T>::apply(lbm::Block<T>& block, const lbm::LinkSlots& slots, SurfaceLinks<T>& surface,
                           const lbm::LinkGroup& group, const lbm::NextGroup<T>& next) const {
  lbm::apply_cut_links<T>({block, slots, surface.links, group, next}, surface.motion, spec_.force,
                          surface.sums);
}

template <class T>
void FluidForces<T>::after_part(lbm::Block<T>& block, BlockLinks<T>& links, int part, const Vec3& gravity) {
  const auto& inner = links.inner;
  const std::uint32_t end = links.first_inner[part + 1];
  for (std::uint32_t k = links.first_inner[part]; k < end; ++k) {
    links.prefetch(inner, k);
    SurfaceLinks<T>& surface = links.surfaces[inner[k].surface];
    apply(block, links.slots, surface, surface.links.groups[inner[k].number],
          links.next_group(inner, k, end));
    if (spec_.time != TimeCoupling::implicit_) continue;
    if (k + 2 < end) prefetch_row(links.surfaces[inner[k + 2].surface]);
    if (--surface.left == 0 && surface.links.frame.whole) finish_body(block, links.slots, surface, gravity);
  }
}

/// A hint that the body may be finished soon.
template <class T>
void FluidForces<T>::prefetch_row(const SurfaceLinks<T>& surface) const {
  if (surface.left != 1) return;
  const std::int64_t* const row = rows_.data() + surface.row * width_;
  for (int n = 0; n < width_; n += 8) lbm::prefetch_to_write(row + n);
  lbm::prefetch_to_write(&bodies_->force[surface.row]), lbm::prefetch_to_write(&bodies_->torque[surface.row]);
  lbm::prefetch_to_read(&bodies_->inertia_B[surface.row]);
  lbm::prefetch_to_read(&bodies_->stored_impulses[surface.row]);
}

/// Nobody else has links on this body: what solve_implicit would do for it later.
template <class T>
void FluidForces<T>::finish_body(lbm::Block<T>& block, const lbm::LinkSlots& slots, SurfaceLinks<T>& surface,
                                 const Vec3& gravity) {
  const std::size_t row = surface.row;
  if (row >= bodies_->owned || !bodies_->is_free(row) || surface.sums.invalid) return;
  std::int64_t* const sums = rows_.data() + row * width_;
  add_sums(sums, surface);
  settle_owed(*bodies_, row);
  surface.finished = true;
  const Vec6 d = take_velocity_change<T>(*bodies_, exchange_.world(), row, sums, gravity, substeps_, heavy_);
  if (d.isZero(0)) return;
  lbm::SurfaceMotion increment;
  set_motion(increment, d.template head<3>(), d.template tail<3>());
  for (const lbm::LinkGroup& group : surface.links.groups)  // still in cache
    lbm::correct_cut_links<T>({block, slots, surface.links, group}, increment, surface.sums);
}

template <class T>
std::int64_t FluidForces<T>::apply_rims(lbm::Fluid<T>& fluid, std::span<BlockLinks<T>> links) {
  std::int64_t mass = 0;
  rigid::BodyId bad = std::numeric_limits<rigid::BodyId>::max();
  for (std::size_t b = 0; b < links.size(); ++b) {
    const auto& rim = links[b].rim;
    for (std::size_t k = 0; k < rim.size(); ++k) {
      links[b].prefetch(rim, k);
      SurfaceLinks<T>& surface = links[b].surfaces[rim[k].surface];
      apply(fluid.blocks()[b], links[b].slots, surface, surface.links.groups[rim[k].number],
            links[b].next_group(rim, k, rim.size()));
    }
    for (const SurfaceLinks<T>& surface : links[b].surfaces) {
      mass += surface.sums.mass;
      if (surface.sums.invalid) bad = std::min(bad, bodies_->id[surface.row]);
    }
  }
  require_in_range(exchange_.comm(), bad);
  return mass;
}

/// Sums of all blocks, to what was handed over, a row each, at the owners.
template <class T>
void FluidForces<T>::gather(std::span<const BlockLinks<T>> links, const rigid::BodySet& bodies) {
  for (const BlockLinks<T>& block : links)
    for (const SurfaceLinks<T>& surface : block.surfaces)
      if (!surface.finished)
        add_sums(rows_.data() + surface.row * width_, surface, spec_.time == TimeCoupling::implicit_);
  wall_loads_.resize(bodies.walls);
  for (std::size_t w = 0; w < bodies.walls; ++w)
    std::copy_n(rows_.data() + (bodies.first_wall() + w) * width_, force_width, wall_loads_[w].begin());
  exchange_.sum_to_owners(bodies, rows_, width_);
}

/// What a body was owed at the last step and is owed no more goes to its row.
template <class T>
void FluidForces<T>::settle_owed(rigid::BodySet& bodies, std::size_t row) {
  if (spec_.force != ForceForm::exact) return;
  std::int64_t* const force = rows_.data() + row * width_;
  const auto now = momentum_of_excess(bodies, row, force + cells_begin_);
  for (int d = 0; d < force_width; ++d) force[d] += bodies.owed[row][d] - now[d];
  bodies.owed[row] = now;
}

template <class T>
void FluidForces<T>::start(std::span<const BlockMap> maps, rigid::BodySet& bodies) {
  if (spec_.force != ForceForm::exact) return;
  std::vector<std::int64_t> rows(bodies.size() * cells_width, 0);
  for (const BlockMap& map : maps)
    for (const BodyMask& mask : map.masks)
      add_cells(cells_of(map.box, mask), rows.data() + mask.row * cells_width);
  exchange_.sum_to_owners(bodies, rows, cells_width);
  for (std::size_t row = 0; row < bodies.owned; ++row)
    bodies.owed[row] = momentum_of_excess(bodies, row, rows.data() + row * cells_width);
}

template <class T>
void FluidForces<T>::add_explicit(rigid::BodySet& bodies) {
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    settle_owed(bodies, row);
    const Vec6 f = force_of(rows_.data() + row * width_);
    bodies.add_force(row, f.template head<3>()), bodies.add_torque(row, f.template tail<3>());
  }
}

template <class T>
std::int64_t FluidForces<T>::solve_implicit(lbm::Fluid<T>& fluid, std::span<BlockLinks<T>> links,
                                            rigid::BodySet& bodies, const Vec3& gravity) {
  std::vector<std::uint8_t> finished(bodies.size(), 0);
  for (const BlockLinks<T>& block : links)
    for (const SurfaceLinks<T>& surface : block.surfaces)
      if (surface.finished) finished[surface.row] = 1;
  std::vector<double> delta(bodies.size() * 6, 0.0);
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (finished[row]) continue;
    settle_owed(bodies, row);
    const std::int64_t* const sums = rows_.data() + row * width_;
    if (bodies.is_free(row)) {
      Eigen::Map<Vec6>(delta.data() + row * 6) =
          take_velocity_change<T>(bodies, exchange_.world(), row, sums, gravity, substeps_, heavy_);
    } else {
      const Vec6 f = force_of(sums);
      bodies.add_force(row, f.template head<3>()), bodies.add_torque(row, f.template tail<3>());
    }
  }
  exchange_.share_with_copies(bodies, delta, 6);
  std::int64_t mass = 0;
  for (std::size_t b = 0; b < links.size(); ++b)
    mass += correct_open(fluid.blocks()[b], links[b], bodies, delta);
  return mass;
}

/// The bodies that were not finished during the pass return as if they had moved faster by delta (6 a row).
template <class T>
std::int64_t FluidForces<T>::correct_open(lbm::Block<T>& block, BlockLinks<T>& links,
                                          const rigid::BodySet& bodies, std::span<const double> delta) {
  std::vector<typename BlockLinks<T>::Group> open;
  for (std::uint32_t k = 0; k < links.surfaces.size(); ++k) {
    SurfaceLinks<T>& surface = links.surfaces[k];
    if (surface.finished || !bodies.is_free(surface.row)) continue;
    const double* const d = delta.data() + surface.row * 6;
    set_motion(surface.motion, Vec3(d[0], d[1], d[2]), Vec3(d[3], d[4], d[5]));
    if (is_at_rest(surface.motion)) continue;
    for (std::uint32_t g = 0; g < surface.links.groups.size(); ++g) open.push_back({k, g});
  }
  std::int64_t mass = 0;
  for (std::size_t n = 0; n < open.size(); ++n) {
    links.prefetch(open, n);
    SurfaceLinks<T>& surface = links.surfaces[open[n].surface];
    lbm::LinkSums sums;
    const lbm::LinkGroup& group = surface.links.groups[open[n].number];
    lbm::correct_cut_links<T>(
        {block, links.slots, surface.links, group, links.next_group(open, n, open.size())}, surface.motion,
        sums);
    mass += sums.mass;
  }
  return mass;
}

template <class T>
std::int64_t FluidForces<T>::operator()(lbm::Fluid<T>& fluid, std::span<BlockLinks<T>> links,
                                        rigid::BodySet& bodies, const Vec3& gravity) {
  std::int64_t mass = apply_rims(fluid, links);
  gather(links, bodies);
  if (spec_.time == TimeCoupling::implicit_)
    mass += solve_implicit(fluid, links, bodies, gravity);
  else
    add_explicit(bodies);
  return mass;
}

template class FluidForces<float>;
template class FluidForces<double>;

}  // namespace silt::coupler
