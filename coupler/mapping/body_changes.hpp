#pragma once
// The bodies that came and those that left before a step: the fluid takes note of both.
#include "rigid/bodies/body_set.hpp"

namespace silt::coupler {

struct BodyChanges {
  rigid::BodyId first_new = 0, end_new = 0;  // ids from first_new on, below end_new, have come
  rigid::BodySet gone;                       // those that were held here and have left, as they were

  bool none() const { return first_new == end_new && gone.size() == 0; }
  bool is_new(rigid::BodyId id) const { return id >= first_new && id < end_new; }
  bool has_gone(rigid::BodyId id) const { return gone.row_of(id) < gone.size(); }
};

}  // namespace silt::coupler
