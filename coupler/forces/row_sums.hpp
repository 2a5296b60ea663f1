#pragma once
// Sums over links, cells, blocks and ranks, for each body and wall in a step.
#include <cstdint>
#include <span>
#include <vector>

namespace silt::coupler {

/// Integers for each row of the BodySet: force (3) and torque (3) in lbm::link_quantum; resistance (21) and
/// push (6) of its links in the quanta of lbm::ResistanceSums; in the form `exact` the number of its cells
/// and the sum of their lower corners' coordinates (4).
class RowSums {
 public:
  static constexpr int force_width = 6, resistance_width = 21, push_width = 6, cells_width = 4;

  explicit RowSums(bool cells) : width_(cells_begin + (cells ? cells_width : 0)) {}
  /// Sets all to zero.
  void reset(std::size_t rows) { all_.assign(rows * width_, 0); }

  int width() const { return width_; }
  std::span<std::int64_t> all() { return all_; }
  std::int64_t* force(std::size_t row) { return all_.data() + row * width_; }
  const std::int64_t* force(std::size_t row) const { return all_.data() + row * width_; }
  std::int64_t* resistance(std::size_t row) { return force(row) + force_width; }
  const std::int64_t* resistance(std::size_t row) const { return force(row) + force_width; }
  std::int64_t* push(std::size_t row) { return resistance(row) + resistance_width; }
  const std::int64_t* push(std::size_t row) const { return resistance(row) + resistance_width; }
  std::int64_t* cells(std::size_t row) { return force(row) + cells_begin; }
  const std::int64_t* cells(std::size_t row) const { return force(row) + cells_begin; }

 private:
  static constexpr int cells_begin = force_width + resistance_width + push_width;
  int width_;
  std::vector<std::int64_t> all_;
};

}  // namespace silt::coupler
