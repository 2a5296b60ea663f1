#include "adapters/mesh/obj_triangles.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace silt::adapters {

using rigid::Vec3;

void add_polygon(Soup& soup, const std::vector<std::uint32_t>& corners, const std::string& what) {
  if (corners.size() < 3) throw std::invalid_argument(what + " has less than three corners");
  for (const std::uint32_t c : corners)
    if (c >= soup.points.size())
      throw std::invalid_argument(what + " has a corner that is not one of the " +
                                  std::to_string(soup.points.size()) + " points");
  const auto normal = [&](std::size_t k) -> Vec3 {
    const Vec3& a = soup.points[corners[0]];
    return (soup.points[corners[k]] - a).cross(soup.points[corners[k + 1]] - a);
  };
  Vec3 whole = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) whole += normal(k);
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) {
    constexpr double flat = 1e-6;
    if (corners.size() > 3 && normal(k).dot(whole) < -flat * whole.squaredNorm())
      throw std::invalid_argument(what + " is not convex; divide it into triangles");
    soup.triangles.push_back({corners[0], corners[k], corners[k + 1]});
  }
}

namespace {

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

/// The words of a line, one after the other; "" at its end.
std::string_view next_word(std::string_view& line) {
  while (!line.empty() && is_space(line.front())) line.remove_prefix(1);
  std::size_t n = 0;
  while (n < line.size() && !is_space(line[n])) ++n;
  const std::string_view word = line.substr(0, n);
  line.remove_prefix(n);
  return word;
}

class ObjReader {
 public:
  Soup read(std::string_view text) {
    while (!text.empty()) {
      ++number_;
      const std::size_t end = std::min(text.find('\n'), text.size());
      std::string_view line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      const std::string_view word = next_word(line);
      if (word == "v") soup_.points.push_back(point(line));
      if (word == "f") face(line);
    }
    return std::move(soup_);
  }

 private:
  [[noreturn]] void fail(const std::string& text) const {
    throw std::invalid_argument("line " + std::to_string(number_) + ": " + text);
  }
  Vec3 point(std::string_view line) const {
    Vec3 x;
    for (int d = 0; d < 3; ++d) {
      const std::string_view word = next_word(line);
      const char* const begin = word.data() + (word.starts_with('+') ? 1 : 0);
      const auto [end, error] = std::from_chars(begin, word.data() + word.size(), x[d]);
      if (word.empty() || error != std::errc() || end != word.data() + word.size() || !std::isfinite(x[d]))
        fail("expected three numbers, found '" + std::string(word) + "'");
    }
    return x;
  }
  void face(std::string_view line) {
    corners_.clear();
    for (std::string_view word = next_word(line); !word.empty() && word[0] != '#'; word = next_word(line)) {
      std::int64_t n = 0;
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), n);
      const auto points = static_cast<std::int64_t>(soup_.points.size());
      const bool ended = end == word.data() + word.size() || *end == '/';
      if (error != std::errc() || !ended || n == 0 || n > points || n < -points)
        fail("expected the number of one of the " + std::to_string(points) + " points so far, found '" +
             std::string(word) + "'");
      corners_.push_back(static_cast<std::uint32_t>(n > 0 ? n - 1 : points + n));
    }
    add_polygon(soup_, corners_, "the face in line " + std::to_string(number_));
  }

  Soup soup_;
  std::vector<std::uint32_t> corners_;
  std::size_t number_ = 0;
};

}  // namespace

Soup obj_triangles(std::string_view text) {
  return ObjReader().read(text);
}

}  // namespace silt::adapters
