#pragma once
// A TOML document as a plain tree of values that remember where they stand, without a header of toml++.
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace silt::adapters {

/// A place in a document: "case.toml:12:5". Line 0 is the whole file, or a command line option.
struct Place {
  std::string file;
  int line = 0, column = 0;  // from 1
  std::string text() const;
};

/// One value, and the key it stands behind if it is the child of a table.
struct Node {
  enum class Kind { table, array, string, integer, floating, boolean, date };

  Kind kind = Kind::table;
  Place place;  // of the value
  std::string key;
  Place key_place;

  std::string string;
  std::int64_t integer = 0;
  double floating = 0;
  bool boolean = false;
  std::vector<Node> children;  // of an array in order, of a table in the order of the file

  /// The child of a table behind a key, or nullptr.
  const Node* find(std::string_view key) const;
  Node* find(std::string_view key);
  bool is_number() const { return kind == Kind::integer || kind == Kind::floating; }
  double number() const { return kind == Kind::integer ? double(integer) : floating; }
  /// The numbers of an array of so many, all finite; none of anything else.
  std::optional<std::vector<double>> numbers(std::size_t count) const;
  /// The strings of an array of nothing else, one at least; none of anything else.
  std::optional<std::vector<std::string>> strings() const;
};

/// The kind of a value for messages: "a table", "a string", "an integer" ...
std::string_view kind_name(Node::Kind);
/// The value as one would write it in TOML, shortened: -1e-06, "bullet", [0, 0, 1], { ... }.
std::string written(const Node&);

/// Thrown where the text is not TOML.
struct SyntaxError : std::runtime_error {
  SyntaxError(Place where, const std::string& what) : std::runtime_error(what), place(std::move(where)) {}
  Place place;
};

/// Parses the root table of a document; `file` is only what places are labelled with. Throws SyntaxError.
Node parse_document(std::string_view text, const std::string& file);
/// Parses one TOML value, such as the right-hand side of `--set key=value`. Throws SyntaxError.
Node parse_value(std::string_view text, const Place&);

}  // namespace silt::adapters
