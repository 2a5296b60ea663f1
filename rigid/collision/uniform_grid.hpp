#pragma once
// The default broad phase: uniform grids, one for each power of two of the radius, so that a few large bodies
// among many small ones cost the small ones nothing.
//
// A grid has no cells in memory: its bodies are sorted by the number of their cell. Seen from bodies in that
// order, the row of three cells at a given offset only moves forward through them:
//
//     bodies by cell   0 0 1 3 3 4 7 7 9 ...
//     looking from             ^
//     cell + a row                 ^           one cursor for each row (and each periodic side it crosses)
//
// so memory is read in order, and nothing depends on how much of the domain is empty. Between two sizes small
// bodies look for large ones in the grid of these, or large ones for small ones in theirs: whichever asks for
// fewer rows.
#include "rigid/collision/broad_phase.hpp"

namespace silt::rigid {

class UniformGrid : public BroadPhase {
 public:
  std::string_view name() const override { return "grid"; }

 private:
  using Cell = std::array<std::int32_t, 3>;
  struct Entry {  // a body, with all that the search reads
    std::int64_t key;
    BodyId id;
    Vec3 position;
    double reach;
    std::uint32_t row;
    bool dynamic;
  };
  struct Run {  // of cells along x
    std::int32_t first, last;
    std::int8_t image;
  };
  struct Level {
    std::vector<std::uint32_t> rows;     // of this size
    double largest_reach;                // of them
    std::array<double, 3> width;         // of a cell
    Cell cells;                          // along periodic axes; 0 along others: as far as the bodies reach
    Cell lowest, highest;                // cell of a body of this level
    std::array<std::int64_t, 3> stride;  // of the keys

    Cell cell_of(const Vec3& x) const;
    std::int64_t key_of(const Cell&) const;
    std::int32_t stepped(int axis, std::int32_t cell, std::int8_t& image) const;
    int runs(std::int32_t x, int first_offset, std::array<Run, 3>& out) const;
    Run cells_within(int axis, double x, double distance) const;
    double rows_around(double largest_reach) const;
  };

  void find_pairs(const Surroundings&, std::vector<CandidatePair>& found) override;
  void build_levels(const Surroundings&);
  static void set_cells(Level&, const Surroundings&, double largest_reach);
  void sort_by_cell(const Surroundings&, const Level& of, const Level& grid, std::vector<Entry>& sorted);
  static void search(const Surroundings&, const Level&, const std::vector<Entry>& from,
                     const std::vector<Entry>& in, bool same_level, std::vector<CandidatePair>& found);
  static void search_around(const Surroundings&, const Level& large, const Level& grid,
                            const std::vector<Entry>& in, std::vector<CandidatePair>& found);

  static void add_if_near(const Surroundings&, const Entry& own, const Entry& other, Image,
                          std::vector<CandidatePair>& found);

  std::vector<Level> levels_;                // small bodies first
  std::vector<std::vector<Entry>> entries_;  // by level, in its own grid
  std::vector<Entry> others_, unsorted_;
};

}  // namespace silt::rigid
