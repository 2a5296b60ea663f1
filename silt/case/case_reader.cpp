#include "silt/case/case_reader.hpp"

#include <algorithm>
#include <cmath>

#include "silt/case/case_file.hpp"

namespace silt {
namespace {

Place place_of(const Node& node) {
  return node.key.empty() ? node.place : node.key_place;
}

std::string found(const Node& node) {
  using Kind = Node::Kind;
  if (node.kind == Kind::string) return fmt::format("the string {}", written(node));
  if (node.kind == Kind::table || node.kind == Kind::date) return std::string(kind_name(node.kind));
  return written(node);
}

/// Returns the replacement for a key of gravity in another place or form.
std::string gravity_from(const Node& node) {
  std::string value = "[x, y, z]";
  if (node.numbers(3)) value = written(node);
  if (node.is_number()) value = fmt::format("[0, 0, {}]", shown(-std::abs(node.number())));
  return fmt::format("write gravity.acceleration = {}", value);
}

/// Returns "key 'edges' in [shapes] does not go with type = "sphere"" for a key of another type of that
/// table, else "unknown key 'edges' in [shapes]".
std::string unknown(const Node& table, const std::string& path, const std::string& key) {
  const Node* const type = table.find("type");
  const auto has_key = [&](const KeySection& section) {
    return section.path == path && std::ranges::count(section.keys, key, &KeyText::name) > 0;
  };
  if (type && type->kind == Node::Kind::string && std::ranges::any_of(case_keys(), has_key))
    return fmt::format("key '{}' in [{}] does not go with type = \"{}\"", key, path, type->string);
  return fmt::format("unknown key '{}' {}", key,
                     path.empty() ? "at the top of the file" : "in [" + path + "]");
}

bool is_gravity(const Node& node) {
  return node.key == "gravity" || node.key == "g";
}

/// Returns the path of a child without indices: entries have the path of their array.
std::string path_of_child(const Node& node, const std::string& path, const Node& child) {
  if (node.kind == Node::Kind::array) return path;
  return path.empty() ? child.key : path + "." + child.key;
}

}  // namespace

bool Range::holds(double x) const {
  return (low_allowed ? x >= low : x > low) && (high_allowed ? x <= high : x < high);
}

std::string Range::text() const {
  std::vector<std::string> sides;
  if (std::isfinite(low)) sides.push_back((low_allowed ? "at least " : "above ") + shown(low));
  if (std::isfinite(high)) sides.push_back((high_allowed ? "at most " : "below ") + shown(high));
  if (sides.size() == 2 && low_allowed) return fmt::format("between {} and {}", shown(low), shown(high));
  return sides.empty() ? "a finite number" : joined(sides, " and ");
}

void ReadContext::report_unread(const Node& table, const std::string& path) {
  const auto asked = unjudged.count(&table) ? known_keys.end() : known_keys.find(&table);
  const auto is_known = [&](const std::string& key) {
    return asked != known_keys.end() && std::ranges::count(asked->second, key) > 0;
  };
  for (const Node& child : table.children) {
    const bool element = table.kind == Node::Kind::array;
    const std::string child_path = path_of_child(table, path, child);
    if (!element && asked != known_keys.end() && !is_known(child.key)) {
      fail(child.key_place, "{}{}", unknown(table, path, child.key),
           is_gravity(child) && path != "gravity" ? "; " + gravity_from(child)
                                                  : suggestion(child.key, asked->second));
    } else if (!child.children.empty()) {
      report_unread(child, child_path);
    }
  }
}

TableReader::TableReader(ReadContext& context, const Node* table, std::string path, Place place)
    : context_(&context), table_(table), path_(std::move(path)), place_(std::move(place)) {
  if (table_) context_->known_keys[table_];
  if (table_) context_->places[path_] = place_;
}

std::string TableReader::path(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

const Node* TableReader::find(std::string_view key) {
  if (!table_) return nullptr;
  auto& known = context_->known_keys[table_];
  if (std::ranges::find(known, key) == known.end()) known.emplace_back(key);
  const Node* node = table_->find(key);
  if (node) context_->places[path(key)] = place_of(*node);
  return node;
}

Place TableReader::place(std::string_view key) const {
  const Node* node = table_ ? table_->find(key) : nullptr;
  return node ? place_of(*node) : place_;
}

std::string TableReader::filled(std::string_view text, std::string_view key) const {
  return fmt::format(fmt::runtime(text), fmt::arg("key", path(key)), fmt::arg("table", path_));
}

void TableReader::refuse_given(std::initializer_list<const char*> keys, std::string_view text) {
  for (const char* key : keys)
    if (has(key)) fail(key, "{}", filled(text, key));
}

void TableReader::need(std::string_view key, std::string_view what) {
  if (!has(key)) context_->fail(place_, "{} is missing: {}", path(key), what);
}

void TableReader::refuse(std::string_view key, std::string_view must) {
  const Node* node = find(key);
  fail(key, "{} is {}; it must be {}", path(key), node ? found(*node) : "absent", must);
}

std::optional<double> TableReader::number(std::string_view key, const Range& range) {
  const Node* node = find(key);
  if (!node) return {};
  if (!node->is_number())
    refuse(key, range.text() == "a finite number" ? range.text() : "a number " + range.text());
  else if (!std::isfinite(node->number()))
    refuse(key, "a finite number");
  else if (!range.holds(node->number()))
    refuse(key, range.text());
  else
    return node->number();
  return {};
}

std::optional<double> TableReader::quantity(std::string_view key, Dimension dimension, const Range& range) {
  const auto x = number(key, range);
  return x ? std::optional(context_->units.lattice(*x, dimension)) : x;
}

std::optional<rigid::Vec3> TableReader::vector(const Node& node, const std::string& path) {
  if (const auto x = node.numbers(3)) return rigid::Vec3(x->data());
  context_->fail(place_of(node), "{} is {}; it must be three finite numbers, [x, y, z]", path, found(node));
  return {};
}

std::optional<rigid::Vec3> TableReader::vector(std::string_view key, Dimension dimension) {
  const Node* node = find(key);
  auto v = node ? vector(*node, path(key)) : std::nullopt;
  if (v) *v /= context_->units.scale(dimension);
  return v;
}

std::vector<rigid::Vec3> TableReader::points(std::string_view key, std::size_t least, std::size_t most,
                                             std::string_view must) {
  const Node* node = find(key);
  std::vector<rigid::Vec3> points;
  if (!node) return points;
  const std::size_t count = node->children.size();
  if (node->kind != Node::Kind::array || count < least || count > most) {
    refuse(key, must);
    return points;
  }
  for (std::size_t i = 0; i < count; ++i)
    if (const auto x = vector(node->children[i], fmt::format("{}[{}]", path(key), i)))
      points.push_back(*x / context_->units.cell_size);
  if (points.size() < count) points.clear();
  return points;
}

std::optional<rigid::BoundingBox> TableReader::box(std::string_view key, bool may_be_flat) {
  const auto corners = points(key, 2, 2, "two corners, [[x, y, z], [x, y, z]]");
  if (corners.size() != 2) return {};
  const double least = (corners[1] - corners[0]).minCoeff();
  if (least > 0 || (may_be_flat && least == 0)) return rigid::BoundingBox{corners[0], corners[1]};
  refuse(key, "two corners, [lower, upper], the upper above the lower in each direction");
  return {};
}

/// Returns an integer, which may be written as 1e3.
static std::optional<std::int64_t> whole_number(const Node& node) {
  constexpr double exact = 0x1p53;  // beyond it, not all integers are doubles
  if (node.kind == Node::Kind::integer) return node.integer;
  const bool is_whole = node.kind == Node::Kind::floating && std::fabs(node.floating) <= exact &&
                        node.floating == std::trunc(node.floating);
  return is_whole ? std::optional(static_cast<std::int64_t>(node.floating)) : std::nullopt;
}

std::optional<std::int64_t> TableReader::integer(std::string_view key, std::int64_t low, std::int64_t high,
                                                 std::string_view unit) {
  const Node* node = find(key);
  if (!node) return {};
  const std::optional<std::int64_t> found = whole_number(*node);
  if (found && *found >= low && *found <= high) return found;
  const std::string range = high == std::numeric_limits<std::int64_t>::max()
                                ? fmt::format("of at least {}", low)
                                : fmt::format("between {} and {}", low, high);
  refuse(key, fmt::format("a whole number {}{}", range, unit.empty() ? "" : fmt::format(" ({})", unit)));
  return {};
}

std::optional<bool> TableReader::boolean(std::string_view key) {
  const Node* node = find(key);
  if (!node) return {};
  if (node->kind == Node::Kind::boolean) return node->boolean;
  refuse(key, "true or false");
  return {};
}

std::optional<std::string> TableReader::string(std::string_view key) {
  const Node* node = find(key);
  if (!node) return {};
  if (node->kind == Node::Kind::string && !node->string.empty()) return node->string;
  refuse(key, "a string that is not empty");
  return {};
}

std::optional<std::string> TableReader::choice(std::string_view key,
                                               const std::vector<std::string>& allowed) {
  const Node* node = find(key);
  if (!node) return {};
  if (node->kind != Node::Kind::string) {
    refuse(key, "one of " + joined(allowed));
    return {};
  }
  if (std::ranges::count(allowed, node->string)) return node->string;
  const std::string nearest = nearest_name(node->string, allowed);
  refuse(key, "one of " + joined(allowed) + (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  return {};
}

TableReader TableReader::table(std::string_view key) {
  const Node* node = find(key);
  if (node && node->kind != Node::Kind::table) {
    refuse(key, is_gravity(*node) ? "a table: " + gravity_from(*node) : "a table");
    node = nullptr;
  }
  return {*context_, node, path(key), place(key)};
}

std::vector<TableReader> TableReader::tables(std::string_view key) {
  const Node* node = find(key);
  std::vector<TableReader> result;
  if (!node) return result;
  const auto is_table = [](const Node& n) { return n.kind == Node::Kind::table; };
  if (node->kind != Node::Kind::array || !std::ranges::all_of(node->children, is_table)) {
    refuse(key,
           path_.empty() ? fmt::format("an array of tables, written [[{}]]", key) : "an array of tables");
    return result;
  }
  for (const Node& child : node->children)
    result.emplace_back(*context_, &child, fmt::format("{}[{}]", path(key), result.size()), child.place);
  return result;
}

std::string TableReader::one_of(std::initializer_list<const char*> keys, bool required,
                                std::string_view what) {
  std::string given;
  std::vector<std::string> all(keys.begin(), keys.end());
  for (const char* key : keys) {
    if (!has(key)) continue;
    if (!given.empty())
      fail(key, "{} and {} are both given; they set the same quantity, keep one of {}", path(given),
           path(key), joined(all));
    else
      given = key;
  }
  if (given.empty() && required)
    context_->fail(place_, "{} needs one of {}: {}", path_.empty() ? "the case" : "[" + path_ + "]",
                   joined(all), what);
  return given;
}

}  // namespace silt
