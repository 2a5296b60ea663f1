#include "adapters/json/json.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace silt::adapters {
namespace {

/// The length of the valid UTF-8 sequence at the start of s, 0 if there is none (RFC 3629).
std::size_t utf8_length(std::string_view s) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(s[i]); };
  const unsigned char lead = byte(0);
  const std::size_t n = lead < 0x80   ? 1
                        : lead < 0xc2 ? 0
                        : lead < 0xe0 ? 2
                        : lead < 0xf0 ? 3
                        : lead < 0xf5 ? 4
                                      : 0;
  if (n == 0 || s.size() < n) return 0;
  for (std::size_t i = 1; i < n; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  if ((lead == 0xe0 && byte(1) < 0xa0) || (lead == 0xed && byte(1) > 0x9f)) return 0;  // overlong, surrogates
  if ((lead == 0xf0 && byte(1) < 0x90) || (lead == 0xf4 && byte(1) > 0x8f))
    return 0;  // overlong, above U+10FFFF
  return n;
}

void print_string(std::string& out, std::string_view s) {
  out += '"';
  while (!s.empty()) {
    const std::size_t n = utf8_length(s);
    const unsigned char c = static_cast<unsigned char>(s[0]);
    if (n == 0) {
      out += "\xef\xbf\xbd";
    } else if (c == '"' || c == '\\' || c == '\n' || c == '\t') {
      out += '\\';
      out += c == '\n' ? 'n' : c == '\t' ? 't' : s[0];
    } else if (c < 0x20 || c == 0x7f) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", c);
      out += code;
    } else {
      out += s.substr(0, n);
    }
    s.remove_prefix(std::max<std::size_t>(n, 1));
  }
  out += '"';
}

template <class Number>
void print_number(std::string& out, Number x) {
  char text[32];
  out.append(text, std::to_chars(text, text + sizeof text, x).ptr);
}

void new_line(std::string& out, int level) {
  out += '\n';
  out.append(2 * level, ' ');
}

}  // namespace

Json Json::object(std::initializer_list<Member> members) {
  Json j;
  j.value_ = Object(members);
  return j;
}

Json Json::array(std::initializer_list<Json> values) {
  Json j;
  j.value_ = Array(values);
  return j;
}

Json& Json::operator[](std::string_view key) {
  if (std::holds_alternative<std::monostate>(value_)) value_ = Object{};
  auto* members = std::get_if<Object>(&value_);
  if (!members)
    throw std::logic_error("a JSON value that is not an object has no member " + std::string(key));
  for (Member& m : *members)
    if (m.first == key) return m.second;
  return members->emplace_back(key, Json()).second;
}

void Json::push_back(Json value) {
  if (std::holds_alternative<std::monostate>(value_)) value_ = Array{};
  auto* values = std::get_if<Array>(&value_);
  if (!values) throw std::logic_error("a JSON value that is not an array cannot grow");
  values->push_back(std::move(value));
}

std::vector<std::pair<std::string, std::string>> Json::numbers(const std::string& key) const {
  std::vector<std::pair<std::string, std::string>> found;
  if (const auto* members = std::get_if<Object>(&value_))
    for (const Member& m : *members)
      if (m.first == key) m.second.list_numbers(key, found);
  return found;
}

void Json::list_numbers(const std::string& path,
                        std::vector<std::pair<std::string, std::string>>& out) const {
  if (const auto* members = std::get_if<Object>(&value_)) {
    for (const auto& [key, value] : *members) value.list_numbers(path + '.' + key, out);
  } else if (const auto* values = std::get_if<Array>(&value_)) {
    for (std::size_t i = 0; i < values->size(); ++i)
      (*values)[i].list_numbers(
          path + '.' + (values->size() == 3 ? std::string(1, "xyz"[i]) : std::to_string(i)), out);
  } else if (!std::holds_alternative<std::string>(value_) && !std::holds_alternative<bool>(value_)) {
    std::string text;
    print(text, 0);
    out.emplace_back(path, text == "null" ? "" : text);
  }
}

std::string Json::text() const {
  std::string out;
  print(out, 0);
  return out + '\n';
}

void Json::print(std::string& out, int level) const {
  if (const auto* members = std::get_if<Object>(&value_)) {
    out += '{';
    for (const Member& member : *members) {
      if (&member != &members->front()) out += ',';
      new_line(out, level + 1);
      print_string(out, member.first);
      out += ": ";
      member.second.print(out, level + 1);
    }
    if (!members->empty()) new_line(out, level);
    out += '}';
  } else if (const auto* values = std::get_if<Array>(&value_)) {
    const bool one_line =
        std::all_of(values->begin(), values->end(), [](const Json& v) { return v.is_plain(); });
    out += '[';
    for (std::size_t i = 0; i < values->size(); ++i) {
      if (i > 0) out += one_line ? ", " : ",";
      if (!one_line) new_line(out, level + 1);
      (*values)[i].print(out, level + 1);
    }
    if (!one_line) new_line(out, level);
    out += ']';
  } else if (const auto* s = std::get_if<std::string>(&value_)) {
    print_string(out, *s);
  } else if (const auto* b = std::get_if<bool>(&value_)) {
    out += *b ? "true" : "false";
  } else if (const auto* i = std::get_if<std::int64_t>(&value_)) {
    print_number(out, *i);
  } else if (const auto* u = std::get_if<std::uint64_t>(&value_)) {
    print_number(out, *u);
  } else if (const auto* d = std::get_if<double>(&value_); d && std::isfinite(*d)) {
    print_number(out, *d);
  } else {
    out += "null";
  }
}

}  // namespace silt::adapters
