// Built once an instruction set. Each loop over the lanes vectorises by itself.
#include "rigid/contact_lanes.hpp"

#include <cmath>

namespace silt::rigid::SILT_ISA {
namespace {

constexpr int most_rounds = 100;         // of Gauss-Seidel within a pair; some ten are usual
constexpr double converged = 1e-14;      // change of an impulse in a round, relative to the largest
constexpr double converged_push = 1e-6;  // the same where only positions are corrected
constexpr double worth_another = 0;      // ... relative to what the pair changes in this sweep

inline double larger(double a, double b) {
  return a > b ? a : b;
}

/// Lanes to be solved; false where there is none.
bool choose(const LaneBodies& bodies, const BodyState* state, bool first, double* active) {
  bool any = false;
  for (int l = 0; l < lane_count; ++l) {
    const bool woken = bodies.again[l] && (state[bodies.a[l]].number != 0 || state[bodies.b[l]].number != 0);
    active[l] = first || woken;
    any = any || first || woken;
  }
  return any;
}

/// Velocities and angular velocities of the lanes' bodies, transposed.
struct Twists {
  alignas(64) Lanes v_a[3], w_a[3], v_b[3], w_b[3];

  Twists(const LaneBodies& bodies, const BodyState* state) {
    for (int l = 0; l < lane_count; ++l) {
      const BodyState &a = state[bodies.a[l]], &b = state[bodies.b[l]];
      for (int d = 0; d < 3; ++d) {
        v_a[d][l] = a.v[d], w_a[d][l] = a.w[d];
        v_b[d][l] = b.v[d], w_b[d][l] = b.w[d];
      }
    }
  }
};

struct CentralChange {
  alignas(64) Lanes impulse[3], torque[3];  // torque per unit of arm: normal x impulse
  alignas(64) Lanes relative;
};

/// FFD.md 5.2 and 5.3 for eight contacts.
void solve_central(CentralGroup& g, const Twists& t, const double* active, CentralChange& out) {
  for (int l = 0; l < lane_count; ++l) {
    const double nx = g.normal[0][l], ny = g.normal[1][l], nz = g.normal[2][l];
    const double arm_a = g.arm_a[l], arm_b = g.arm_b[l];
    const double wx = arm_b * t.w_b[0][l] - arm_a * t.w_a[0][l];
    const double wy = arm_b * t.w_b[1][l] - arm_a * t.w_a[1][l];
    const double wz = arm_b * t.w_b[2][l] - arm_a * t.w_a[2][l];
    const double ux = t.v_b[0][l] - t.v_a[0][l] + (wy * nz - wz * ny);
    const double uy = t.v_b[1][l] - t.v_a[1][l] + (wz * nx - wx * nz);
    const double uz = t.v_b[2][l] - t.v_a[2][l] + (wx * ny - wy * nx);
    const double u_n = ux * nx + uy * ny + uz * nz;
    const double old_n = g.normal_impulse[l];
    const double old_x = g.tangential_impulse[0][l], old_y = g.tangential_impulse[1][l],
                 old_z = g.tangential_impulse[2][l];
    const double p_n = larger(0.0, old_n + (g.target[l] - u_n) * g.inverse_k_n[l]);
    const double k_t = g.inverse_k_t[l];
    const double qx = old_x - k_t * (ux - u_n * nx), qy = old_y - k_t * (uy - u_n * ny),
                 qz = old_z - k_t * (uz - u_n * nz);
    const double square = qx * qx + qy * qy + qz * qz, limit = g.friction[l] * p_n;
    const double slide = limit / std::sqrt(square), shrink = square > limit * limit ? slide : 1.0;
    const double px = shrink * qx, py = shrink * qy, pz = shrink * qz;
    const bool on = active[l] != 0;
    const double d_n = on ? p_n - old_n : 0.0, dx = on ? px - old_x : 0.0, dy = on ? py - old_y : 0.0,
                 dz = on ? pz - old_z : 0.0;
    g.normal_impulse[l] = on ? p_n : old_n;
    g.tangential_impulse[0][l] = on ? px : old_x;
    g.tangential_impulse[1][l] = on ? py : old_y;
    g.tangential_impulse[2][l] = on ? pz : old_z;
    out.impulse[0][l] = d_n * nx + dx, out.impulse[1][l] = d_n * ny + dy, out.impulse[2][l] = d_n * nz + dz;
    out.torque[0][l] = ny * dz - nz * dy, out.torque[1][l] = nz * dx - nx * dz,
    out.torque[2][l] = nx * dy - ny * dx;
    const double change = d_n * d_n + dx * dx + dy * dy + dz * dz;
    const double before = old_n * old_n + old_x * old_x + old_y * old_y + old_z * old_z;
    const double now = p_n * p_n + px * px + py * py + pz * pz;
    const double scale = larger(larger(before, now), g.least_scale[l] * g.least_scale[l]);
    out.relative[l] = change > 0 ? std::sqrt(change / scale) : 0.0;
  }
}

/// A contact of eight pairs, and what its impulses do to their relative motion.
struct Relative {
  alignas(64) Lanes u[3], omega[3];          // of b seen from a, at a's centre
  alignas(64) Lanes impulse[3], angular[3];  // sums, on b about a's centre
  alignas(64) Lanes change, scale;           // squared, largest of the round
  alignas(64) Lanes active;
};

void start(const BlockGroup& g, const Twists& t, Relative& m) {
  for (int l = 0; l < lane_count; ++l) {
    const double dx = g.offset[0][l], dy = g.offset[1][l], dz = g.offset[2][l];
    const double wx = t.w_b[0][l], wy = t.w_b[1][l], wz = t.w_b[2][l];
    m.u[0][l] = t.v_b[0][l] + (wy * dz - wz * dy) - t.v_a[0][l];
    m.u[1][l] = t.v_b[1][l] + (wz * dx - wx * dz) - t.v_a[1][l];
    m.u[2][l] = t.v_b[2][l] + (wx * dy - wy * dx) - t.v_a[2][l];
    for (int d = 0; d < 3; ++d) {
      m.omega[d][l] = t.w_b[d][l] - t.w_a[d][l];
      m.impulse[d][l] = m.angular[d][l] = 0;
    }
    m.scale[l] = 0;
  }
}

void solve_contact(const BlockGroup& g, BlockContact& c, Relative& m) {
  for (int l = 0; l < lane_count; ++l) {
    const double rx = c.r[0][l], ry = c.r[1][l], rz = c.r[2][l];
    const double nx = c.normal[0][l], ny = c.normal[1][l], nz = c.normal[2][l];
    const double ox = m.omega[0][l], oy = m.omega[1][l], oz = m.omega[2][l];
    const double ux = m.u[0][l] + (oy * rz - oz * ry), uy = m.u[1][l] + (oz * rx - ox * rz),
                 uz = m.u[2][l] + (ox * ry - oy * rx);
    const double old_n = c.normal_impulse[l];
    const double old_x = c.tangential_impulse[0][l], old_y = c.tangential_impulse[1][l],
                 old_z = c.tangential_impulse[2][l];
    const double u_n = ux * nx + uy * ny + uz * nz;
    const bool on = m.active[l] != 0;
    const double p_n = larger(0.0, old_n + (c.target[l] - u_n) * c.inverse_k_n[l]);
    const double d_n = on ? p_n - old_n : 0.0;
    const double sx = ux + d_n * c.k_normal[0][l], sy = uy + d_n * c.k_normal[1][l],
                 sz = uz + d_n * c.k_normal[2][l];
    const double s_n = sx * nx + sy * ny + sz * nz, k_t = c.inverse_k_t[l];
    const double qx = old_x - k_t * (sx - s_n * nx), qy = old_y - k_t * (sy - s_n * ny),
                 qz = old_z - k_t * (sz - s_n * nz);
    const double square = qx * qx + qy * qy + qz * qz, limit = c.friction[l] * p_n;
    const double slide = limit / std::sqrt(square), shrink = square > limit * limit ? slide : 1.0;
    const double px = shrink * qx, py = shrink * qy, pz = shrink * qz;
    const double tx = on ? px - old_x : 0.0, ty = on ? py - old_y : 0.0, tz = on ? pz - old_z : 0.0;
    c.normal_impulse[l] = on ? p_n : old_n;
    c.tangential_impulse[0][l] = on ? px : old_x;
    c.tangential_impulse[1][l] = on ? py : old_y;
    c.tangential_impulse[2][l] = on ? pz : old_z;
    const double size = p_n * p_n + px * px + py * py + pz * pz;
    m.change[l] = larger(m.change[l], d_n * d_n + tx * tx + ty * ty + tz * tz);
    m.scale[l] = larger(m.scale[l], on ? size : 0.0);
    // the impulse's moment about a's centre, and about b's
    const double ix = d_n * nx + tx, iy = d_n * ny + ty, iz = d_n * nz + tz;
    const double ax = ry * iz - rz * iy, ay = rz * ix - rx * iz, az = rx * iy - ry * ix;
    const double dx = g.offset[0][l], dy = g.offset[1][l], dz = g.offset[2][l];
    const double bx = ax + (dy * iz - dz * iy), by = ay + (dz * ix - dx * iz), bz = az + (dx * iy - dy * ix);
    const auto &ja = g.inverse_inertia_a, &jb = g.inverse_inertia_b;
    const double tbx = jb[0][l] * bx + jb[3][l] * by + jb[4][l] * bz,
                 tby = jb[3][l] * bx + jb[1][l] * by + jb[5][l] * bz,
                 tbz = jb[4][l] * bx + jb[5][l] * by + jb[2][l] * bz;
    m.omega[0][l] = ox + tbx + (ja[0][l] * ax + ja[3][l] * ay + ja[4][l] * az);
    m.omega[1][l] = oy + tby + (ja[3][l] * ax + ja[1][l] * ay + ja[5][l] * az);
    m.omega[2][l] = oz + tbz + (ja[4][l] * ax + ja[5][l] * ay + ja[2][l] * az);
    const double k = g.inverse_mass[l];
    m.u[0][l] += k * ix + (tby * dz - tbz * dy);
    m.u[1][l] += k * iy + (tbz * dx - tbx * dz);
    m.u[2][l] += k * iz + (tbx * dy - tby * dx);
    m.impulse[0][l] += ix, m.impulse[1][l] += iy, m.impulse[2][l] += iz;
    m.angular[0][l] += ax, m.angular[1][l] += ay, m.angular[2][l] += az;
  }
}

/// Ends the lanes whose impulses have settled; false where none goes on.
bool go_on(const BlockGroup& g, Relative& m, double tolerance) {
  double left = 0;
  for (int l = 0; l < lane_count; ++l) {
    const double arm = g.inverse_arm[l];
    double all = 0, turn = 0;
    for (int d = 0; d < 3; ++d) {
      all += m.impulse[d][l] * m.impulse[d][l];
      turn += m.angular[d][l] * m.angular[d][l];
    }
    const double enough =
        larger(tolerance * tolerance * m.scale[l], worth_another * worth_another * (all + arm * arm * turn));
    m.active[l] = m.change[l] <= enough ? 0.0 : m.active[l];
    left += m.active[l];
  }
  return left > 0;
}

void finish(BlockGroup& g, const Relative& m, const double* solved) {
  for (int l = 0; l < lane_count; ++l) {
    double all = 0, turn = 0;
    for (int d = 0; d < 3; ++d) {
      g.impulse[d][l] = m.impulse[d][l], g.angular[d][l] = m.angular[d][l];
      all += m.impulse[d][l] * m.impulse[d][l];
      turn += m.angular[d][l] * m.angular[d][l];
    }
    const double change = all + g.inverse_arm[l] * g.inverse_arm[l] * turn;
    const double scale = larger(m.scale[l], g.least_scale[l] * g.least_scale[l]);
    const double relative = change > 0 ? std::sqrt(change / scale) : 0.0;
    g.relative_change[l] = solved[l] != 0 ? relative : -1.0;
  }
}

}  // namespace

double sweep_central(CentralGroup* groups, std::size_t count, const BodyState* state, BodySum* sums,
                     double tolerance, bool first) {
  double residual = 0;
  for (std::size_t k = 0; k < count; ++k) {
    CentralGroup& g = groups[k];
    alignas(64) Lanes active;
    if (!choose(g.bodies, state, first, active)) continue;
    CentralChange change;
    solve_central(g, Twists(g.bodies, state), active, change);
    for (int l = 0; l < lane_count; ++l) {
      if (active[l] == 0) continue;
      BodySum &a = sums[g.bodies.a[l]], &b = sums[g.bodies.b[l]];
      for (int d = 0; d < 3; ++d) {
        a.impulse[d] -= change.impulse[d][l];
        a.angular[d] -= g.arm_a[l] * change.torque[d][l];
        b.impulse[d] += change.impulse[d][l];
        b.angular[d] += g.arm_b[l] * change.torque[d][l];
      }
      if (change.relative[l] > tolerance) a.changed = b.changed = 1;
      if (g.bodies.again[l]) residual = larger(residual, change.relative[l]);
    }
  }
  return residual;
}

double sweep_blocks(BlockGroup* groups, std::size_t count, BlockContact* contacts, const BodyState* state,
                    bool first, bool push) {
  double residual = 0;
  for (std::size_t k = 0; k < count; ++k) {
    BlockGroup& g = groups[k];
    Relative m;
    alignas(64) Lanes solved;
    if (!choose(g.bodies, state, first, m.active)) {
      for (int l = 0; l < lane_count; ++l) g.relative_change[l] = -1;
      continue;
    }
    for (int l = 0; l < lane_count; ++l) solved[l] = m.active[l];
    start(g, Twists(g.bodies, state), m);
    for (int round = 0; round < most_rounds; ++round) {
      for (int l = 0; l < lane_count; ++l) {
        m.change[l] = 0;
        m.scale[l] = m.active[l] != 0 ? 0.0 : m.scale[l];  // a lane that has ended keeps its own
      }
      for (std::uint32_t c = 0; c < g.count; ++c) solve_contact(g, contacts[g.first + c], m);
      if (!go_on(g, m, push ? converged_push : converged)) break;
    }
    finish(g, m, solved);
    for (int l = 0; l < lane_count; ++l)
      if (g.bodies.again[l]) residual = larger(residual, g.relative_change[l]);
  }
  return residual;
}

}  // namespace silt::rigid::SILT_ISA
