#pragma once
// Typed access to the tables of a case file that keeps account of who read what: every key asked for becomes
// a known key of its table, and a key that nobody asked for is an error. Nothing here throws; errors are
// collected. Below, tables of keys: one reader fills a spec by them, and says what is wrong with a key or
// missing; the page cases/README.md, `silt keys` and the completion of the shell have the same rows.
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

/// An interval of the numbers that a key may have.
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

/// Holds what the readers of all sections share.
struct ReadContext {
  std::string file;
  CaseSource* source = nullptr;    // of the files that the case names
  std::vector<std::string> files;  // that the case names: AttachedFile::fingerprint of each, in its order
  Units units;
  bool units_known = true;  // else nothing that depends on a scale is judged
  std::vector<Diagnostic> errors, warnings;
  std::map<const Node*, std::vector<std::string>>
      known_keys;                       // of each table, in the order they were asked for
  std::set<const Node*> unjudged;       // tables whose unread keys are no errors
  std::map<std::string, Place> places;  // of each key found, by its path

  template <class... T>
  void fail(const Place& place, fmt::format_string<T...> text, T&&... values) {
    errors.push_back({Diagnostic::Severity::error, place, fmt::format(text, std::forward<T>(values)...)});
  }
  /// Reports an error for every key below the table that no reader asked for.
  void report_unread(const Node& table, const std::string& path);
};

/// Reads one table (or the absence of one: then every key is absent).
class TableReader {
 public:
  TableReader(ReadContext&, const Node* table, std::string path, Place);

  bool present() const { return table_ != nullptr; }
  const std::string& path() const { return path_; }
  std::string path(std::string_view key) const;  // "fluid.density"
  ReadContext& context() const { return *context_; }

  /// Marks the key as known; nullptr if it is not there.
  const Node* find(std::string_view key);
  bool has(std::string_view key) { return find(key) != nullptr; }
  Place place(std::string_view key) const;  // of the key, or of the table if it is not there

  /// Returns the number as it stands; none if absent, of another type, not finite or out of range (reported).
  std::optional<double> number(std::string_view key, const Range&);
  /// Returns the number in lattice units; it stands, as does its range, in the units of the case.
  std::optional<double> quantity(std::string_view key, Dimension, const Range&);
  std::optional<rigid::Vec3> vector(std::string_view key, Dimension = dimension::none);
  /// Returns a box by its lower and upper corner, which are equal along an axis only if it may be flat.
  std::optional<rigid::BoundingBox> box(std::string_view key, bool may_be_flat = false);
  /// Returns a list of points in lattice units; none (reported) if one is wrong or their number is.
  std::vector<rigid::Vec3> points(std::string_view key, std::size_t least, std::size_t most,
                                  std::string_view must);
  std::optional<std::int64_t> integer(std::string_view key, std::int64_t low,
                                      std::int64_t high = std::numeric_limits<std::int64_t>::max(),
                                      std::string_view unit = "");
  std::optional<bool> boolean(std::string_view key);
  std::optional<std::string> string(std::string_view key);
  /// Returns a string out of a list; the nearest is named if it is another.
  std::optional<std::string> choice(std::string_view key, const std::vector<std::string>& allowed);
  /// Returns the value of an enum by its name.
  template <class Enum, std::size_t count>
  std::optional<Enum> choice(std::string_view key, const coupler::NameTable<Enum, count>& table) {
    const auto name = choice(key, table.list());
    for (std::size_t i = 0; name && i < count; ++i)
      if (table.names[i] == *name) return static_cast<Enum>(i);
    return {};
  }

  TableReader table(std::string_view key);
  std::vector<TableReader> tables(std::string_view key);  // of an array of tables

  /// Leaves open what the other keys mean (under an unknown type): none of them is called unknown.
  void judge_no_keys() { context_->unjudged.insert(table_); }

