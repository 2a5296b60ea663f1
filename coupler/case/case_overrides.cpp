#include "coupler/case/case_overrides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <sstream>

#include "coupler/case/case_file.hpp"

namespace silt::coupler {

namespace {

using adapters::Node;

// Keys that say the same thing in different ways: setting one replaces the others.
const std::vector<std::vector<std::string>> alternatives = {
    {"run.steps", "run.time"},
    {"units.time_step", "units.relaxation_time", "units.max_velocity"},
    {"fluid.kinematic_viscosity", "fluid.relaxation_time"},
};

// A string may be written without quotes if it cannot be anything else.
bool is_bare_string(const std::string& text) {
  if (text.empty() || text == "true" || text == "false" || text == "inf" || text == "nan") return false;
  return std::isalpha(static_cast<unsigned char>(text[0])) &&
         std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_' || c == '.'; });
}

Node parsed_value(const std::string& text, const Place& place) {
  if (is_bare_string(text)) {
    Node node;
    node.kind = Node::Kind::string;
    node.string = text;
    node.place = node.key_place = place;
    return node;
  }
  try {
    return adapters::parse_value(text, place);
  } catch (const adapters::SyntaxError& error) {
    throw CaseError(place, fmt::format("'{}' is not a TOML value: {}", text, error.what()));
  }
}

// "bodies[2].density" -> "bodies", "2", "density"
std::vector<std::string> steps_of(std::string path) {
  std::replace(path.begin(), path.end(), '[', '.');
  std::erase(path, ']');
  std::vector<std::string> steps(1);
  for (const char c : path) {
    if (c == '.')
      steps.emplace_back();
    else if (!std::isspace(static_cast<unsigned char>(c)))
      steps.back() += c;
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

void remove_alternatives(Node& root, const std::string& path) {
  for (const auto& group : alternatives) {
    if (std::count(group.begin(), group.end(), path) == 0) continue;
    const auto dot = path.find('.');
    Node* table = root.find(path.substr(0, dot));
    if (!table) continue;
    std::erase_if(table->children, [&](const Node& child) {
      const std::string other = path.substr(0, dot + 1) + child.key;
      return other != path && std::count(group.begin(), group.end(), other) > 0;
    });
  }
}

/// The child of a table or list that a step names; CaseError if there is none.
std::vector<Node>::iterator place_of_step(Node& node, const std::string& step, const Place& place) {
  if (node.kind == Node::Kind::array)
    return node.children.begin() + (element(node, step, place) - node.children.data());
  const auto found = std::find_if(node.children.begin(), node.children.end(),
                                  [&](const Node& child) { return child.key == step; });
  if (found != node.children.end() && node.kind == Node::Kind::table) return found;
  std::vector<std::string> known;
  for (const Node& child : node.children) known.push_back(child.key);
  throw CaseError(place, fmt::format("the case has no such key: there is no '{}'{}", step,
                                     node.kind == Node::Kind::table ? suggestion(step, known) : ""));
}

void take_away(Node& root, const std::string& path) {
  const Place place{"--unset " + path};
  const auto steps = steps_of(path);
  Node* node = &root;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) node = &*place_of_step(*node, steps[i], place);
  node->children.erase(place_of_step(*node, steps.back(), place));
}

}  // namespace

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
  if (std::any_of(steps.begin(), steps.end(), [](const std::string& s) { return s.empty(); }))
    throw CaseError(place, fmt::format("'{}' has an empty name in it", path));
  Node* node = &root;
  for (const std::string& step : steps) node = descend(*node, step, place);
  value.key = node->key;
  *node = std::move(value);
  remove_alternatives(root, path);
}

namespace {

/// Returns case.toml as it was read: a case's text without the comments that name the --set arguments.
std::string file_text(std::string text, const std::vector<std::string>& overrides) {
  for (auto o = overrides.rbegin(); o != overrides.rend(); ++o) {
    const std::string comment = "\n# " + override_text(*o);
    if (text.ends_with(comment)) text.resize(text.size() - comment.size());
  }
  return text;
}

/// Returns the key that an argument of --set or --unset is about; the length of a run has two.
std::string key_of(const std::string& argument) {
  const std::string key = argument.substr(0, argument.find('='));
  return key == "run.time" ? "run.steps" : key;
}

/// Whether a key lies in a table that a run may change when it goes on.
bool may_change(std::string_view key) {
  return key == "run" || key == "output" || key == "quantities" || key.starts_with("run.") ||
         key.starts_with("output.") || key.starts_with("quantities");
}

struct Line {
  int number;
  std::string text;
};

/// How much deeper in lists and tables a line ends than it begins; brackets in strings and comments do not
/// count.
int depth_gained(const std::string& line) {
  int depth = 0;
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != 0) {
      if (c == '\\' && quote == '"') ++i;
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#') {
      break;
    } else {
      depth += (c == '[' || c == '{') - (c == ']' || c == '}');
    }
  }
  return depth;
}

