#pragma once
// A TOML document as a tree of values with their places in the file, without headers of toml++.
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace silt::adapters {

/// A place in a document, "case.toml:12:5". Line 0 stands for the whole file or a command line option.
struct Place {
  std::string file;
  int line = 0, column = 0;  // from 1
  std::string text() const;
};

/// A value, with its key if it is the child of a table.
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
  std::vector<Node> children;  // of an array, or of a table in the order of the file

  /// Returns the child of a table with this key, or nullptr.
  const Node* find(std::string_view key) const;
  Node* find(std::string_view key);
  bool is_number() const { return kind == Kind::integer || kind == Kind::floating; }
  double number() const { return kind == Kind::integer ? double(integer) : floating; }
  /// Returns the numbers of an array of `count` finite numbers; nothing for any other value.
  std::optional<std::vector<double>> numbers(std::size_t count) const;
  /// Returns the strings of a nonempty array of strings; nothing for any other value.
  std::optional<std::vector<std::string>> strings() const;
};

/// Returns the kind of a value for messages: "a table", "a string", "an integer" ...
std::string_view kind_name(Node::Kind);
/// Returns a value in TOML, shortened: -1e-06, "bullet", [0, 0, 1], { ... }.
std::string written(const Node&);

/// Thrown for text that is not TOML.
struct SyntaxError : std::runtime_error {
  SyntaxError(Place where, const std::string& what) : std::runtime_error(what), place(std::move(where)) {}
  Place place;
};

/// Parses the root table of a document; `file` only labels places. Throws SyntaxError.
Node parse_document(std::string_view text, const std::string& file);
/// Parses a TOML value of one line, such as the right-hand side of `--set key=value`. Throws SyntaxError.
Node parse_value(std::string_view text, const Place&);

}  // namespace silt::adapters
