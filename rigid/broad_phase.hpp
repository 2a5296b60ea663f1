#pragma once
// Pairs of bodies whose bounding spheres come close: uniform grids, one for each power of two of the radius,
// so that a few large bodies among many small ones cost the small ones nothing. Canonical positions; through
// a periodic side a body meets the images of others (but never its own), through each side separately.
#include <span>
#include <vector>

#include "rigid/body_exchange.hpp"
#include "rigid/body_set.hpp"

namespace silt::rigid {

struct CandidatePair {
  std::size_t row_a, row_b;  // of the lower and the higher id
  Image image;               // of b, relative to the canonical position of a
};

/// How far a body's surface may travel, and from where.
struct Reach {
  double radius;  // of the bounding sphere
  double margin;  // largest gap at which it may take part in a contact
};

/// Fills pairs with every (a, b, image) of which at least one is free and whose bounding spheres are no
/// further apart than both margins; sorted by (id a, id b, image), each once. A wall (HalfSpace among the
/// last rows, given by its outward normal through its position) is near if the sphere's distance to it is
/// within the margin. reach: one a row (unused for walls). wall_normals: one a wall row.
class BroadPhase {
 public:
  void operator()(const BodySet&, const Extent&, std::span<const Reach> reach,
                  std::span<const Vec3> wall_normals, std::vector<CandidatePair>& pairs);

 private:
  struct Level;
  void build_levels(const BodySet&, const Extent&, std::span<const Reach>);
  void search(const BodySet&, const Extent&, std::span<const Reach>, std::size_t row, const Level&,
              bool same_level);
  void search_walls(const BodySet&, std::span<const Reach>, std::span<const Vec3> wall_normals);
  void sort_into(const BodySet&, std::vector<CandidatePair>& pairs);

  struct Entry {
    std::array<std::int32_t, 3> cell;
    std::uint32_t row;
  };
  struct Level {
    std::array<double, 3> width;        // of a cell
    std::array<std::int32_t, 3> cells;  // along periodic axes; 0 along others: unbounded
    std::uint32_t mask = 0;             // buckets - 1
    std::vector<std::uint32_t> first;   // of each bucket in entries, one more at the end
    std::vector<Entry> entries;         // by bucket
    std::vector<std::uint32_t> rows;    // of this size
  };
  std::vector<Level> levels_;  // small bodies first
  std::vector<CandidatePair> found_;
  std::vector<std::uint32_t> order_, rank_, start_;
};

}  // namespace silt::rigid
