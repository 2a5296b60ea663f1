#pragma once
// Typed access to the tables of a case file. Every key that a reader asks for becomes a known key of its
// table; a key that none asks for is an error. Errors are collected, nothing is thrown. Below are tables of
// keys: one reader fills a spec from such a table and reports wrong or missing keys; cases/README.md, `silt
// keys` and the completion of the shell have the same rows.
#include <fmt/format.h>

#include <initializer_list>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "rigid/math/types.hpp"
#include "silt/case/case_file.hpp"

namespace silt {

using adapters::Node;

/// The allowed values of a key.
struct Range {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool low_allowed = true, high_allowed = true;

  bool holds(double x) const;
  std::string text() const;  // "above 0", "at least 0", "between 0 and 1"
};
namespace range {
inline constexpr Range any{};
inline constexpr Range above(double low) {
  return {low, any.high, false, true};
}
inline constexpr Range at_least(double low) {
  return {low, any.high, true, true};
}
inline constexpr Range between(double low, double high) {
  return {low, high, true, true};
}
}  // namespace range

/// The data shared by the readers of all sections.
struct ReadContext {
  std::string file;
  CaseSource* source = nullptr;    // of files that the case names
  std::vector<std::string> files;  // AttachedFile::fingerprint of each, in order
  Units units;
  bool units_known = true;  // else values with scales are not checked
  std::vector<Diagnostic> errors, warnings;
  std::map<const Node*, std::vector<std::string>>
      known_keys;                       // of each table, in the order in which readers asked for them
  std::set<const Node*> unjudged;       // tables with keys that may be unknown
  std::map<std::string, Place> places;  // of each key found, by path

  template <class... T>
  void fail(const Place& place, fmt::format_string<T...> text, T&&... values) {
    errors.push_back({Diagnostic::Severity::error, place, fmt::format(text, std::forward<T>(values)...)});
  }
  /// Reports an error for every key below the table that no reader requested.
  void report_unread(const Node& table, const std::string& path);
};

/// Reads one table, or an absent one without keys.
class TableReader {
 public:
  TableReader(ReadContext&, const Node* table, std::string path, Place);

  bool present() const { return table_ != nullptr; }
  const std::string& path() const { return path_; }
  std::string path(std::string_view key) const;  // "fluid.density"
  ReadContext& context() const { return *context_; }

  /// Returns the node of a key, or nullptr; makes the key known.
  const Node* find(std::string_view key);
  bool has(std::string_view key) { return find(key) != nullptr; }
  Place place(std::string_view key) const;  // of the key, or of the table if absent

  /// Returns a number as written; none if absent, or if not a finite number in range (reported).
  std::optional<double> number(std::string_view key, const Range&);
  /// Returns a number in lattice units; number and range are in units of the case.
  std::optional<double> quantity(std::string_view key, Dimension, const Range&);
  std::optional<rigid::Vec3> vector(std::string_view key, Dimension = dimension::none);
  /// Returns a box from its lower and upper corner, which may be equal along an axis only if it may be flat.
  std::optional<rigid::BoundingBox> box(std::string_view key, bool may_be_flat = false);
  /// Returns a list of points in lattice units; empty (reported) if a point or their number is wrong.
  std::vector<rigid::Vec3> points(std::string_view key, std::size_t least, std::size_t most,
                                  std::string_view must);
  std::optional<std::int64_t> integer(std::string_view key, std::int64_t low,
                                      std::int64_t high = std::numeric_limits<std::int64_t>::max(),
                                      std::string_view unit = "");
  std::optional<bool> boolean(std::string_view key);
  std::optional<std::string> string(std::string_view key);
  /// Returns a string of a list; otherwise reports an error with the nearest one.
  std::optional<std::string> choice(std::string_view key, const std::vector<std::string>& allowed);
  /// Returns an enumerator by its name.
  template <class Enum, std::size_t count>
  std::optional<Enum> choice(std::string_view key, const coupler::NameTable<Enum, count>& table) {
    const auto name = choice(key, table.list());
    for (std::size_t i = 0; name && i < count; ++i)
      if (table.names[i] == *name) return static_cast<Enum>(i);
    return {};
  }

