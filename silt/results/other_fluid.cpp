// The fluid of another run on cells of this one's, which are narrower or wider: density, momentum,
// temperature and the rest of the populations (rate of strain, gradient of the temperature) are interpolated
// between the centres of its cells, to the third order where all 64 cells around are fluid, else linearly
// between those of the eight that are.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lbm/blocks/moments.hpp"
#include "lbm/collision/heat_rates.hpp"
#include "silt/case/case.hpp"
#include "silt/results/checkpoint.hpp"

namespace silt {

using adapters::CheckpointReader;
using lbm::CellBox;
using lbm::Int3;

namespace {

/// The fluid of a cell: density, momentum, temperature, and what of its populations is not equilibrium.
struct CellFluid {
  static constexpr int first_of_heat = lbm::D3Q19::directions, most = first_of_heat + lbm::D3Q7::directions;
  double rho = 0, temperature = 0;
  std::array<double, 3> j{};
  double rest[most] = {};  // of the fluid, then of the temperature

  /// Makes `rest`, which has the populations, what is not equilibrium of them.
  void split() {
    for (int i = 0; i < lbm::D3Q19::directions; ++i) {
      rho += rest[i];
      for (int d = 0; d < 3; ++d) j[d] += lbm::D3Q19::c[i][d] * rest[i];
    }
    for (int i = 0; i < lbm::D3Q7::directions; ++i) temperature += rest[first_of_heat + i];
    for (int q = 0; q < most; ++q) rest[q] -= equilibrium(q, rho, temperature, j);
  }
  void add(double weight, const CellFluid& other) {
    rho += weight * other.rho, temperature += weight * other.temperature;
    for (int d = 0; d < 3; ++d) j[d] += weight * other.j[d];
    for (int q = 0; q < most; ++q) rest[q] += weight * other.rest[q];
  }
  /// Returns a population in the units of this run.
  double population(int q, const FluidScales& scales) const {
    const double shift = scales.heat ? scales.heat->shift : 0;
    const double off = q < first_of_heat ? scales.off_equilibrium : scales.heat->off_equilibrium;
    const std::array<double, 3> scaled{scales.velocity * j[0], scales.velocity * j[1],
                                       scales.velocity * j[2]};
    return equilibrium(q, scales.pressure * rho, temperature + shift, scaled) + off * rest[q];
  }

 private:
  static double equilibrium(int q, double rho, double temperature, const std::array<double, 3>& j) {
    return q < first_of_heat ? lbm::equilibrium(q, rho, j.data())
                             : lbm::heat_equilibrium(q - first_of_heat, temperature, j);
  }
};

/// A cell of the other run; outside the domain none is fluid.
struct OldCell : CellFluid {
  bool is_fluid = false;
};

/// Returns where the centre of a cell is, in cells of the other run from the centre of its first.
double place_of(int cell, double length) {
  return (cell + 0.5) * length - 0.5;
}

/// The other run's cells around a block; those beyond a periodic border are its images.
struct OldCells {
  CellBox box;
  std::vector<OldCell> cells;