/// Returns the lines that act on the state: none of the tables that may change, no blank lines, no whole-line
/// comments.
std::vector<Line> lines_that_matter(const std::string& text) {
  std::vector<Line> lines;
  std::istringstream stream(text);
  bool skip = false;
  int number = 0, depth = 0;  // within a value of several lines
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const auto first = line.find_first_not_of(" \t\r");
    if (first == line.npos || line[first] == '#') continue;
    line = line.substr(first, line.find_last_not_of(" \t\r") - first + 1);
    const bool is_header = line[0] == '[' && depth == 0;
    depth = std::max(0, depth + depth_gained(line));
    if (is_header) {
      const auto name = line.find_first_not_of("[ \t");
      skip = name != line.npos && may_change(line.substr(name, line.find_first_of("] \t", name) - name));
    }
    if (!skip) lines.push_back({number, line});
  }
  return lines;
}

void require_same_text(const CaseOrigin& origin, const Case& now) {
  const auto before = lines_that_matter(file_text(origin.text, origin.overrides));
  const auto after = lines_that_matter(file_text(now.text, now.overrides));
  std::size_t i = 0;
  while (i < before.size() && i < after.size() && before[i].text == after[i].text) ++i;
  if (i == before.size() && i == after.size()) return;
  Place place = now.place("");
  place.line = i < after.size() ? after[i].number : after.empty() ? 1 : after.back().number;
  place.column = 1;
  throw CaseError(
      place,
      fmt::format("the case has changed since the checkpoint was written: this line was \"{}\"; only [run], "
                  "[output] and [[quantities]] may differ when a run goes on; restore it, or start a new run",
                  i < before.size() ? before[i].text : ""));
}

/// The files that the case names, too, must be those of the run.
void require_same_files(const CaseOrigin& origin, const Case& now) {
  for (std::size_t i = 0; i < now.files.size(); ++i) {
    if (i < origin.files.size() && origin.files[i] == now.files[i]) continue;
    throw CaseError(now.place("shapes"),
                    fmt::format("a file has changed since the checkpoint was written: it was {}; it is {}; "
                                "restore it, or start a new run",
                                i < origin.files.size() ? origin.files[i] : "not there", now.files[i]));
  }
}

}  // namespace

Case case_to_resume(const CaseOrigin& origin, CaseSource& source, const std::vector<std::string>& overrides) {
  auto all = origin.overrides;
  for (const std::string& o : overrides) {
    const std::string key = o.substr(0, o.find('='));
    if (!may_change(key))
      throw CaseError(
          Place{override_text(o)},
          fmt::format("{} cannot change when a run goes on; only keys of run, output and quantities can",
                      key));
    all.push_back(o);
  }
  Case scene = read_case(source, all);
  require_same_text(origin, scene);
  require_same_files(origin, scene);
  return scene;
}

std::string earlier_options(const CaseOrigin& origin, const std::vector<std::string>& overrides) {
  std::vector<std::string> options;
  for (auto o = origin.overrides.begin(); o != origin.overrides.end(); ++o) {
    const auto is_of_its_key = [&](const std::string& later) { return key_of(later) == key_of(*o); };
    if (std::any_of(o + 1, origin.overrides.end(), is_of_its_key) ||
        std::any_of(overrides.begin(), overrides.end(), is_of_its_key))
      continue;
    options.push_back(override_text(*o));
  }
  return joined(options, " ");
}

}  // namespace silt::coupler
