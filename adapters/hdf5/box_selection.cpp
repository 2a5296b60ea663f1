#include "adapters/hdf5/box_selection.hpp"

#include <algorithm>
#include <cstring>
#include <tuple>

namespace silt::adapters::hdf5 {

BoxSelection::BoxSelection(std::array<int, 3> cells, std::vector<CellBox> boxes) : boxes_(std::move(boxes)) {
  std::vector<Row>& rows = rows_;
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    const CellBox& box = boxes_[b];
    for (int d = 0; d < 3; ++d)
      if (box.lower[d] < 0 || box.upper[d] > cells[d] || box.lower[d] > box.upper[d])
        throw std::invalid_argument("box " + std::to_string(b) + " reaches outside the lattice of " +
                                    std::to_string(cells[0]) + " x " + std::to_string(cells[1]) + " x " +
                                    std::to_string(cells[2]) + " cells");
    if (box.cells() == 0) continue;
    const std::size_t length = box.upper[0] - box.lower[0];
    std::size_t offset = 0;
    for (int z = box.lower[2]; z < box.upper[2]; ++z)
      for (int y = box.lower[1]; y < box.upper[1]; ++y, offset += length)
        rows.push_back({z, y, box.lower[0], length, b, offset});
    cells_ += box.cells();
  }
  std::sort(rows.begin(), rows.end(),
            [](const Row& a, const Row& b) { return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x); });
}

std::vector<std::byte> BoxSelection::pack(std::size_t element,
                                          const std::function<void(std::size_t, void*)>& fill) const {
  std::vector<std::vector<std::byte>> of_box(boxes_.size());
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    of_box[b].resize(boxes_[b].cells() * element);
    if (!of_box[b].empty()) fill(b, of_box[b].data());
  }
  if (boxes_.size() == 1) return std::move(of_box[0]);
  std::vector<std::byte> packed(cells_ * element);
  std::byte* out = packed.data();
  for (const Row& row : rows_) {
    std::memcpy(out, of_box[row.box].data() + row.offset * element, row.length * element);
    out += row.length * element;
  }
  return packed;
}

void BoxSelection::unpack(const std::vector<std::byte>& packed, std::size_t element,
                          const std::function<void(std::size_t, const void*)>& take) const {
  std::vector<std::vector<std::byte>> of_box(boxes_.size());
  for (std::size_t b = 0; b < boxes_.size(); ++b) of_box[b].resize(boxes_[b].cells() * element);
  const std::byte* in = packed.data();
  for (const Row& row : rows_) {
    std::memcpy(of_box[row.box].data() + row.offset * element, in, row.length * element);
    in += row.length * element;
  }
  for (std::size_t b = 0; b < boxes_.size(); ++b)
    if (!of_box[b].empty()) take(b, of_box[b].data());
}

Handle BoxSelection::file_space(const File& file, hid_t dataset, int leading) const {
  Handle space(H5Dget_space(dataset), H5Sclose, file.path(), "shape of a dataset");
  const auto shape = file.shape(dataset);
  const std::size_t first = leading >= 0 ? 1 : 0;  // axis of z
  H5Sselect_none(space);
  for (const CellBox& box : boxes_) {
    if (box.cells() == 0) continue;
    std::vector<hsize_t> start(shape.size(), 0), count = shape;
    if (leading >= 0) {
      start[0] = leading;
      count[0] = 1;
    }
    for (int d = 0; d < 3; ++d) {
      start[first + 2 - d] = box.lower[d];
      count[first + 2 - d] = box.upper[d] - box.lower[d];
    }
    file.check(H5Sselect_hyperslab(space, H5S_SELECT_OR, start.data(), nullptr, count.data(), nullptr),
               "cannot select a block");
  }
  return space;
}

namespace {
struct Transfer {
  Handle memory, list;
};
Transfer transfer(const File& file, hid_t space) {
  const hsize_t n = H5Sget_select_npoints(space), length = n ? n : 1;
  Transfer t{{H5Screate_simple(1, &length, nullptr), H5Sclose, file.path(), "memory shape"},
             {H5Pcreate(H5P_DATASET_XFER), H5Pclose, file.path(), "transfer list"}};
  if (n == 0) H5Sselect_none(t.memory);
  H5Pset_dxpl_mpio(t.list, H5FD_MPIO_COLLECTIVE);
  return t;
}
}  // namespace

void BoxSelection::write(const File& file, hid_t dataset, hid_t type, int leading, const void* packed) const {
  const Handle space = file_space(file, dataset, leading);
  const Transfer t = transfer(file, space);
  file.check(H5Dwrite(dataset, type, t.memory, space, t.list, packed), "cannot write (is the disk full?)");
}

void BoxSelection::read(const File& file, hid_t dataset, hid_t type, int leading, void* packed) const {
  const Handle space = file_space(file, dataset, leading);
  const Transfer t = transfer(file, space);
  file.check(H5Dread(dataset, type, t.memory, space, t.list, packed), "cannot read");
}

}  // namespace silt::adapters::hdf5
