#include "adapters/mesh/ply_triangles.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>

namespace silt::adapters {

namespace {

static_assert(std::endian::native == std::endian::little, "binary PLY is read as it stands");

using rigid::Vec3;

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

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
  std::optional<Type> count;  // of a list
};

struct Element {
  std::string name;
  std::uint64_t count;
  std::vector<Property> properties;
};

/// What follows the header, value by value; in either form.
class Values {
 public:
  Values(std::string_view bytes, bool is_text) : bytes_(bytes), is_text_(is_text) {}

  double next(Type type) {
    if (is_text_) return word();
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
  /// A number that counts or points to something: 0 to 2^32 - 1.
  std::uint32_t next_index(Type type) {
    const double x = next(type);
    if (!(x >= 0 && x <= 4294967295.0) || x != std::floor(x))
      throw std::invalid_argument("a count or the number of a vertex is not a whole number from 0 on");
    return static_cast<std::uint32_t>(x);
  }

 private:
  [[noreturn]] static void cut_off() {
    throw std::invalid_argument("the file ends before all that its header announces: it is cut off");
  }
  template <class Number>
  double take() {
    if (bytes_.size() < sizeof(Number)) cut_off();
    Number x;
    std::memcpy(&x, bytes_.data(), sizeof x);
    bytes_.remove_prefix(sizeof x);
    return static_cast<double>(x);
  }
  double word() {
    const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
    while (!bytes_.empty() && is_space(bytes_.front())) bytes_.remove_prefix(1);
    if (bytes_.empty()) cut_off();
    double x = 0;
    const char* const last = bytes_.data() + bytes_.size();
    const auto [end, error] = std::from_chars(bytes_.data(), last, x);
    if (error != std::errc() || (end != last && !is_space(*end)))
      throw std::invalid_argument("expected a number, found '" + std::string(bytes_.substr(0, 16)) + "'");
    bytes_.remove_prefix(static_cast<std::size_t>(end - bytes_.data()));
    return x;
  }

  std::string_view bytes_;
  bool is_text_;
};

class PlyReader {
 public:
  explicit PlyReader(std::string_view bytes) : rest_(bytes) {}

  Soup read() {
    read_header();
    Values values(rest_, is_text_);
    for (const Element& element : elements_) {
      if (element.properties.empty()) continue;
      for (std::uint64_t n = 0; n < element.count; ++n) read_one(element, n, values);
    }
    return std::move(soup_);
  }

 private:
  std::vector<std::string> next_line() {
    const std::size_t end = rest_.find('\n');
    if (end == rest_.npos) throw std::invalid_argument("its header has no line 'end_header'");
    std::vector<std::string> words;
    std::string word;
    for (const char c : rest_.substr(0, end + 1)) {
      if (c != ' ' && c != '\t' && c != '\r' && c != '\n') {
        word += c;
      } else if (!word.empty()) {
        words.push_back(std::move(word));
        word.clear();
      }
    }
    rest_.remove_prefix(end + 1);
    return words;
  }

  void read_header() {
    if (next_line() != std::vector<std::string>{"ply"})
      throw std::invalid_argument("it is no PLY: its first line is not 'ply'");
    bool has_format = false;
    for (auto words = next_line(); words != std::vector<std::string>{"end_header"}; words = next_line()) {
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "format" && words.size() >= 2) {
        is_text_ = words[1] == "ascii", has_format = true;
        if (!is_text_ && words[1] != "binary_little_endian")
          throw std::invalid_argument("its format is '" + words[1] +
                                      "'; it must be ascii or binary_little_endian: save it as one of them");
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
          "its header has a property that is not 'type name' or 'list type type name'");
    return {words.back(), *type, count};
  }

  void read_one(const Element& element, std::uint64_t n, Values& values) {
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    Vec3 x = Vec3::Zero();
    corners_.clear();
    for (const Property& p : element.properties) {
      if (p.count) {
        const bool wanted = is_face && (p.name == "vertex_indices" || p.name == "vertex_index");
        const std::uint32_t count = values.next_index(*p.count);
        for (std::uint32_t k = 0; k < count; ++k) {
          if (wanted)
            corners_.push_back(values.next_index(p.type));
          else
            values.next(p.type);
        }
      } else {
        const double value = values.next(p.type);
        if (is_vertex && p.name.size() == 1 && p.name[0] >= 'x' && p.name[0] <= 'z')
          x[p.name[0] - 'x'] = value;
      }
    }
    if (is_vertex) soup_.points.push_back(x);
    if (is_face) add_polygon(soup_, corners_, "face " + std::to_string(n));
    if (is_vertex && !x.allFinite())
      throw std::invalid_argument("vertex " + std::to_string(n) + " has a coordinate that is not finite");
  }

  std::string_view rest_;
  bool is_text_ = false;
  std::vector<Element> elements_;
  Soup soup_;
  std::vector<std::uint32_t> corners_;
};

}  // namespace

Soup ply_triangles(std::string_view bytes) {
  return PlyReader(bytes).read();
}

}  // namespace silt::adapters
