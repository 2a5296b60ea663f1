#pragma once
// A fluid of several levels as tests hold it: what is done with cells of all levels alike.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <memory>

#include "lbm/levels/levels.hpp"
#include "parallel/communicator.hpp"
#include "tests/lbm/fluid_cells.hpp"

namespace silt::lbm::testing {

using Vector = std::array<double, 3>;

template <class T>
struct LevelledFlow {
  Fluid<T> finest;
  std::unique_ptr<Temperature<T>> heat;  // null: none
  Levels<T> levels;
  LevelledFlow(const CutTree& tree, const std::array<SideCondition, 6>& sides, const CollisionSpec& spec,
               int coarser, MPI_Comm comm = MPI_COMM_WORLD, Device device = Device::cpu,
               const HeatSpec* warm = nullptr, const std::array<SideCondition, 6>& heat_sides = {})
      : finest(Domain(tree, sides, parallel::ranks_of(comm)), spec, comm, device),
        heat(warm ? std::make_unique<Temperature<T>>(finest, *warm, heat_sides) : nullptr),
        levels(finest, coarser, heat.get()) {}

  void step(int finest_steps) {
    for (int n = 0; n < finest_steps; ++n) {
      levels.begin_step();
      levels.stream_collide();
      finest.exchange();
      levels.end_step();
    }
  }
  /// Calls f(fluid, block, local cell, middle of the cell in finest cells, level).
  template <class F>
  void for_all(F&& f) {
    for (int level = 0; level < levels.count(); ++level) {
      Fluid<T>& fluid = levels.fluid(level);
      for (int b = 0; b < int(fluid.blocks().size()); ++b) {
        const CellBox box = fluid.blocks()[b].box();
        for_cells({}, box.size, [&](Int3 x) {
          Vector middle;
          for (int d = 0; d < 3; ++d) middle[d] = (box.lower[d] + x[d] + 0.5) * (1 << level);
          f(fluid, b, x, middle, level);
        });
      }
    }
  }
  /// Equilibrium and the stress of a flow with these gradients (of u_e along d: [e][d], a finest cell).
  template <class Flow>
  void set(Flow&& flow) {
    for_all([&](Fluid<T>& fluid, int b, Int3 x, const Vector& at, int level) {
      double rho = 0;
      Vector u{};
      std::array<Vector, 3> gradient{};
      flow(at, rho, u, gradient);
      const Vector f = fluid.spec().force;
      for (int i = 0; i < D3Q19::directions; ++i) {
        double stretch = 0, divergence = 0, push = 0;
        for (int d = 0; d < 3; ++d) {
          divergence += gradient[d][d], push += D3Q19::c[i][d] * f[d];
          for (int e = 0; e < 3; ++e) stretch += D3Q19::c[i][d] * D3Q19::c[i][e] * gradient[e][d];
        }
        fluid.arriving(b, x, i) =
            T(equilibrium(i, rho, u.data()) -
              3 * D3Q19::w(i) *
                  (fluid.spec().relaxation_time * (1 << level) * (stretch - divergence / 3) + push / 2));
      }
    });
  }
  struct Sum {
    double mass = 0, momentum[3] = {};
  };
  Sum sum() {
    Sum mine, all;
    for_all([&](Fluid<T>& fluid, int b, Int3 x, const Vector&, int level) {
      const Moments m = fluid.moments(b, x);
      const double volume = 1 << 3 * level;
      mine.mass += volume * m.density_deviation;
      for (int d = 0; d < 3; ++d) mine.momentum[d] += volume * m.momentum[d];
    });
    MPI_Allreduce(&mine, &all, 4, MPI_DOUBLE, MPI_SUM, finest.comm());
    return all;
  }
  std::uint64_t fingerprint() {
    Fingerprint hash;
    for_all([&](Fluid<T>& fluid, int b, Int3 x, const Vector& at, int) {
      for (int i = 0; i < D3Q19::directions; ++i) hash.add(double(fluid.arriving(b, x, i)), at, i);
    });
    return hash.over(finest.comm());
  }
};

}  // namespace silt::lbm::testing