  OldCells(const CellBox& block, double length) {
    for (int d = 0; d < 3; ++d) {
      const auto below = [&](int cell) { return int(std::floor(place_of(block.lower[d] + cell, length))); };
      box.lower[d] = below(0) - 1;
      box.size[d] = below(block.size[d] - 1) + 3 - box.lower[d];
    }
    cells.resize(std::size_t(box.cells()));
  }
  OldCell& at(Int3 cell) {
    const Int3 x = cell - box.lower;
    return cells[(std::size_t(x.z) * box.size.y + x.y) * box.size.x + x.x];
  }
  /// Returns the mean of fluid cells with the weights along each axis of cells low, low + 1, low + 2, low
  /// + 3.
  OldCell mean_of(Int3 low, const double (&weights)[3][4], bool of_all) {
    OldCell sum, mean;
    double total = 0;
    for (int k = 0; k < 64; ++k) {
      const Int3 x{k % 4, k / 4 % 4, k / 16};
      const double weight = weights[0][x.x] * weights[1][x.y] * weights[2][x.z];
      const OldCell& cell = at(low + x);
      if (of_all && !cell.is_fluid) return mean;
      if (weight == 0 || !cell.is_fluid) continue;
      sum.add(weight, cell), total += weight;
    }
    mean.is_fluid = total > 0;
    if (mean.is_fluid) mean.add(1 / total, sum);
    return mean;
  }
  /// Returns what is at the centre of a cell of this run; at rest where no cell around is fluid.
  OldCell value_at(Int3 cell, double length) {
    Int3 low;
    double cubic[3][4], linear[3][4] = {};
    for (int d = 0; d < 3; ++d) {
      const double place = place_of(cell[d], length), floor = std::floor(place), t = place - floor;
      low[d] = int(floor) - 1;
      linear[d][1] = 1 - t, linear[d][2] = t;
      cubic[d][0] = -t * (t - 1) * (t - 2) / 6, cubic[d][1] = (t + 1) * (t - 1) * (t - 2) / 2;
      cubic[d][2] = -(t + 1) * t * (t - 2) / 2, cubic[d][3] = (t + 1) * t * (t - 1) / 6;
    }
    const OldCell smooth = mean_of(low, cubic, true);
    return smooth.is_fluid ? smooth : mean_of(low, linear, false);
  }
};

/// A part of the other run's lattice around a block: where it is in the file, and in the box around the
/// block.
struct Part {
  std::size_t block;
  CellBox in_file;
  Int3 lower;
};

std::vector<Part> parts_of(const std::vector<OldCells>& around, const Case& setup,
                           const std::array<int, 3>& n) {
  std::vector<Part> parts;
  for (std::size_t b = 0; b < around.size(); ++b)
    lbm::for_cells({-1, -1, -1}, {2, 2, 2}, [&](Int3 image) {
      CellBox domain;
      for (int d = 0; d < 3; ++d) {
        if (image[d] != 0 && !setup.periodic(d)) return;
        domain.lower[d] = image[d] * n[d], domain.size[d] = n[d];
      }
      const CellBox part = overlap(around[b].box, domain);
      if (part.cells() > 0) parts.push_back({b, {part.lower - domain.lower, part.size}, part.lower});
    });
  return parts;
}

/// Calls take(q, cell of the other run, number) for the numbers of a dataset that lie around the blocks.
template <class T, class Take>
void read_numbers(const CheckpointReader& reader, const char* name, adapters::Storage storage,
                  const std::vector<Part>& parts, std::vector<OldCells>& around, Take&& take) {
  std::vector<CellBox> boxes;
  for (const Part& part : parts) boxes.push_back(part.in_file);
  reader.cells(name, storage, boxes, [&](int q, std::size_t k, const void* in) {
    const T* next = static_cast<const T*>(in);
    lbm::for_cells(parts[k].lower, parts[k].lower + parts[k].in_file.size,
                   [&](Int3 x) { take(q, around[parts[k].block].at(x), *next++); });
  });
}

template <class T>
void read_old_populations(const CheckpointReader& reader, adapters::Storage storage,
                          const std::vector<Part>& parts, std::vector<OldCells>& around) {
  read_numbers<T>(reader, "populations", storage, parts, around, [&](int q, OldCell& cell, T g) {
    if (!std::isfinite(g))
      reader.refuse(fmt::format("/cells/populations, population {} of a cell: it is {}", q, g));
    cell.rest[q] = g, cell.is_fluid = true;
  });
}

}  // namespace

void rescale_populations(coupler::FluidFields& fields, const FluidScales& scales) {
  for (int b = 0; b < fields.blocks(); ++b)
    change_populations(fields, b, scales.populations(), [&](Int3, std::vector<double>& g) {
      CellFluid cell;
      std::ranges::copy(g, cell.rest);
      cell.split();
      for (std::size_t q = 0; q < g.size(); ++q) g[q] = cell.population(int(q), scales);
    });
}

void interpolate_populations(const CheckpointReader& reader, const Case& setup, coupler::FluidFields& fields,
                             const FluidScales& scales) {
  std::vector<OldCells> around;
  for (int b = 0; b < fields.blocks(); ++b) around.emplace_back(fields.block(b), scales.length);
  const std::vector<Part> parts = parts_of(around, setup, reader.lattice("populations"));
  if (reader.is_stored_as("populations", adapters::Storage::double_))
    read_old_populations<double>(reader, adapters::Storage::double_, parts, around);
  else
    read_old_populations<float>(reader, adapters::Storage::single, parts, around);
  if (reader.has_cells("solid"))
    read_numbers<std::uint8_t>(reader, "solid", adapters::Storage::byte, parts, around,
                               [](int, OldCell& cell, std::uint8_t solid) { cell.is_fluid &= solid == 0; });
  for (int b = 0; b < fields.blocks(); ++b) {
    std::ranges::for_each(around[b].cells, &OldCell::split);
    change_populations(fields, b, scales.populations(), [&](Int3 cell, std::vector<double>& g) {
      const OldCell old = around[b].value_at(cell, scales.length);
      for (std::size_t q = 0; q < g.size(); ++q) g[q] = old.population(int(q), scales);
    });
  }
}

}  // namespace silt
