
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <sstream>

#include "silt/case/case_file.hpp"

namespace silt {
namespace {

using adapters::Node;

// A string may be written without quotes if it has no other meaning.
bool is_bare_string(const std::string& text) {
  if (text.empty() || text == "true" || text == "false" || text == "inf" || text == "nan") return false;
  return std::isalpha(static_cast<unsigned char>(text[0])) && std::ranges::all_of(text, [](unsigned char c) {
           return std::isalnum(c) || c == '-' || c == '_' || c == '.';
         });
}

Node parsed_value(const std::string& text, const Place& place) {
  try {
    return adapters::parse_value(is_bare_string(text) ? '"' + text + '"' : text, place);
  } catch (const adapters::SyntaxError& error) {
    throw CaseError(place, fmt::format("'{}' is not a TOML value, such as 0.7, true, \"text\", [1, 2, 3] or "
                                       "{{ every = 10 }}: {}",
                                       text, error.what()));
  }
}

// "bodies[2].density" -> "bodies", "2", "density"
std::vector<std::string> steps_of(std::string path) {
  std::replace(path.begin(), path.end(), '[', '.');
  std::erase(path, ']');
  std::erase_if(path, [](unsigned char c) { return std::isspace(c); });
  std::vector<std::string> steps;
  for (std::size_t begin = 0, end = 0; end != path.npos; begin = end + 1) {
    end = path.find('.', begin);
    steps.push_back(path.substr(begin, end - begin));
  }
  return steps;
}

Node* element(Node& array, const std::string& step, const Place& place) {
  std::size_t index = 0;
  const auto end = std::from_chars(step.data(), step.data() + step.size(), index);
  if (end.ec != std::errc{} || end.ptr != step.data() + step.size())
    throw CaseError(
        place, fmt::format("'{}' must be the number of an entry, from 0, as in bodies[0].density", step));
  if (index >= array.children.size())
    throw CaseError(place,
                    fmt::format("there is no entry {}: the list has {}", index, array.children.size()));
  return &array.children[index];
}

Node* descend(Node& node, const std::string& step, const Place& place) {
  if (node.kind == Node::Kind::array) return element(node, step, place);
  if (node.kind != Node::Kind::table)
    throw CaseError(place, fmt::format("'{}' lies below a value that is {}", step, kind_name(node.kind)));
  if (Node* child = node.find(step)) return child;
  Node child;
  child.key = step;
  child.place = child.key_place = place;
  node.children.push_back(child);
  return &node.children.back();
}

/// Removes the alternatives ("one of two") of a key that is set.
void remove_alternatives(Node& root, const std::vector<std::string>& steps) {
  const auto sections = case_keys();
  const auto section = std::ranges::find(sections, steps[0], &KeySection::path);
  if (steps.size() != 2 || section == sections.end()) return;
  const auto is_one_of = [&](const std::string& name) {
    return std::ranges::any_of(section->keys, [&](const KeyText& key) {
      return key.name == name && key.fallback.starts_with("one of");
    });
  };
  if (!is_one_of(steps[1])) return;
  std::erase_if(root.find(steps[0])->children,
                [&](const Node& child) { return child.key != steps[1] && is_one_of(child.key); });
}

/// Returns the child of a table or list that a step names. Throws CaseError if there is none.
Node* child_at(Node& node, const std::string& step, const Place& place) {
  if (node.kind == Node::Kind::array) return element(node, step, place);
  if (Node* child = node.find(step)) return child;
  std::vector<std::string> known;
  for (const Node& child : node.children) known.push_back(child.key);
  throw CaseError(place, fmt::format("the case has no such key: there is no '{}'{}", step,
                                     node.kind == Node::Kind::table ? suggestion(step, known) : ""));
}

void take_away(Node& root, const std::string& path) {
  const Place place{"--unset " + path};
  const auto steps = steps_of(path);
  Node* node = &root;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) node = child_at(*node, steps[i], place);
  node->children.erase(node->children.begin() +
                       (child_at(*node, steps.back(), place) - node->children.data()));
}

void apply_override(Node& root, const std::string& argument) {
  const auto equals = argument.find('=');
  if (equals != argument.npos && equals > 0 && equals + 1 == argument.size())
    return take_away(root, argument.substr(0, equals));
  const Place place{"--set " + argument};
  if (equals == argument.npos || equals == 0)
    throw CaseError(place, "must have the form key.path=value, as in fluid.density=960");
  if (argument.find_first_of("\n\r") != argument.npos)
    throw CaseError(place, "must be of one line; write lists and tables without breaks");
  const std::string path = argument.substr(0, equals);
  Node value = parsed_value(argument.substr(equals + 1), place);
  const auto steps = steps_of(path);
  if (std::ranges::any_of(steps, &std::string::empty))
    throw CaseError(place, fmt::format("'{}' has an empty name in it", path));
  Node* node = &root;
  for (const std::string& step : steps) node = descend(*node, step, place);
  value.key = node->key;
  *node = std::move(value);
  remove_alternatives(root, steps);
}

/// Returns the key of an argument of --set or --unset; run.steps and run.time count as one.
std::string key_of(const std::string& argument) {
  const std::string key = argument.substr(0, argument.find('='));
  return key == "run.time" ? "run.steps" : key;
}

/// Returns whether a resumed run may change a table.
bool may_change(const std::string& table) {
  return table == "run" || table == "output" || table == "quantities";
}

/// A value of a case file that acts on the state.
struct ValueInFile {
  std::string text;  // with the path of its key
  int line;
};

void list_values(const Node& node, const std::string& path, std::vector<ValueInFile>& values) {
  if (node.children.empty()) values.push_back({path + " = " + written(node), node.place.line});
  for (const Node& child : node.children)
    if (!path.empty() || !may_change(child.key)) list_values(child, path + "." + child.key, values);
}

std::vector<ValueInFile> values_of(const std::string& text, const std::string& file) {
  std::vector<ValueInFile> values;
  list_values(tree_of_case(text, file, {}), "", values);
  return values;
}

/// Returns a line of a text, trimmed.
std::string line_at(const std::string& text, int number) {
  std::istringstream stream(text);
  std::string line;
  while (number-- > 0) std::getline(stream, line);
  const auto first = line.find_first_not_of(" \t\r");
  return first == line.npos ? "" : line.substr(first, line.find_last_not_of(" \t\r") - first + 1);
}

void require_same_values(const CaseOrigin& origin, const CaseSource& source) {
  const auto before = values_of(origin.text, source.file), now = values_of(source.text, source.file);
  std::size_t i = 0;
  while (i < before.size() && i < now.size() && before[i].text == now[i].text) ++i;
  if (i == before.size() && i == now.size()) return;
  throw CaseError(Place{source.file,
                        i < now.size() ? now[i].line
                        : now.empty()  ? 1
                                       : now.back().line,
                        1},
                  fmt::format("the case has changed since the checkpoint was written: this line was \"{}\"; "
                              "only [run], [output] and [[quantities]] may differ when a run continues; "
                              "restore it, or start another case from these results ([initial] from)",
                              i < before.size() ? line_at(origin.text, before[i].line) : ""));
}

/// Requires that files named by the case are those of the earlier run.
void require_same_files(const CaseOrigin& origin, const Case& now) {
  for (std::size_t i = 0; i < now.files.size(); ++i) {
    if (i < origin.files.size() && origin.files[i] == now.files[i]) continue;
    throw CaseError(now.place("shapes"),
                    fmt::format("a file has changed since the checkpoint was written: it was {}; it is {}; "
                                "restore it, or start another case from these results ([initial] from)",
                                i < origin.files.size() ? origin.files[i] : "not there", now.files[i]));
  }
}

}  // namespace

