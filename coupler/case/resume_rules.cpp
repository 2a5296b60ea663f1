#include "coupler/case/resume_rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "coupler/case/case_file.hpp"
#include "coupler/case/case_overrides.hpp"

namespace silt::coupler {
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
      place, fmt::format("the case has changed since the checkpoint was written: this line was \"{}\"; only "
                         "[run], [output] and [[quantities]] may differ when a run goes on; restore it, or "
                         "start a new run",
                         i < before.size() ? before[i].text : ""));
}

/// The files that the case names, too, must be those of the run.
void require_same_files(const CaseOrigin& origin, const Case& now) {
  for (std::size_t i = 0; i < now.files.size(); ++i) {
    if (i < origin.files.size() && origin.files[i] == now.files[i]) continue;
    throw CaseError(
        now.place("shapes"),
        fmt::format("a file has changed since the checkpoint was written: it was {}; it is {}; restore "
                    "it, or start a new run",
                    i < origin.files.size() ? origin.files[i] : "not there", now.files[i]));
  }
}

}  // namespace

Case case_to_resume(const CaseOrigin& origin, CaseSource& source, const std::vector<std::string>& overrides) {
  auto all = origin.overrides;
  for (const std::string& o : overrides) {
    const std::string key = o.substr(0, o.find('='));
    if (!may_change(key))
      throw CaseError(Place{override_text(o)},
                      fmt::format("{} cannot change when a run goes on; only keys of run, output and "
                                  "quantities can",
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