  TableReader table(std::string_view key);
  std::vector<TableReader> tables(std::string_view key);  // of an array of tables

  /// Accepts unknown keys, e.g. below an unknown type.
  void judge_no_keys() { context_->unjudged.insert(table_); }

  /// Reports a missing key; `what` describes it.
  void need(std::string_view key, std::string_view what);
  /// Reports "fluid.density is -1; it must be above 0".
  void refuse(std::string_view key, std::string_view must);
  template <class... T>
  void fail(std::string_view key, fmt::format_string<T...> text, T&&... values) {
    context_->fail(place(key), text, std::forward<T>(values)...);
  }
  template <class... T>
  void warn(std::string_view key, fmt::format_string<T...> text, T&&... values) {
    context_->warnings.push_back(
        {Diagnostic::Severity::warning, place(key), fmt::format(text, std::forward<T>(values)...)});
  }
  /// Replaces {key} and {table} in a text by their paths.
  std::string filled(std::string_view text, std::string_view key) const;
  /// Reports each of the keys that is given; the text, filled, says why it is not allowed.
  void refuse_given(std::initializer_list<const char*> keys, std::string_view text);
  /// Warns of a key without effect; `why` says what switches it off.
  void idle(std::string_view key, std::string_view why) {
    if (has(key)) warn(key, "{} has no effect: {}", path(key), why);
  }
  /// Requires that exactly one of the keys (or, unless required, at most one) is given; returns it, or "".
  std::string one_of(std::initializer_list<const char*> keys, bool required, std::string_view what);

 private:
  /// Returns an array of three numbers, or none (reported with `path`).
  std::optional<rigid::Vec3> vector(const Node&, const std::string& path);