Node tree_of_case(const std::string& text, const std::string& file,
                  const std::vector<std::string>& overrides) {
  Node root;
  try {
    root = adapters::parse_document(text, file);
  } catch (const adapters::SyntaxError& error) {
    throw CaseError(error.place, fmt::format("this is not TOML: {}", error.what()));
  }
  for (const std::string& argument : overrides) apply_override(root, argument);
  return root;
}

std::string complaint_of_set(const std::string& argument) {
  if (argument.find('=') + 1 != argument.size()) return "";
  return fmt::format("{} has no value; to take a key away: --unset {}", argument,
                     argument.substr(0, argument.size() - 1));
}

std::string complaint_of_unset(const std::string& argument) {
  const bool key = !argument.empty() && argument.find('=') == argument.npos;
  return key ? "" : fmt::format("'{}' must be the path of a key, as in run.balance", argument);
}

std::string override_text(const std::string& argument) {
  const bool taken_away = argument.find('=') + 1 == argument.size();
  return taken_away ? "--unset " + argument.substr(0, argument.size() - 1) : "--set " + argument;
}

Case case_to_resume(const CaseOrigin& origin, CaseSource& source, const std::vector<std::string>& overrides) {
  auto all = origin.overrides;
  for (const std::string& o : overrides) {
    const std::string key = o.substr(0, o.find('='));
    if (!may_change(steps_of(key)[0]))
      throw CaseError(Place{override_text(o)},
                      fmt::format("{} cannot change when a run continues; only keys of run, output and "
                                  "quantities can: start another case from these results ([initial] from)",
                                  key));
    all.push_back(o);
  }
  Case setup = read_case(source, all);
  require_same_values(origin, source);
  require_same_files(origin, setup);
  return setup;
}

std::string earlier_options(const CaseOrigin& origin, const std::vector<std::string>& overrides) {
  std::vector<std::string> options;
  for (auto o = origin.overrides.begin(); o != origin.overrides.end(); ++o) {
    const auto is_of_its_key = [&](const std::string& later) { return key_of(later) == key_of(*o); };
    if (std::any_of(o + 1, origin.overrides.end(), is_of_its_key) ||
        std::ranges::any_of(overrides, is_of_its_key))
      continue;
    options.push_back(override_text(*o));
  }
  return joined(options, " ");
}

}  // namespace silt
