#include "lbm/levels/border_pieces.hpp"

#include <algorithm>

namespace silt::lbm {

Surroundings BorderSurroundings::around(Int3 cell) {
  Surroundings s;
  const Int3 images[] = {coarse_.wrapped(cell - Int3{1, 1, 1}), cell, coarse_.wrapped(cell + Int3{1, 1, 1})};
  for_cells({}, {3, 3, 3}, [&](Int3 at) {
    const Int3 v = at - Int3{1, 1, 1}, image{images[at.x].x, images[at.y].y, images[at.z].z};
    if (!coarse_.inside(image)) {
      s.any_outside = true;
      for (int d = 0; d < 3; ++d)
        if (v[d] != 0) s.alike[d] = 1;  // at the end of the domain
      return;
    }
    BlockPlace& place = recent_[at.z][at.y][at.x];
    if (!place.box.contains(image)) place = coarse_.block_at(image);
    s.any_far |= !coarse_.is_known(place);
    if (fine_.is_of_level(place)) s.fine |= Surroundings::bit(v);
    for (int d = 0; d < 3; ++d)
      s.alike[d] = std::min(s.alike[d], place.box.lower[d] + place.box.size[d] - image[d]);
  });
  return s;
}

std::vector<BorderPiece> alike_pieces(BorderSurroundings& surroundings, const CellBox& face, int axis,
                                      int outer) {
  std::vector<BorderPiece> pieces;
  std::vector<std::size_t> last, now;  // pieces of the last rows, of these
  const Int3 end = face.lower + face.size;
  int rows = 0;
  for (Int3 first = face.lower; first[outer] < end[outer];
       first[outer] += rows, last.swap(now), now.clear()) {
    rows = end[outer] - first[outer];
    for (Int3 at = first; at[axis] < end[axis];) {
      const Surroundings s = surroundings.around(at);
      const int length = std::min(s.alike[axis], end[axis] - at[axis]);
      rows = std::min(rows, s.alike[outer]);
      const auto found = std::ranges::find_if(last, [&](std::size_t k) {
        const BorderPiece& p = pieces[k];
        return p.first[axis] == at[axis] && p.length == length && p.around.alike[outer] > p.rows;
      });
      if (found != last.end()) {
        now.push_back(*found);
      } else if (s.fine != 0 && !s.any_far) {
        now.push_back(pieces.size());
        pieces.push_back({at, length, 0, s});
      }
      at[axis] += length;
    }
    for (const std::size_t k : now) pieces[k].rows += rows;
  }
  return pieces;
}

}  // namespace silt::lbm