  ReadContext* context_;
  const Node* table_;
  std::string path_;
  Place place_;
};

// The keys of a section as a table, one row per key: member of a spec, allowed values, meaning, default, and
// when it has no effect, is not allowed or is required.

inline constexpr const char* required = "–";  // as a default: the key is required

/// Returns an SI unit as on the page: "m²/s", or "1" of a number.
std::string unit_on_page(Dimension);

// A kind of value defines how it is read, its description on the page, and how a default is written.
struct Number {
  Dimension dimension = dimension::none;
  Range range = range::any;
  const char* unit = nullptr;  // if the dimension does not give it
  auto read(TableReader& table, const char* key) const { return table.quantity(key, dimension, range); }
  std::string type() const { return "number"; }
  std::string unit_text() const { return unit ? unit : unit_on_page(dimension); }
  static std::string text(double x) { return shown(x); }
};
struct Vector {
  Dimension dimension = dimension::none;
  const char* unit = nullptr;  // if the dimension does not give it
  auto read(TableReader& table, const char* key) const { return table.vector(key, dimension); }
  std::string type() const { return "[x, y, z]"; }
  std::string unit_text() const { return unit ? unit : unit_on_page(dimension); }
  static std::string text(const rigid::Vec3& x) { return x.isZero(0) ? "0" : "given"; }
};
/// A box, by two corners.
struct Corners {
  auto read(TableReader& table, const char* key) const { return table.box(key); }
  std::string type() const { return "[[x, y, z], [x, y, z]]"; }
  std::string unit_text() const { return "m"; }
};
struct Whole {
  std::int64_t low = 0, high = std::numeric_limits<std::int64_t>::max();
  const char* unit = "";
  auto read(TableReader& table, const char* key) const { return table.integer(key, low, high, unit); }
  std::string type() const { return "integer"; }
  std::string unit_text() const { return unit; }
  static std::string text(std::int64_t n) { return std::to_string(n); }
};
struct Flag {
  auto read(TableReader& table, const char* key) const { return table.boolean(key); }
  std::string type() const { return "boolean"; }
  static std::string text(bool b) { return b ? "true" : "false"; }
};
struct Text {
  auto read(TableReader& table, const char* key) const { return table.string(key); }
  std::string type() const { return "string"; }
};
template <class Enum, std::size_t count>
struct Choice {
  coupler::NameTable<Enum, count> names;
  auto read(TableReader& table, const char* key) const { return table.choice(key, names); }
  std::string type() const { return '"' + joined(names.list(), "\", \"") + '"'; }
  std::string text(Enum value) const { return '"' + std::string(names[value]) + '"'; }
};

enum class If { idle, refused, needed };
/// The dependence of a key on the rest of its table: if `holds` is true for the spec, the key has no effect,
/// is not allowed, or is required. The text gives the remedy; {key} and {table} stand for paths.
template <class Test>
struct Rule {
  If means;
  Test holds;
  const char* text = "";
};
/// The same for the whole case: if true, the key has no effect.
struct IdleInCase {
  bool (*in)(const Case&);
  const char* text;
};
/// Is true if a member is 0.
template <class Spec, class Member>
constexpr auto is_zero(Member Spec::*member) {
  return [member](const Spec& spec) { return spec.*member == 0. * (spec.*member); };
}

struct NoRule {};
template <class Spec, class Member, class Kind, class First = NoRule, class Second = NoRule>
struct Key {
  const char* name;
  Member Spec::*member;
  Kind kind;
  const char* meaning;
  const char* fallback = nullptr;  // null: the member's value in a new spec
  First rule = {};
  Second second_rule = {};
};

/// A key that its section reads by other code.
template <class First = NoRule, class Second = NoRule>
struct HandKey {
  const char *name, *type, *unit, *fallback, *meaning;
  First rule = {};
  Second second_rule = {};
};

/// Returns a new spec.
template <class Spec>
const Spec& blank_of() {
  static const Spec blank;
  return blank;
}

template <class Spec, class Member, class Kind, class... Rules>
KeyText text_of(const Key<Spec, Member, Kind, Rules...>& key) {
  KeyText text{key.name, key.kind.type(), "", "", key.meaning};
  if constexpr (requires { key.kind.unit_text(); }) text.unit = key.kind.unit_text();
  if (key.fallback)
    text.fallback = key.fallback;
  else if constexpr (requires { key.kind.text(Member{}); })
    text.fallback = key.kind.text(blank_of<Spec>().*key.member);
  return text;
}
template <class... Rules>
KeyText text_of(const HandKey<Rules...>& key) {
  return {key.name, key.type, key.unit, key.fallback, key.meaning};
}

/// Reports a required key that is missing.
template <class AnyKey>
void require(TableReader& table, const AnyKey& key) {
  if (key.fallback && std::string_view(key.fallback) == required) table.need(key.name, key.meaning);
  table.find(key.name);
}

template <class Spec, class AnyKey>
void read_key(TableReader& table, Spec& spec, const AnyKey& key) {
  require(table, key);
  if constexpr (requires { key.member; })
    if (const auto value = key.kind.read(table, key.name))
      spec.*key.member = std::remove_cvref_t<decltype(spec.*key.member)>(*value);
}

template <class Spec, class AnyKey, class AnyRule>
void judge_key(TableReader& table, const Spec& spec, const AnyKey& key, const AnyRule& rule) {
  if constexpr (requires { rule.holds; }) {
    if (!rule.holds(spec)) return;
    if (rule.means == If::idle) table.idle(key.name, table.filled(rule.text, key.name));
    if (rule.means == If::refused) table.refuse_given({key.name}, rule.text);
    if (rule.means == If::needed) table.need(key.name, key.meaning);
  }
}

/// Fills a spec from a table of keys and checks their rules. Keys read by other code become known, and are
/// reported if missing.
template <class Spec, class... Keys>
void read_keys(TableReader& table, Spec& spec, const std::tuple<Keys...>& keys) {
  if (!table.present()) return;
  std::apply([&](const auto&... key) { (read_key(table, spec, key), ...); }, keys);
  std::apply([&](const auto&... key) { (judge_key(table, spec, key, key.rule), ...); }, keys);
  std::apply([&](const auto&... key) { (judge_key(table, spec, key, key.second_rule), ...); }, keys);
}

/// Returns the rows of the key tables of a section.
template <class... Tables>
KeySection section_of(const char* path, const Tables&... tables) {
  KeySection section{path, {}};
  std::apply([&](const auto&... key) { (section.keys.push_back(text_of(key)), ...); },
             std::tuple_cat(tables...));
  return section;
}

}  // namespace silt
