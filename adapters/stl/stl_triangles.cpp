#include "adapters/stl/stl_triangles.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

namespace silt::adapters {

namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

constexpr std::size_t header_bytes = 80, triangle_bytes = 50;

std::uint32_t triangle_count(std::string_view bytes) {
  std::uint32_t count;
  std::memcpy(&count, bytes.data() + header_bytes, sizeof count);
  return count;
}

std::size_t binary_length(std::uint32_t count) {
  return header_bytes + sizeof count + triangle_bytes * count;
}

std::vector<Triangle> from_binary(std::string_view bytes) {
  std::vector<Triangle> triangles(triangle_count(bytes));
  const char* at = bytes.data() + header_bytes + sizeof(std::uint32_t);
  for (std::size_t t = 0; t < triangles.size(); ++t, at += triangle_bytes) {
    float x[9];
    std::memcpy(x, at + 3 * sizeof(float), sizeof x);  // behind the normal
    for (int k = 0; k < 3; ++k) triangles[t][k] = {x[3 * k], x[3 * k + 1], x[3 * k + 2]};
    for (const float number : x)
      if (!std::isfinite(number))
        throw std::invalid_argument("triangle " + std::to_string(t) + " has a coordinate that is not finite");
  }
  return triangles;
}

/// The words of a text, without regard to case, and the line they stand in.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  std::string next() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])))
      line_ += text_[at_++] == '\n';
    std::string word;
    while (at_ < text_.size() && !std::isspace(static_cast<unsigned char>(text_[at_])))
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(text_[at_++])));
    return word;
  }
  void skip_line() { at_ = std::min(text_.find('\n', at_), text_.size()); }

  void expect(const char* wanted) {
    const std::string word = next();
    if (word != wanted) fail(std::string("'") + wanted + "'", word);
  }
  double number() {
    const std::string word = next();
    double x = 0;
    const char* begin = word.data() + word.starts_with('+');
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), x);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(x)) fail("a number", word);
    return x;
  }
  [[noreturn]] void fail(const std::string& wanted, const std::string& found) const {
    throw std::invalid_argument("line " + std::to_string(line_) + ": expected " + wanted + ", found " +
                                (found.empty() ? "the end of the file" : "'" + found + "'"));
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

std::vector<Triangle> from_text(std::string_view text) {
  std::vector<Triangle> triangles;
  Words words(text);
  words.expect("solid");
  words.skip_line();  // the name
  for (;;) {
    const std::string word = words.next();
    if (word == "endsolid") break;
    if (word != "facet") words.fail("'facet' or 'endsolid'", word);
    words.expect("normal");
    for (int d = 0; d < 3; ++d) words.number();
    words.expect("outer"), words.expect("loop");
    Triangle& triangle = triangles.emplace_back();
    for (rigid::Vec3& corner : triangle) {
      words.expect("vertex");
      for (int d = 0; d < 3; ++d) corner[d] = words.number();
    }
    words.expect("endloop"), words.expect("endfacet");
  }
  words.skip_line();
  if (const std::string more = words.next(); !more.empty())
    words.fail("the end of the file behind 'endsolid' (one solid a file)", more);
  return triangles;
}

bool begins_with_solid(std::string_view bytes) {
  Words words(bytes.substr(0, header_bytes));
  return words.next() == "solid";
}

}  // namespace

std::vector<Triangle> stl_triangles(std::string_view bytes) {
  const bool has_count = bytes.size() >= binary_length(0);
  if (has_count && bytes.size() == binary_length(triangle_count(bytes))) return from_binary(bytes);
  if (begins_with_solid(bytes)) return from_text(bytes);
  if (!has_count)
    throw std::invalid_argument(
        "it is no STL: neither does it begin with 'solid' nor has it a binary header");
  throw std::invalid_argument("it is no STL, or cut off: as a binary file of " +
                              std::to_string(triangle_count(bytes)) + " triangles it would have " +
                              std::to_string(binary_length(triangle_count(bytes))) + " bytes, it has " +
                              std::to_string(bytes.size()));
}

}  // namespace silt::adapters
