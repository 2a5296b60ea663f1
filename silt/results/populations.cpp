// The populations of the fluid in a checkpoint. Cells of one level are a field, [q][z][y][x]. Of several,
// each level has a list of its cells, [q][cell], and /cells/levels says where they lie: the level of each
// tile of the domain, a cube of finest cells within which all cells are of one level. The lists go through
// the tiles, and the cells of each, in the order z, y, x, whatever the cut of the domain. /cells/solid says
// of cells of one level which are solid, for a run that begins from here on cells of another width.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "silt/case/case.hpp"
#include "silt/results/checkpoint.hpp"
#include "silt/results/flow_fields.hpp"
#include "silt/results/lattice_of_levels.hpp"

namespace silt {

using adapters::CheckpointReader;
using adapters::CheckpointWriter;
using adapters::Storage;
using lbm::Int3;

namespace {

/// Returns the largest population of a valid state: of the fluid in masses of a cell at reference density.
double largest_population(int q) {
  return q < lbm::D3Q19::directions ? 1024 : std::numeric_limits<float>::max();
}

Storage storage_of(const Case& setup) {
  return setup.fluid->precision == coupler::Precision::double_ ? Storage::double_ : Storage::single;
}

/// Calls visit(local cells, offset among the block's cells) for the planes of a block.
template <class Visit>
void for_planes(const lbm::CellBox& block, Visit&& visit) {
  lbm::CellBox plane{{}, {block.size.x, block.size.y, 1}};
  for (; plane.lower.z < block.size.z; ++plane.lower.z) visit(plane, plane.lower.z * plane.cells());
}

/// Copies population q of a block to places at(cell of the block, x fastest).
template <class T, class At>
void take(const coupler::FluidFields& fields, int b, int q, T* out, At&& at) {
  std::vector<double> g;
  for_planes(fields.block(b), [&](const lbm::CellBox& plane, std::int64_t first) {
    g.resize(std::size_t(plane.cells()));
    fields.read(b, plane, q, g.data());
    for (std::size_t n = 0; n < g.size(); ++n) out[at(first + n)] = T(g[n]);
  });
}

/// Sets population q of a block from places at(cell of the block, x fastest), if its cells have one.
template <class T, class At>
void give(const CheckpointReader& reader, coupler::FluidFields& fields, int b, int q, const T* in, At&& at) {
  if (q >= fields.populations()) return;
  std::vector<double> g;
  const lbm::CellBox& block = fields.block(b);
  for_planes(block, [&](const lbm::CellBox& plane, std::int64_t first) {
    g.resize(std::size_t(plane.cells()));
    for (std::size_t n = 0; n < g.size(); ++n) {
      g[n] = in[at(first + n)];
      if (std::abs(g[n]) <= largest_population(q)) continue;
      const auto [x, y, z] =
          fields.finest(block.lower + plane.lower + Int3{int(n) % block.size.x, int(n) / block.size.x, 0});
      reader.refuse(fmt::format("/cells/populations, population {} of the cell [{}, {}, {}]: it is {}", q, x,
                                y, z, in[at(first + n)]));
    }
    fields.write(b, plane, q, g.data());
  });
}

std::size_t same(std::size_t cell) {
  return cell;
}

// ---- several levels ----

/// The tiles of the domain, and the levels of the tiles in a box.
struct Tiles {
  int edge;  // finest cells; faces between levels and ranks are faces of tiles
  std::array<int, 3> lattice;
  lbm::CellBox box;
  std::vector<std::uint8_t> levels;

