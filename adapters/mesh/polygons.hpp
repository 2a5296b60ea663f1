#pragma once
// Faces of any number of corners become triangles.
#include <string>

#include "adapters/mesh/soup.hpp"

namespace silt::adapters {

/// The faces of a file, gathered before all points are known.
class Polygons {
 public:
  /// `number` says which one it is: its line or its place.
  void add(const std::vector<std::uint32_t>& corners, std::size_t number);
  /// Adds the triangles of all to a soup: of convex ones a fan, of others by cutting off ears in the plane of
  /// the face (G. Meisters, Am. Math. Mon. 82 (1975) 648). std::invalid_argument for a face of less than
  /// three corners, of corners that are not there or not finite, or that crosses itself; `what` stands before
  /// its number.
  void cut_into(Soup&, const std::string& what) const;

 private:
  struct Face {
    std::size_t begin, number;  // begin: in corners_
  };
  std::vector<std::uint32_t> corners_;
  std::vector<Face> faces_;
};

}  // namespace silt::adapters
