#include "adapters/toml/document.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

// toml++ 3.3 asserts at a header such as "[.a]" and is undefined without assertions; here they throw.
namespace {
struct TomlAssertion : std::logic_error {
  using std::logic_error::logic_error;
};
[[noreturn]] void throw_assertion(const char* condition) {
  throw TomlAssertion(condition);
}
}  // namespace
#undef NDEBUG
#define TOML_ASSERT(condition) ((condition) ? static_cast<void>(0) : throw_assertion(#condition))
#include <toml++/toml.h>

namespace silt::adapters {
namespace {

Place place_of(const ::toml::source_region& region, const std::string& file) {
  return {file, int(region.begin.line), int(region.begin.column)};
}

bool stands_before(const Node& a, const Node& b) {
  return std::pair(a.key_place.line, a.key_place.column) < std::pair(b.key_place.line, b.key_place.column);
}

Node converted(const ::toml::node& node, const std::string& file) {
  Node result;
  result.kind = Node::Kind::date;
  result.place = place_of(node.source(), file);
  if (const auto* table = node.as_table()) {
    result.kind = Node::Kind::table;
    for (const auto& [key, value] : *table) {
      Node child = converted(value, file);
      child.key = std::string(key.str());
      child.key_place = place_of(key.source(), file);
      result.children.push_back(std::move(child));
    }
    std::stable_sort(result.children.begin(), result.children.end(), stands_before);
  } else if (const auto* array = node.as_array()) {
    result.kind = Node::Kind::array;
    for (const auto& value : *array) result.children.push_back(converted(value, file));
  } else if (const auto* string = node.as_string()) {
    result.kind = Node::Kind::string, result.string = string->get();
  } else if (const auto* integer = node.as_integer()) {
    result.kind = Node::Kind::integer, result.integer = integer->get();
  } else if (const auto* floating = node.as_floating_point()) {
    result.kind = Node::Kind::floating, result.floating = floating->get();
  } else if (const auto* boolean = node.as_boolean()) {
    result.kind = Node::Kind::boolean, result.boolean = boolean->get();
  }
  return result;
}

std::string written_number(double x) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, x).ptr;
  return {buffer, end};
}

}  // namespace

std::string Place::text() const {
  if (line == 0) return file;
  return file + ":" + std::to_string(line) + ":" + std::to_string(column);
}

const Node* Node::find(std::string_view wanted) const {
  for (const Node& child : children)
    if (kind == Kind::table && child.key == wanted) return &child;
  return nullptr;
}

Node* Node::find(std::string_view wanted) {
  return const_cast<Node*>(static_cast<const Node*>(this)->find(wanted));
}

std::optional<std::vector<double>> Node::numbers(std::size_t count) const {
  std::vector<double> found;
  for (const Node& child : children)
    if (child.is_number() && std::isfinite(child.number())) found.push_back(child.number());
  const bool all = kind == Kind::array && children.size() == count && found.size() == count;
  return all ? std::optional(found) : std::nullopt;
}

std::optional<std::vector<std::string>> Node::strings() const {
  std::vector<std::string> found;
  for (const Node& child : children)
    if (child.kind == Kind::string) found.push_back(child.string);
  const bool all = kind == Kind::array && !found.empty() && found.size() == children.size();
  return all ? std::optional(found) : std::nullopt;
}

std::string_view kind_name(Node::Kind kind) {
  constexpr std::string_view names[] = {"a table",  "an array",  "a string",      "an integer",
                                        "a number", "a boolean", "a date or time"};
  return names[std::size_t(kind)];
}

std::string written(const Node& node) {
  switch (node.kind) {
    case Node::Kind::table:
      return "{ ... }";
    case Node::Kind::string:
      return '"' + node.string + '"';
    case Node::Kind::integer:
      return std::to_string(node.integer);
    case Node::Kind::floating:
      return written_number(node.floating);
    case Node::Kind::boolean:
      return node.boolean ? "true" : "false";
    case Node::Kind::date:
      return std::string(kind_name(node.kind));
    case Node::Kind::array:
      break;
  }
  constexpr std::size_t longest = 6;
  std::string text = "[";
  for (std::size_t i = 0; i < std::min(node.children.size(), longest); ++i)
    text += (i ? ", " : "") + written(node.children[i]);
  return text + (node.children.size() > longest ? ", ...]" : "]");
}

namespace {

// Returns the line, from 1, at which the parser meets an assertion: the first that breaks the text up to it.
int asserting_line(std::string_view text) {
  int line = 0;
  for (std::size_t end = 0; end != text.npos;) {
    ++line;
    end = text.find('\n', end);
    if (end != text.npos) ++end;
    try {
      (void)::toml::parse(text.substr(0, end));
    } catch (const ::toml::parse_error&) {
    } catch (const TomlAssertion&) {
      return line;
    }
  }
  return line;
}

/// Returns the position after the string that begins with the quote at `at`, at most the end of the text.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string three(3, quote);
  const std::string end = text.substr(at, 3) == three ? three : std::string(1, quote);
  for (at += end.size(); at < text.size() && text.substr(at, end.size()) != end; ++at)
    if (quote == '"' && text[at] == '\\') ++at;
  return std::min(at + end.size(), text.size());
}

/// Throws SyntaxError with its place for a letter beyond ASCII outside strings and comments, as in "[0,é 0]",
/// where toml++ has undefined behaviour.
void require_ascii_outside_strings(std::string_view text, const std::string& file) {
  int line = 1;
  std::size_t line_begin = 0;
  const auto pass = [&](std::size_t begin, std::size_t end) {
    for (; begin < end; ++begin)
      if (text[begin] == '\n') ++line, line_begin = begin + 1;
    return end;
  };
  const std::size_t mark = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  for (std::size_t at = mark; at < text.size();) {
    if (static_cast<unsigned char>(text[at]) >= 0x80)
      throw SyntaxError({file, line, int(at - line_begin) + 1},
                        "letters beyond ASCII may stand in strings and comments only");
    if (text[at] == '"' || text[at] == '\'')
      at = pass(at, end_of_string(text, at));
    else if (text[at] == '#')
      at = std::min(text.find('\n', at), text.size());
    else
      at = pass(at, at + 1);
  }
}

void stamp(Node& node, const Place& place) {
  node.place = node.key_place = place;
  for (Node& child : node.children) stamp(child, place);
}

}  // namespace

Node parse_document(std::string_view text, const std::string& file) {
  require_ascii_outside_strings(text, file);
  try {
    return converted(::toml::parse(text, file), file);
  } catch (const ::toml::parse_error& error) {
    throw SyntaxError(place_of(error.source(), file), std::string(error.description()));
  } catch (const TomlAssertion&) {
    throw SyntaxError({file, asserting_line(text), 1},
                      "this line cannot be read; a table is written [name], a list entry [[name]]");
  }
}

Node parse_value(std::string_view text, const Place& place) {
  try {
    require_ascii_outside_strings(text, place.file);
    const auto table = ::toml::parse("value = " + std::string(text));
    Node node = converted(*table.get("value"), place.file);
    stamp(node, place);
    return node;
  } catch (const ::toml::parse_error& error) {
    throw SyntaxError(place, std::string(error.description()));
  } catch (const TomlAssertion&) {
    throw SyntaxError(place, "it cannot be read");
  }
}

}  // namespace silt::adapters
