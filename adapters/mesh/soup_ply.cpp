#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include "adapters/mesh/soup.hpp"

namespace silt::adapters {

namespace {

static_assert(std::endian::native == std::endian::little, "binary PLY is turned from big-endian");

using rigid::Vec3;

enum class Form { text, little_endian, big_endian };
enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Form> form_named(std::string_view name) {
  if (name == "ascii") return Form::text;
  if (name == "binary_little_endian") return Form::little_endian;
  if (name == "binary_big_endian") return Form::big_endian;
  return {};
}

std::optional<Type> type_named(std::string_view name) {
  constexpr std::pair<std::string_view, Type> names[] = {
      {"char", Type::int8},      {"int8", Type::int8},       {"uchar", Type::uint8},
      {"uint8", Type::uint8},    {"short", Type::int16},     {"int16", Type::int16},
      {"ushort", Type::uint16},  {"uint16", Type::uint16},   {"int", Type::int32},
      {"int32", Type::int32},    {"uint", Type::uint32},     {"uint32", Type::uint32},
      {"float", Type::float32},  {"float32", Type::float32}, {"double", Type::float64},
      {"float64", Type::float64}};
  for (const auto& [known, type] : names)
    if (known == name) return type;
  return {};
}

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count;  // type of the length of a list

  bool is_corners() const { return count && (name == "vertex_indices" || name == "vertex_index"); }
  /// Returns 0 to 2 for x, y and z.
  std::optional<int> axis() const {
    return !count && name.size() == 1 && name[0] >= 'x' && name[0] <= 'z' ? std::optional(name[0] - 'x')
                                                                          : std::nullopt;
  }
};

struct Element {
  std::string name;
  std::uint64_t count;
  std::vector<Property> properties;

  bool is_vertex() const { return name == "vertex"; }
  bool is_face() const { return name == "face"; }
  bool is_strips() const { return name == "tristrips"; }
};

/// Reads the values after the header one by one, in any format.
class Values {
 public:
  Values(std::string_view bytes, Form form) : bytes_(bytes), form_(form) {}

  double next(Type type) {
    if (form_ == Form::text) return word();
    switch (type) {
      case Type::int8:
        return take<std::int8_t>();
      case Type::uint8:
        return take<std::uint8_t>();
      case Type::int16:
        return take<std::int16_t>();
      case Type::uint16:
        return take<std::uint16_t>();
      case Type::int32:
        return take<std::int32_t>();
      case Type::uint32:
        return take<std::uint32_t>();
      case Type::float32:
        return take<float>();
      case Type::float64:
        return take<double>();
    }
    return 0;
  }
  /// Reads a count or an index: 0 to 2^32 - 1.
  std::uint32_t next_index(Type type) { return index_of(next(type)); }
  static std::uint32_t index_of(double x) {
    if (!(x >= 0 && x <= 4294967295.0) || x != std::floor(x))
      throw std::invalid_argument("a count or the number of a vertex is not a whole number from 0 on");
    return std::uint32_t(x);
  }

 private:
  [[noreturn]] static void cut_off() {
    throw std::invalid_argument("the file ends before all that its header announces: it is cut off");
  }
  template <class Number>
  double take() {
    std::array<char, sizeof(Number)> stored;
    if (bytes_.size() < stored.size()) cut_off();
    std::copy_n(bytes_.begin(), stored.size(), stored.begin());
    bytes_.remove_prefix(stored.size());
    if (form_ == Form::big_endian) std::reverse(stored.begin(), stored.end());
    return double(std::bit_cast<Number>(stored));
  }
  double word() {
    const std::string_view word = next_word(bytes_);
    if (word.empty()) cut_off();
    const auto x = number_in(word);
    if (!x) throw std::invalid_argument("expected a number, found " + shown_word(word));
    return *x;
  }

  std::string_view bytes_;
  Form form_;
};

class PlyReader {
 public:
  explicit PlyReader(std::string_view bytes) : rest_(bytes) {}

  Soup read() {
    read_header();
    Values values(rest_, form_);
    for (const Element& element : elements_) {
      if (element.properties.empty()) continue;
      for (std::uint64_t n = 0; n < element.count; ++n) read_one(element, n, values);
    }
    faces_.cut_into(soup_, "face ");
    strips_.cut_into(soup_, "a triangle of strip ");
    return std::move(soup_);
  }

 private:
  /// Lines end as the first one does: with a line feed, a carriage return, or both.
  std::vector<std::string> next_line() {
    const std::size_t end = rest_.find(line_end_);
    if (end == rest_.npos) throw std::invalid_argument("its header has no line 'end_header'");
    std::vector<std::string> words;
    std::string_view line = rest_.substr(0, end);
    for (auto word = next_word(line); !word.empty(); word = next_word(line)) words.emplace_back(word);
    rest_.remove_prefix(end + line_end_.size());
    return words;
  }

