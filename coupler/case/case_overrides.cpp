#include "coupler/case/case_overrides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>

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

}  // namespace silt::coupler
