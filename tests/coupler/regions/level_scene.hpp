#pragma once
// Bodies and walls of a case with [coarsening], as a rank that has all of them or its own holds them.
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/regions/level_views.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_file.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::coupler::testing {

struct LevelScene {
  Case setup;
  rigid::World world;
  rigid::BodySet bodies;  // all of them

  explicit LevelScene(const std::string& text) : setup(read_case_text(text)) {
    world.shapes = setup.shapes;
    for (const rigid::Shape& s : setup.shapes) world.bounding_radii.push_back(rigid::bounding_radius(s));
    for (const BodySpec& body : setup.bodies) {
      rigid::BodyRecord r;
      r.id = bodies.owned + 1;
      r.shape = body.shape;
      Eigen::Map<rigid::Vec3>{r.position} = body.pose.position;
      const rigid::Quat& q = body.pose.orientation;
      r.orientation[0] = q.w(), r.orientation[1] = q.x(), r.orientation[2] = q.y(), r.orientation[3] = q.z();
      bodies.add(r);
    }
    bodies.reindex();
    for (std::size_t row = 0; row < bodies.owned; ++row) set_mapping_pose(bodies, row, bodies.pose(row));
    for (const CurvedWall& wall : setup.walls)
      std::visit([&](const auto& surface) { rigid::add_wall(bodies, world, surface); }, wall.surface);
  }

  lbm::CutTree parts(int ranks) const { return cut_for_levels(setup, ranks); }
  /// Returns the bodies that a rank of these parts has.
  rigid::BodySet held_by(int rank, const lbm::CutTree& parts) const {
    rigid::BodySet held = bodies;
    for (std::size_t row = bodies.owned; row-- > 0;) {
      lbm::Int3 cell;
      for (int d = 0; d < 3; ++d) cell[d] = std::clamp(int(bodies.position[row][d]), 0, setup.cells[d] - 1);
      if (parts.leaf_at(cell).index == rank) continue;
      held.erase(row);
      --held.owned;
    }
    held.reindex();
    return held;
  }
  /// The levels of all cells, as one rank alone finds them.
  lbm::CutTree levels() const {
    return LevelViews(setup, entrances_of(setup), parts(1), world, MPI_COMM_SELF).view(bodies);
  }
};

inline int level_at(const lbm::CutTree& view, lbm::Int3 cell) {
  return view.kinds()[view.leaf_at(cell).index].level;
}

/// Spheres, a box that is turned and one across a corner, in a domain that is no whole number of tiles along
/// x.
inline std::string many_bodies(int levels, const std::string& boundary) {
  CaseText c;
  c.domain = domain_of({84, 96, 80}, boundary);
  c.rest = "[coarsening]\nlevels = " + std::to_string(levels) + "\ndistance = 6\n";
  c.shapes = sphere_of("ball", 6) + shape_of("brick", "box", "edges = [12, 4, 4]");
  c.bodies = body_of("ball", 1, "positions = [[1, 1, 1], [40, 50, 30], [52, 53, 35], [83.5, 20, 79]]") +
             body_of("brick", 1, "position = [20, 80, 60]\norientation = { axis = [1, 1, 0], degrees = 50 }");
  return c.text();
}

}  // namespace silt::coupler::testing