  void read_header() {
    if (const std::size_t end = rest_.find_first_of("\r\n"); end != rest_.npos && rest_[end] == '\r')
      line_end_ = rest_.substr(end, 2) == "\r\n" ? "\r\n" : "\r";
    if (!rest_.starts_with("ply") || next_line() != std::vector<std::string>{"ply"})
      throw std::invalid_argument("it is no PLY: its first line is not 'ply'");
    bool has_format = false;
    for (auto words = next_line(); words != std::vector<std::string>{"end_header"}; words = next_line()) {
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "format" && words.size() >= 2) {
        const auto form = form_named(words[1]);
        if (!form)
          throw std::invalid_argument("its format is '" + words[1] +
                                      "'; it must be ascii, binary_little_endian or binary_big_endian");
        form_ = *form, has_format = true;
      } else if (words[0] == "element" && words.size() == 3) {
        elements_.push_back({words[1], count_of(words[2]), {}});
      } else if (words[0] == "property" && !elements_.empty()) {
        elements_.back().properties.push_back(property_of(words));
      } else {
        throw std::invalid_argument("its header has a line that begins with '" + words[0] +
                                    "' where that means nothing");
      }
    }
    if (!has_format) throw std::invalid_argument("its header has no line 'format'");
    for (const Element& element : elements_) check(element);
  }
  void check(const Element& element) {
    int axes = 0;
    bool has_corners = false;
    for (const Property& p : element.properties) {
      axes += p.axis().has_value(), has_corners |= p.is_corners();
      soup_.is_single |= element.is_vertex() && p.axis() && p.type == Type::float32;
    }
    if (element.is_vertex() && axes != 3)
      throw std::invalid_argument("its vertices have no properties x, y and z");
    if ((element.is_face() || element.is_strips()) && element.count > 0 && !has_corners)
      throw std::invalid_argument("its element " + element.name +
                                  " has no list vertex_indices (or vertex_index)");
  }
  static std::uint64_t count_of(const std::string& word) {
    std::uint64_t n = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), n);
    if (error != std::errc() || end != word.data() + word.size())
      throw std::invalid_argument("its header has '" + word + "' for the number of an element");
    return n;
  }
  static Property property_of(const std::vector<std::string>& words) {
    const bool is_list = words.size() == 5 && words[1] == "list";
    const auto type = words.size() >= 3 ? type_named(words[is_list ? 3 : 1]) : std::nullopt;
    const auto count = is_list ? type_named(words[2]) : std::nullopt;
    if ((!is_list && words.size() != 3) || !type || (is_list && !count))
      throw std::invalid_argument(
          "its header has a property '" + words.back() +
          "' that is not 'type name' or 'list type type name', or of a type it does not know");
    return {words.back(), *type, count};
  }

  void read_one(const Element& element, std::uint64_t n, Values& values) {
    Vec3 x = Vec3::Zero();
    corners_.clear();
    for (const Property& p : element.properties) {
      if (p.count) {
        const bool of_face = p.is_corners() && element.is_face(),
                   of_strip = p.is_corners() && element.is_strips();
        const std::uint32_t count = values.next_index(*p.count);
        for (std::uint32_t k = 0; k < count; ++k) {
          const double value = values.next(p.type);
          if (of_strip) add_to_strip(value, n);
          if (of_face) corners_.push_back(Values::index_of(value));
        }
      } else {
        const double value = values.next(p.type);
        if (p.axis()) x[*p.axis()] = value;
      }
    }
    if (element.is_face()) faces_.add(corners_, n);
    if (element.is_vertex()) soup_.points.push_back(x);
  }
  /// Adds a corner of a strip, a triangle with the two before it, of alternating orientation; -1 ends it.
  void add_to_strip(double value, std::uint64_t n) {
    if (value == -1) return corners_.clear();
    corners_.push_back(Values::index_of(value));
    const std::size_t k = corners_.size();
    if (k < 3) return;
    const std::uint32_t a = corners_[k - 3], b = corners_[k - 2], c = corners_[k - 1];
    if (a == b || b == c || c == a) return;  // degenerate, as where strips are joined
    strips_.add(k % 2 ? std::vector{a, b, c} : std::vector{b, a, c}, n);
  }

  std::string_view rest_;
  std::string line_end_ = "\n";
  Form form_ = Form::text;
  std::vector<Element> elements_;
  Soup soup_;
  Polygons faces_, strips_;
  std::vector<std::uint32_t> corners_;
};

}  // namespace

Soup ply_triangles(std::string_view bytes) {
  return PlyReader(bytes).read();
}

}  // namespace silt::adapters