  /// Reports a key that must be there and is not; `what` says what it stands for.
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
  /// Returns a text with the paths of a key and of this table in the place of {key} and {table}.
  std::string filled(std::string_view text, std::string_view key) const;
  /// Reports each of the keys that is given: the text, filled, says why it may not be.
  void refuse_given(std::initializer_list<const char*> keys, std::string_view text);
  /// Warns of a key that is there and does nothing; `why` says what switches it off.
  void idle(std::string_view key, std::string_view why) {
    if (has(key)) warn(key, "{} has no effect: {}", path(key), why);
  }
  /// Requires that exactly one (or, unless required, at most one) of the keys is given; returns the one, or
  /// "".
  std::string one_of(std::initializer_list<const char*> keys, bool required, std::string_view what);

 private:
  /// Returns an array of three numbers; none (reported under the given name) otherwise.
  std::optional<rigid::Vec3> vector(const Node&, const std::string& path);

  ReadContext* context_;
  const Node* table_;
  std::string path_;
  Place place_;
};

// The keys of a section of a case as a table, a row a key: the member of a spec that it fills, what it may
// be, what it means, its default, and when it does nothing, may not or must be given.

inline constexpr const char* required = "–";  // in the place of a default: the key must be given

/// Returns the unit in SI as the page writes it: "m²/s", "1" of a number.
std::string unit_on_page(Dimension);

// A kind of value knows how it is read, what the page says of it, and how a default is written.
struct Number {
  Dimension dimension = dimension::none;
  Range range = range::any;
  const char* unit = nullptr;  // where the dimension does not say it
  auto read(TableReader& table, const char* key) const { return table.quantity(key, dimension, range); }
  std::string type() const { return "number"; }
  std::string unit_text() const { return unit ? unit : unit_on_page(dimension); }
  static std::string text(double x) { return shown(x); }
};
struct Vector {
  Dimension dimension = dimension::none;
  auto read(TableReader& table, const char* key) const { return table.vector(key, dimension); }
  std::string type() const { return "[x, y, z]"; }
  std::string unit_text() const { return unit_on_page(dimension); }
  static std::string text(const rigid::Vec3& x) { return x.isZero(0) ? "0" : "given"; }
};
/// A box by two corners.
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
  static std::string text(const std::string& s) { return s; }
};
template <class Enum, std::size_t count>
struct Choice {
  coupler::NameTable<Enum, count> names;
  auto read(TableReader& table, const char* key) const { return table.choice(key, names); }
  std::string type() const { return '"' + joined(names.list(), "\", \"") + '"'; }
  std::string text(Enum value) const { return '"' + std::string(names[value]) + '"'; }
};

enum class If { idle, refused, needed };
/// What a key asks of the others of its table, once they are read: where it holds of the spec, the key does
/// nothing, may not be given, or must be. The text names the remedy; {key} and {table} in it are paths.
template <class Test>
struct Rule {
  If means;
  Test holds;
  const char* text = "";
};
/// The same of the whole case: where it holds, the key does nothing.
struct IdleInCase {
  bool (*in)(const Case&);
  const char* text;
};
/// Holds where a member is 0.
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
  const char* fallback = nullptr;  // null: what the member is in a spec that nobody has filled
  First rule = {};
  Second second_rule = {};
};

/// A key that its section reads by hand.
template <class First = NoRule, class Second = NoRule>
struct HandKey {
  const char *name, *type, *unit, *fallback, *meaning;
  First rule = {};
  Second second_rule = {};
};

/// Returns a spec that nobody has filled.
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

/// Reports a key that must be there and is not.
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

/// Fills a spec with what a table has of its keys, and judges them by their rules; those read by hand become
/// known, and are reported if they are missing.
template <class Spec, class... Keys>
void read_keys(TableReader& table, Spec& spec, const std::tuple<Keys...>& keys) {
  if (!table.present()) return;
  std::apply([&](const auto&... key) { (read_key(table, spec, key), ...); }, keys);
  std::apply([&](const auto&... key) { (judge_key(table, spec, key, key.rule), ...); }, keys);
  std::apply([&](const auto&... key) { (judge_key(table, spec, key, key.second_rule), ...); }, keys);
}

/// Returns the rows of the tables of keys that a section has, one after the other.
template <class... Tables>
KeySection section_of(const char* path, const Tables&... tables) {
  KeySection section{path, {}};
  std::apply([&](const auto&... key) { (section.keys.push_back(text_of(key)), ...); },
             std::tuple_cat(tables...));
  return section;
}

}  // namespace silt
