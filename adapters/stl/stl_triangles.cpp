#include "adapters/stl/stl_triangles.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include "adapters/stl/foreign_format.hpp"
#include "adapters/stl/number_word.hpp"

namespace silt::adapters {

namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

constexpr std::size_t header_bytes = 80, triangle_bytes = 50;
constexpr std::size_t first_triangle = header_bytes + sizeof(std::uint32_t);

std::uint32_t word_at(const char* at, bool is_swapped) {
  std::uint32_t word;
  std::memcpy(&word, at, sizeof word);
  return is_swapped ? __builtin_bswap32(word) : word;
}

std::uint32_t triangle_count(std::string_view bytes, bool is_swapped = false) {
  return word_at(bytes.data() + header_bytes, is_swapped);
}

std::size_t binary_length(std::uint32_t count) {
  return first_triangle + triangle_bytes * count;
}

StlTriangles from_binary(std::string_view bytes, bool is_swapped) {
  StlTriangles read{std::vector<Triangle>(triangle_count(bytes, is_swapped)), true};
  const char* at = bytes.data() + first_triangle;
  for (std::size_t t = 0; t < read.triangles.size(); ++t, at += triangle_bytes)
    for (int k = 0; k < 9; ++k) {
      const float x =
          std::bit_cast<float>(word_at(at + (3 + k) * sizeof(float), is_swapped));  // behind the normal
      if (!std::isfinite(x))
        throw std::invalid_argument("triangle " + std::to_string(t) + " has a coordinate that is not finite");
      read.triangles[t][k / 3][k % 3] = x;
    }
  return read;
}

/// Of a binary file whose length is not what its count says.
[[noreturn]] void refuse_length(std::string_view bytes) {
  const std::uint32_t count = triangle_count(bytes);
  const std::size_t room = (bytes.size() - first_triangle) / triangle_bytes;
  const std::string is = "as a binary file of " + std::to_string(count) + " triangles it would have " +
                         std::to_string(binary_length(count)) + " bytes, it has " +
                         std::to_string(bytes.size());
  if (room > 0 && bytes.size() == binary_length(static_cast<std::uint32_t>(room)))
    throw std::invalid_argument("its count of triangles is wrong, or it is cut off: " + is + ", as of " +
                                std::to_string(room) + "; save it again");
  if (bytes.size() > binary_length(count))
    throw std::invalid_argument("it has more than its triangles: " + is + "; save it again");
  throw std::invalid_argument("it is no STL, or cut off: " + is);
}

/// The words of a text, without regard to case, and the line they stand in.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  std::string next() {
    while (at_ < text_.size() && is_space(text_[at_])) pass();
    std::string word;
    while (at_ < text_.size() && !is_space(text_[at_]))
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(text_[at_++])));
    return word;
  }
  /// Goes to the end of the line, or where in it a facet begins: all may stand in one line.
  void skip_name() {
    Words ahead = *this;
    ahead.text_ = text_.substr(0, std::min(text_.find_first_of("\r\n", at_), text_.size()));
    for (at_ = ahead.at_; at_ < ahead.text_.size(); at_ = ahead.at_) {
      const std::size_t before = ahead.at_;
      if (ahead.next() != "facet") continue;
      Words facet = ahead;
      if (facet.next() != "normal" || !number_in(facet.next())) continue;
      at_ = before;
      return;
    }
  }
  void expect(const char* wanted) {
    const std::string word = next();
    if (word != wanted) fail(std::string("'") + wanted + "'", word);
  }
  /// Of a normal or a colour: what stands for no number is taken.
  void skip_number() {
    const std::string word = next();
    if (!number_in(word)) fail("a number", word);
  }
  double number() {
    const std::string word = next();
    const auto x = number_in(word);
    if (!x || !std::isfinite(*x)) fail("a number", word);
    return *x;
  }
  [[noreturn]] void fail(const std::string& wanted, const std::string& found) const {
    refuse("expected " + wanted + ", found " + shown_word(found));
  }
  [[noreturn]] void refuse(const std::string& text) const {
    throw std::invalid_argument("line " + std::to_string(line_) + ": " + text);
  }

 private:
  static bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)); }
  /// Lines end with a line feed, a carriage return, or both.
  void pass() {
    const char c = text_[at_++];
    line_ += c == '\n' ? (at_ < 2 || text_[at_ - 2] != '\r') : c == '\r';
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

Triangle facet(Words& words) {
  std::string word = words.next();
  if (word == "normal") {
    for (int d = 0; d < 3; ++d) words.skip_number();
    word = words.next();
  }
  if (word != "outer") words.fail("'outer'", word);
  words.expect("loop");
  Triangle triangle;
  for (rigid::Vec3& corner : triangle) {
    words.expect("vertex");
    for (int d = 0; d < 3; ++d) corner[d] = words.number();
  }
  word = words.next();
  if (word == "vertex") words.refuse("the facet has more than three vertices; divide it into triangles");
  if (word != "endloop") words.fail("'endloop'", word);
  words.expect("endfacet");
  return triangle;
}

StlTriangles from_text(std::string_view text) {
  StlTriangles read;
  Words words(text);
  words.expect("solid");
  words.skip_name();
  bool is_open = true;
  for (std::string word = words.next(); !word.empty(); word = words.next()) {
    if (word == "solid" && !is_open) {
      words.skip_name(), is_open = true;
    } else if (word == "endsolid" && is_open) {
      words.skip_name(), is_open = false;
    } else if (word == "facet") {
      read.triangles.push_back(facet(words)), is_open = true;
    } else if ((word == "color" || word == "colour") && is_open) {
      for (int d = 0; d < 3; ++d) words.skip_number();
    } else {
      words.fail(is_open ? "'facet' or 'endsolid'" : "'solid' or the end of the file", word);
    }
  }
  if (is_open) words.fail("'facet' or 'endsolid' (the file is cut off)", "");
  return read;
}

bool is_text(std::string_view bytes) {
  constexpr std::size_t looked_at = 1000;
  const std::string_view start = bytes.substr(0, looked_at);
  const auto is_control = [](char c) { return (c >= 0 && c < '\t') || (c > '\r' && c < ' '); };
  return !std::any_of(start.begin(), start.end(), is_control) && Words(start).next() == "solid";
}

}  // namespace

StlTriangles stl_triangles(std::string_view bytes) {
  refuse_foreign(bytes);
  const bool has_count = bytes.size() >= first_triangle;
  for (const bool is_swapped : {false, true})
    if (has_count && bytes.size() == binary_length(triangle_count(bytes, is_swapped)))
      return from_binary(bytes, is_swapped);
  if (is_text(without_mark(bytes))) return from_text(without_mark(bytes));
  if (!has_count)
    throw std::invalid_argument(
        "it is no STL: neither does it begin with 'solid' nor has it a binary header");
  const std::size_t past = bytes.size() - std::min(bytes.size(), binary_length(triangle_count(bytes)));
  if (past > 0 && past < triangle_bytes && triangle_count(bytes) > 0)  // not enough for one more
    return from_binary(bytes, false);
  refuse_length(bytes);
}

}  // namespace silt::adapters
