#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "adapters/mesh/soup.hpp"

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

/// Adds a triangle of the last three points.
void close_triangle(Soup& soup) {
  const auto end = std::uint32_t(soup.points.size());
  soup.triangles.push_back({end - 3, end - 2, end - 1});
}

Soup from_binary(std::string_view bytes, bool is_swapped) {
  Soup soup;
  soup.is_single = true;
  const std::uint32_t count = triangle_count(bytes, is_swapped);
  const char* at = bytes.data() + first_triangle;
  for (std::uint32_t t = 0; t < count; ++t, at += triangle_bytes) {
    for (int k = 0; k < 9; ++k) {
      const float x =
          std::bit_cast<float>(word_at(at + (3 + k) * sizeof(float), is_swapped));  // after the normal
      if (!std::isfinite(x))
        throw std::invalid_argument("triangle " + std::to_string(t) + " has a coordinate that is not finite");
      if (k % 3 == 0) soup.points.emplace_back();
      soup.points.back()[k % 3] = x;
    }
    close_triangle(soup);
  }
  return soup;
}

/// Refuses a binary file whose length does not fit its number of triangles.
[[noreturn]] void refuse_length(std::string_view bytes) {
  const std::uint32_t count = triangle_count(bytes);
  const std::size_t room = (bytes.size() - first_triangle) / triangle_bytes;
  const std::string is = "as a binary file of " + std::to_string(count) + " triangles it would have " +
                         std::to_string(binary_length(count)) + " bytes, it has " +
                         std::to_string(bytes.size());
  if (room > 0 && bytes.size() == binary_length(std::uint32_t(room)))
    throw std::invalid_argument("its count of triangles is wrong, or it is cut off: " + is + ", as of " +
                                std::to_string(room) + "; save it again");
  if (bytes.size() > binary_length(count))
    throw std::invalid_argument("it has more than its triangles: " + is + "; save it again");
  throw std::invalid_argument("it is no STL, or cut off: " + is);
}

/// Reads words in lower case.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text), rest_(text) {}

  std::string next() {
    std::string word(next_word(rest_));
    for (char& c : word) c = char(std::tolower(static_cast<unsigned char>(c)));
    return word;
  }
  /// Skips to the end of the line or to a facet, since all may be in one line.
  void skip_name() {
    const std::size_t length = std::min(rest_.find_first_of("\r\n"), rest_.size());
    Words line(rest_.substr(0, length));
    for (std::string_view from = line.rest_; !from.empty(); from = line.rest_) {
      if (line.next() != "facet") continue;
      Words facet = line;
      if (facet.next() != "normal" || !number_in(facet.next())) continue;
      return rest_.remove_prefix(length - from.size());
    }
    rest_.remove_prefix(length);
  }
  void expect(const char* wanted) {
    const std::string word = next();
    if (word != wanted) fail(std::string("'") + wanted + "'", word);
  }
  /// Skips a component of a normal or colour, which may be "nan".
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
  /// Lines end with a line feed, a carriage return, or both.
  [[noreturn]] void refuse(const std::string& text) const {
    int line = 1;
    for (std::size_t k = 0; k < text_.size() - rest_.size(); ++k)
      line += text_[k] == '\r' || (text_[k] == '\n' && (k == 0 || text_[k - 1] != '\r'));
    throw std::invalid_argument("line " + std::to_string(line) + ": " + text);
  }

 private:
  std::string_view text_, rest_;
};

void add_facet(Words& words, Soup& soup) {
  std::string word = words.next();
  if (word == "normal") {
    for (int d = 0; d < 3; ++d) words.skip_number();
    word = words.next();
  }
  if (word != "outer") words.fail("'outer'", word);
  words.expect("loop");
  for (int corner = 0; corner < 3; ++corner) {
    words.expect("vertex");
    rigid::Vec3& x = soup.points.emplace_back();
    for (int d = 0; d < 3; ++d) x[d] = words.number();
  }
  word = words.next();
  if (word == "vertex") words.refuse("the facet has more than three vertices; divide it into triangles");
  if (word != "endloop") words.fail("'endloop'", word);
  words.expect("endfacet");
  close_triangle(soup);
}

Soup from_text(std::string_view text) {
  Soup soup;
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
      add_facet(words, soup), is_open = true;
    } else if ((word == "color" || word == "colour") && is_open) {
      for (int d = 0; d < 3; ++d) words.skip_number();
    } else {
      words.fail(is_open ? "'facet' or 'endsolid'" : "'solid' or the end of the file", word);
    }
  }
  if (is_open) words.fail("'facet' or 'endsolid' (the file is cut off)", "");
  return soup;
}

bool is_text(std::string_view bytes) {
  constexpr std::size_t looked_at = 1000;
  const std::string_view start = bytes.substr(0, looked_at);
  const auto is_control = [](char c) { return (c >= 0 && c < '\t') || (c > '\r' && c < ' '); };
  return !std::any_of(start.begin(), start.end(), is_control) && Words(start).next() == "solid";
}

}  // namespace

Soup stl_triangles(std::string_view bytes) {
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
  if (past > 0 && past < triangle_bytes && triangle_count(bytes) > 0)  // not enough for another one
    return from_binary(bytes, false);
  refuse_length(bytes);
}

}  // namespace silt::adapters
