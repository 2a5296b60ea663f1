#pragma once
// The curved walls of a case at the start, as what is to be placed meets them.
#include <vector>

#include "rigid/shapes/bounding_box.hpp"
#include "rigid/shapes/mesh.hpp"
#include "rigid/shapes/tube.hpp"

namespace silt::coupler {

struct Case;

class CurvedWalls {
 public:
  explicit CurvedWalls(const Case&);

  /// Says whether a ball of a radius about a point meets none of them.
  bool are_clear_of(const rigid::Vec3& centre, double radius) const;
  /// Returns the share of a box in which a ball's centre may be, by a look at 32 points along each edge.
  double share_left(const rigid::BoundingBox& room, double radius) const;
  bool empty() const { return tubes_.empty() && meshes_.empty(); }

 private:
  struct PlacedTube {
    rigid::Tube tube;
    rigid::Pose pose;
  };
  struct PlacedMesh {
    rigid::Mesh mesh;
    rigid::Pose pose;
  };
  std::vector<PlacedTube> tubes_;
  std::vector<PlacedMesh> meshes_;
};

}  // namespace silt::coupler