  /// Calls visit(tile, its index in the box) in the order of the lists.
  template <class Visit>
  void for_each(Visit&& visit) const {
    std::size_t i = 0;
    coupler::for_cells(box.lower, box.lower + box.size, [&](Int3 tile) { visit(tile, i++); });
  }
};

int edge_of_tiles(int coarsest) {
  return std::min(4, 1 << coarsest);
}

Tiles tiling_of(const Case& setup) {
  Tiles tiles{edge_of_tiles(setup.coarsening->levels), {}, {}, {}};
  for (int d = 0; d < 3; ++d) tiles.lattice[d] = setup.cells[d] / tiles.edge;
  return tiles;
}

/// Returns the tiles with the levels of this rank's tiles.
Tiles tiling_of(const Case& setup, const coupler::Flow& flow) {
  Tiles tiles = tiling_of(setup);
  tiles.box = in_cells_of(tiles.edge, box_of(flow), 1);
  tiles.levels.resize(tiles.box.cells());
  const lbm::CellBox& all = tiles.box;
  flow.for_levels([&](const coupler::FluidFields& fields) {
    for (const lbm::CellBox& block : boxes_of(fields)) {
      const lbm::CellBox here = in_cells_of(tiles.edge, block, fields.width());
      coupler::for_cells(here.lower, here.lower + here.size, [&](Int3 tile) {
        const Int3 x = tile - all.lower;
        tiles.levels[(std::size_t(x.z) * all.size.y + x.y) * all.size.x + x.x] = std::uint8_t(fields.level());
      });
    }
  });
  return tiles;
}

/// The cells of a level on this rank, in the order of its list.
struct CellList {
  std::vector<std::uint32_t> counts;             // per tile
  std::vector<std::vector<std::size_t>> places;  // per block, of its cells
};

CellList list_of(const Tiles& tiles, const coupler::FluidFields& fields) {
  CellList list;
  list.counts.resize(tiles.levels.size());
  for (int b = 0; b < fields.blocks(); ++b) list.places.emplace_back(fields.block(b).cells());
  std::size_t next = 0;
  int b = 0;
  const int n = std::max(tiles.edge / fields.width(), 1);
  tiles.for_each([&](Int3 tile, std::size_t i) {
    const Int3 corner{tile.x * tiles.edge, tile.y * tiles.edge, tile.z * tiles.edge},
        first = fields.coarse(corner);
    if (tiles.levels[i] != fields.level() || fields.finest(first) != corner) return;
    list.counts[i] = std::uint32_t(n * n * n);
    coupler::for_cells(first, first + Int3{n, n, n}, [&](Int3 cell) {
      if (!fields.block(b).contains(cell)) {
        const lbm::BlockPlace there = fields.domain().block_at(cell);
        b = fields.domain().local_index(there, there.rank);
      }
      const lbm::CellBox& block = fields.block(b);
      const Int3 x = cell - block.lower;
      list.places[b][(std::size_t(x.z) * block.size.y + x.y) * block.size.x + x.x] = next++;
    });
  });
  return list;
}

/// Joins boxes that are adjacent along an axis.
std::vector<lbm::LevelBox> merged(std::vector<lbm::LevelBox> boxes, int axis) {
  const int b = (axis + 1) % 3, c = (axis + 2) % 3;
  const auto across = [=](const lbm::LevelBox& s) {
    return std::tuple(s.level, s.box.lower[b], s.box.size[b], s.box.lower[c], s.box.size[c]);
  };
  std::sort(boxes.begin(), boxes.end(), [&](const lbm::LevelBox& s, const lbm::LevelBox& t) {
    return std::tuple(across(s), s.box.lower[axis]) < std::tuple(across(t), t.box.lower[axis]);
  });
  std::vector<lbm::LevelBox> all;
  for (const lbm::LevelBox& next : boxes) {
    lbm::CellBox* last = all.empty() ? nullptr : &all.back().box;
    if (last && across(all.back()) == across(next) &&
        last->lower[axis] + last->size[axis] == next.box.lower[axis])
      last->size[axis] += next.box.size[axis];
    else
      all.push_back(next);
  }
  return all;
}

std::string list_name(int level) {
  return "populations." + std::to_string(level);
}

template <class T>
void write_cells(CheckpointWriter& writer, const Case& setup, const coupler::Flow& flow) {
  if (flow.levels() == 1)
    return writer.cells(
        "populations", storage_of(setup), setup.cells, flow.fields().populations(), boxes_of(flow.fields()),
        [&](int q, std::size_t b, void* out) { take(flow.fields(), int(b), q, static_cast<T*>(out), same); });
  const Tiles tiles = tiling_of(setup, flow);
  writer.cells("levels", Storage::byte, tiles.lattice, 1, {tiles.box}, [&](int, std::size_t, void* out) {
    std::copy(tiles.levels.begin(), tiles.levels.end(), static_cast<std::uint8_t*>(out));
  });
  flow.for_levels([&](const coupler::FluidFields& fields) {
    const CellList list = list_of(tiles, fields);
    writer.list(list_name(fields.level()), storage_of(setup), {tiles.lattice, tiles.box, list.counts},
                fields.populations(), [&](int q, void* out) {
                  for (int b = 0; b < fields.blocks(); ++b)
                    take(fields, b, q, static_cast<T*>(out),
                         [&](std::size_t n) { return list.places[b][n]; });
                });
  });
}

template <class T>
void read_cells(const CheckpointReader& reader, const Case& setup, coupler::Flow& flow) {
  if (flow.levels() == 1)
    return reader.cells("populations", storage_of(setup), boxes_of(flow.fields()),
                        [&](int q, std::size_t b, const void* in) {
                          give(reader, flow.fields(), int(b), q, static_cast<const T*>(in), same);
                        });
  const Tiles tiles = tiling_of(setup, flow);
  for (int level = 0; level < flow.levels(); ++level) {
    coupler::FluidFields& fields = flow.fields(level);
    const CellList list = list_of(tiles, fields);
    reader.list(list_name(level), storage_of(setup), {tiles.lattice, tiles.box, list.counts},
                fields.populations(), [&](int q, const void* in) {
                  for (int b = 0; b < fields.blocks(); ++b)
                    give(reader, fields, b, q, static_cast<const T*>(in),
                         [&](std::size_t n) { return list.places[b][n]; });
                });
  }
}

}  // namespace

void write_populations(CheckpointWriter& writer, const Case& setup, const coupler::Flow& flow) {
  storage_of(setup) == Storage::double_ ? write_cells<double>(writer, setup, flow)
                                        : write_cells<float>(writer, setup, flow);
  if (flow.levels() > 1 || !setup.has_surfaces()) return;
  const coupler::FluidFields& fields = flow.fields();
  writer.cells("solid", Storage::byte, setup.cells, 1, boxes_of(fields), [&](int, std::size_t b, void* out) {
    auto* next = static_cast<std::uint8_t*>(out);
    coupler::for_cells({}, fields.block(int(b)).size, [&](Int3 x) { *next++ = !fields.is_fluid(int(b), x); });
  });
}

void read_populations(const CheckpointReader& reader, const Case& setup, coupler::Flow& flow) {
  storage_of(setup) == Storage::double_ ? read_cells<double>(reader, setup, flow)
                                        : read_cells<float>(reader, setup, flow);
}

static int components_of(const CheckpointReader& reader) {
  return reader.components(reader.has_cells("levels") ? list_name(0) : "populations");
}

bool has_temperature(const CheckpointReader& reader) {
  return components_of(reader) == lbm::D3Q19::directions + lbm::D3Q7::directions;
}

std::string fault_of_populations(const CheckpointReader& reader, const Case& setup) {
  const bool has_levels = reader.has_cells("levels");
  if (has_levels != setup.coarsening.has_value())
    return fmt::format("its cells are of {}, and those of the case are not",
                       has_levels ? "several levels" : "one level");
  const bool fits = has_levels ? reader.lattice("levels") == tiling_of(setup).lattice
                               : reader.lattice("populations") == setup.cells;
  if (!fits || (!has_temperature(reader) && components_of(reader) != lbm::D3Q19::directions))
    return "its populations are of another lattice than the case's";
  const Storage storage = storage_of(setup);
  if (reader.is_stored_as(has_levels ? list_name(0) : "populations", storage)) return "";
  return storage == Storage::double_ ? "its fluid is of single precision, that of the case of double"
                                     : "its fluid is of double precision, that of the case of single";
}

std::vector<lbm::LevelBox> saved_levels(const CheckpointReader& reader, int coarsest,
                                        const lbm::CellBox& box) {
  Tiles tiles{edge_of_tiles(coarsest), {}, {}, {}};
  tiles.box = in_cells_of(tiles.edge, box, 1);
  std::vector<lbm::LevelBox> found;
  reader.cells("levels", Storage::byte, {tiles.box}, [&](int, std::size_t, const void* in) {
    const auto* level = static_cast<const std::uint8_t*>(in);
    tiles.for_each([&](Int3 tile, std::size_t i) {
      if (level[i] > coarsest)
        reader.refuse(
            fmt::format("/cells/levels, tile [{}, {}, {}]: it is of level {}, and must be of {} at most",
                        tile.x, tile.y, tile.z, level[i], coarsest));
      const int edge = tiles.edge;
      found.push_back({{{tile.x * edge, tile.y * edge, tile.z * edge}, {edge, edge, edge}}, level[i]});
    });
  });
  for (int axis = 0; axis < 3; ++axis) found = merged(std::move(found), axis);
  return found;
}

}  // namespace silt
