#pragma once
// The default broad phase: one uniform grid for each power of two of the radius, so that a few large bodies
// do not make the search among many small ones more expensive.
//
// A grid stores no cells: its bodies are sorted by cell number. For bodies visited in that order, the row of
// three cells at a given offset only moves forward:
//
//     bodies by cell   0 0 1 3 3 4 7 7 9 ...
//     current body             ^
//     cell + a row                 ^           one cursor for each row (and each periodic side it crosses)
//
// so memory is read in order, and empty space costs nothing. Between two levels either the small bodies
// search the grid of the large ones or the reverse, whichever needs fewer rows.
#include "rigid/collision/broad_phase.hpp"

namespace silt::rigid {

class UniformGrid : public BroadPhase {
 public:
  std::string_view name() const override { return "grid"; }

 private:
  using Cell = std::array<std::int32_t, 3>;
  struct Entry {  // the data of a body that the search reads
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
    std::vector<std::uint32_t> rows;  // bodies of this size
    double largest_reach;             // of these bodies
    std::array<double, 3> width;      // of a cell
    Cell cells;            // number along periodic axes; 0 along others, where bodies set the range
    Cell lowest, highest;  // extreme cells of the level's bodies
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
