#pragma once
// The populations of the fluid in a checkpoint. Cells of one level are a field, [q][z][y][x]. Of several,
// each level has a list of its cells, [q][cell], and /cells/levels says where they lie: the level of each
// tile of the domain, a cube of finest cells within which all cells are of one level. The lists go through
// the tiles in the order z, y, x, and so through the cells of each: no cut of the domain has a say in the
// file.
#include "adapters/hdf5/checkpoint_file.hpp"
#include "coupler/flow.hpp"
#include "lbm/level_cut.hpp"

namespace silt::coupler {

void write_populations(adapters::CheckpointWriter&, const Case&, const Flow&);

/// Reads them into a flow whose cells are of the levels that the file says (saved_levels).
void read_populations(const adapters::CheckpointReader&, const Case&, Flow&);

/// Refuses a file that is of another lattice than the case's, or has other levels.
void require_populations(const adapters::CheckpointReader&, const Case&);

/// Collective. Returns the levels of the cells in a box of finest ones, whose faces are faces of cells of the
/// widest level: as boxes that do not overlap. `coarsest`: that of the case.
std::vector<lbm::LevelBox> saved_levels(const adapters::CheckpointReader&, int coarsest, const lbm::CellBox&);

}  // namespace silt::coupler
