#include <algorithm>
#include <charconv>
#include <limits>
#include <stdexcept>
#include <string>

#include "adapters/mesh/soup.hpp"

namespace silt::adapters {

using rigid::Vec3;

namespace {

class ObjReader {
 public:
  explicit ObjReader(std::string_view text) : rest_(text) {}

  Soup read() {
    while (!rest_.empty()) {
      std::string_view line = next_line();
      const std::string_view word = next_word(line);
      if (word == "v" || word == "V") soup_.points.push_back(point(line));
      if (word == "f" || word == "F" || word == "fo") face(line);
      if (word == "surf") fail("it has a free-form surface ('surf'); save it as triangles");
    }
    polygons_.cut_into(soup_, "the face in line ");
    return std::move(soup_);
  }

 private:
  [[noreturn]] void fail(const std::string& text) const {
    throw std::invalid_argument("line " + std::to_string(number_) + ": " + text);
  }
  /// Reads a line up to a line feed, a carriage return, or both.
  std::string_view next_piece() {
    ++end_;
    const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
    const std::string_view piece = rest_.substr(0, end);
    rest_.remove_prefix(end);
    rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, rest_.size()));
    return piece;
  }
  /// Reads a line with its continuations after backslashes; valid until the next call.
  std::string_view next_line() {
    std::string_view line = next_piece();
    number_ = end_;
    if (!line.ends_with('\\')) return line;
    joined_ = line;
    while (joined_.ends_with('\\') && !rest_.empty()) {
      joined_.back() = ' ';
      joined_ += next_piece();
    }
    return joined_;
  }
  Vec3 point(std::string_view line) const {
    Vec3 x;
    for (int d = 0; d < 3; ++d) {
      const std::string_view word = next_word(line);
      const auto number = number_in(word);
      if (!number) fail("expected three numbers, found " + shown_word(word));
      x[d] = *number;
    }
    return x;
  }
  /// Corners are numbered from 1, or negative from the last point read.
  void face(std::string_view line) {
    corners_.clear();
    for (std::string_view word = next_word(line); !word.empty() && word[0] != '#'; word = next_word(line)) {
      std::int64_t n = 0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), n);
      const auto points = std::int64_t(soup_.points.size());
      const bool ended = end == word.data() + word.size() || *end == '/';
      if (error != std::errc() || !ended || n == 0 || n > std::numeric_limits<std::uint32_t>::max() ||
          n < -points)
        fail("expected the number of one of the points, or one of the " + std::to_string(points) +
             " so far, negative, counted back from here; found '" + std::string(word) + "'");
      corners_.push_back(std::uint32_t(n > 0 ? n - 1 : points + n));
    }
    polygons_.add(corners_, number_);
  }

  std::string_view rest_;
  std::string joined_;
  Soup soup_;
  Polygons polygons_;
  std::vector<std::uint32_t> corners_;
  std::size_t number_ = 0, end_ = 0;  // first and last number of the line with its continuations
};

}  // namespace

Soup obj_triangles(std::string_view text) {
  return ObjReader(text).read();
}

}  // namespace silt::adapters
