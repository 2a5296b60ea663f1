
#include <algorithm>
#include <array>
#include <memory>

#include "device/mirror.hpp"
#include "lbm/passes/passes.hpp"

namespace silt::lbm {

namespace {
struct Lists {
  Mirror<FastInBlock> cells;
  Mirror<unsigned> count;
  explicit Lists(Device device) : cells(device), count(device) {
    cells.host().resize(FastList::room), count.host().resize(1);
    cells.make_room(), count.clear();
  }
};
Lists& lists(Device device) {
  static auto* const all = new std::array<std::unique_ptr<Lists>, device_names.size()>;  // outlive the device
  std::unique_ptr<Lists>& of = (*all)[std::size_t(device)];
  if (!of) of = std::make_unique<Lists>(device);
  return *of;
}
}  // namespace

FastList fast_list(Device device) {
  return {lists(device).cells.device(), lists(device).count.device()};
}

std::vector<FastInBlock> take_fast_cells(Device device) {
  Lists& all = lists(device);
  all.count.fetch(), wait(device);
  const unsigned count = std::min(all.count.host()[0], FastList::room);
  if (count == 0) return {};
  all.cells.fetch(), wait(device);
  all.count.clear();
  return {all.cells.host().begin(), all.cells.host().begin() + count};
}

}  // namespace silt::lbm
