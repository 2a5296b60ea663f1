#pragma once
// Typed access to the tables of a case file that keeps account of who read what: every key asked for becomes
// a known key of its table, and a key that nobody asked for is an error. Nothing here throws; errors are
// collected.
#include <fmt/format.h>

#include <initializer_list>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coupler/case/case_error.hpp"
#include "coupler/case/name_table.hpp"
#include "coupler/case/units.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

using adapters::Node;

struct CaseSource;

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

  void fail(const Place&, const std::string& text);
  template <class... T>
  void fail(const Place& place, fmt::format_string<T...> text, T&&... values) {
    fail(place, fmt::format(text, std::forward<T>(values)...));
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
  std::optional<rigid::Vec3> vector(std::string_view key);
  std::optional<rigid::Vec3> vector(std::string_view key, Dimension);
  std::optional<std::int64_t> integer(std::string_view key, std::int64_t low,
                                      std::int64_t high = std::numeric_limits<std::int64_t>::max());
  std::optional<bool> boolean(std::string_view key);
  std::optional<std::string> string(std::string_view key);
  /// Returns a string out of a list; the nearest is named if it is another.
  std::optional<std::string> choice(std::string_view key, const std::vector<std::string>& allowed);
  /// Returns the value of an enum by its name.
  template <class Enum, std::size_t count>
  std::optional<Enum> choice(std::string_view key, const NameTable<Enum, count>& table) {
    const auto name = choice(key, table.list());
    for (std::size_t i = 0; name && i < count; ++i)
      if (table.names[i] == *name) return static_cast<Enum>(i);
    return {};
  }

  TableReader table(std::string_view key);
  /// Returns the tables of an array of tables.
  std::vector<TableReader> tables(std::string_view key);

  /// Leaves open what the other keys mean (under an unknown type): none of them is called unknown.
  void judge_no_keys() { context_->unjudged.insert(table_); }

  /// Reports a key that must be there; `what` says what it stands for.
  void missing(std::string_view key, std::string_view what);
  /// Reports "fluid.density is -1; it must be above 0".
  void refuse(std::string_view key, std::string_view must);
  void fail(std::string_view key, const std::string& text) { context_->fail(place(key), text); }
  template <class... T>
  void fail(std::string_view key, fmt::format_string<T...> text, T&&... values) {
    context_->fail(place(key), fmt::format(text, std::forward<T>(values)...));
  }
  template <class... T>
  void warn(std::string_view key, fmt::format_string<T...> text, T&&... values) {
    context_->warnings.push_back(
        {Diagnostic::Severity::warning, place(key), fmt::format(text, std::forward<T>(values)...)});
  }
  /// Requires that exactly one (or, unless required, at most one) of the keys is given; returns the one, or
  /// "".
  std::string one_of(std::initializer_list<const char*> keys, bool required, std::string_view what);

 private:
  ReadContext* context_;
  const Node* table_;
  std::string path_;
  Place place_;
};

/// Returns an array of three numbers; none (reported under the given name) otherwise.
std::optional<rigid::Vec3> read_vector(ReadContext&, const Node&, const std::string& path);

}  // namespace silt::coupler
