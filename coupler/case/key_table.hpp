#pragma once
// The keys of a section of a case as a table, a row a key: the member of a spec that it fills, what it may
// be, its default and what it means. One reader fills the spec, and says what is wrong with a key or missing;
// the page cases/README.md, `silt keys` and the completion of the shell have the same rows.
#include <string>
#include <tuple>
#include <vector>

#include "coupler/case/case_reader.hpp"

namespace silt::coupler {

/// A row as the page and `silt keys` have it.
struct KeyText {
  std::string name, type, unit, fallback, meaning;
};
/// The rows of a table of a case; path: "fluid", "output.fields".
struct KeySection {
  std::string path;
  std::vector<KeyText> keys;
};
/// Returns every key that a case may have, in the order of the page.
std::vector<KeySection> case_keys();

inline constexpr const char* required = "–";  // in the place of a default: the key must be given

/// Returns the unit in SI as the page writes it: "m²/s", "1" of a number.
std::string unit_on_page(Dimension);

// What a value may be: how it is read, what the page says of it, and how a default is written.
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
struct Whole {
  std::int64_t low = 0, high = std::numeric_limits<std::int64_t>::max();
  const char* unit = "";
  auto read(TableReader& table, const char* key) const { return table.integer(key, low, high); }
  std::string type() const { return "integer"; }
  std::string unit_text() const { return unit; }
  static std::string text(std::int64_t n) { return std::to_string(n); }
};
struct Flag {
  auto read(TableReader& table, const char* key) const { return table.boolean(key); }
  std::string type() const { return "boolean"; }
  std::string unit_text() const { return ""; }
  static std::string text(bool b) { return b ? "true" : "false"; }
};
struct Text {
  auto read(TableReader& table, const char* key) const { return table.string(key); }
  std::string type() const { return "string"; }
  std::string unit_text() const { return ""; }
  static std::string text(const std::string& s) { return s; }
};
template <class Enum, std::size_t count>
struct Choice {
  NameTable<Enum, count> names;
  auto read(TableReader& table, const char* key) const { return table.choice(key, names); }
  std::string type() const { return '"' + joined(names.list(), "\", \"") + '"'; }
  std::string unit_text() const { return ""; }
  std::string text(Enum value) const { return '"' + std::string(names[value]) + '"'; }
};

template <class Spec, class Member, class Kind>
struct Key {
  const char* name;
  Member Spec::*member;
  Kind kind;
  const char* meaning;
  const char* fallback = nullptr;  // null: what the member is in a spec that nobody has filled
};

/// A key that its section reads by hand.
struct HandKey {
  const char *name, *type, *unit, *fallback, *meaning;
};

template <class Spec, class Member, class Kind>
KeyText text_of(const Key<Spec, Member, Kind>& key) {
  KeyText text{key.name, key.kind.type(), key.kind.unit_text(), "", key.meaning};
  if (key.fallback)
    text.fallback = key.fallback;
  else if constexpr (requires { key.kind.text(Member{}); })
    text.fallback = key.kind.text(Spec{}.*key.member);
  return text;
}
inline KeyText text_of(const HandKey& key) {
  return {key.name, key.type, key.unit, key.fallback, key.meaning};
}

/// Reports a key that must be there and is not.
template <class AnyKey>
void require(TableReader& table, const AnyKey& key) {
  if (!table.has(key.name) && key.fallback && std::string_view(key.fallback) == required)
    table.missing(key.name, key.meaning);
}

template <class AnySpec, class Spec, class Member, class Kind>
void read_key(TableReader& table, AnySpec& spec, const Key<Spec, Member, Kind>& key) {
  require(table, key);
  if (const auto value = key.kind.read(table, key.name)) spec.*key.member = Member(*value);
}
template <class AnySpec>
void read_key(TableReader& table, AnySpec&, const HandKey& key) {
  require(table, key);
}

/// Fills a spec with what a table has of its keys; those read by hand become known, and are reported if they
/// are missing.
template <class Spec, class... Keys>
void read_keys(TableReader& table, Spec& spec, const std::tuple<Keys...>& keys) {
  if (table.present()) std::apply([&](const auto&... key) { (read_key(table, spec, key), ...); }, keys);
}

/// Returns the rows of the tables of keys that a section has, one after the other.
template <class... Tables>
KeySection section_of(const char* path, const Tables&... tables) {
  KeySection section{path, {}};
  std::apply([&](const auto&... key) { (section.keys.push_back(text_of(key)), ...); },
             std::tuple_cat(tables...));
  return section;
}

}  // namespace silt::coupler
