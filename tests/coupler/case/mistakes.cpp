#include "tests/coupler/case/mistakes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <sstream>

#include "silt/case/case_error.hpp"
#include "silt/case/case_file.hpp"
#include "tests/coupler/case/case_text.hpp"

namespace silt::coupler::testing {
namespace {

/// Everything that is said of a text, a line each.
std::vector<std::string> said_of(const std::string& text) {
  std::string all;
  const std::string unread = error_of([&] { all = listed(judgement(read_case_text(text))); });
  std::istringstream stream(unread + all);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

long line_of(const std::string& text, const std::string& part) {
  const auto at = text.find(part);
  EXPECT_NE(at, text.npos) << part;
  return std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 1;
}

/// line: 0 for what is not there at all, which has none.
bool names(const std::string& said, long line, const std::vector<std::string>& parts) {
  const std::string place = line > 0 ? fmt::format(":{}:[1-9][0-9]*", line) : "";
  if (!std::regex_search(said, std::regex(fmt::format("^case\\.toml{}: ", place)))) return false;
  return std::all_of(parts.begin(), parts.end(),
                     [&](const std::string& part) { return said.find(part) != said.npos; });
}

}  // namespace

std::string sound_wet_case() {
  return R"(title = "balls in oil"

[units]
system = "si"
cell_size = 5e-4
time_step = 2.5e-4

[domain]
size = [0.016, 0.016, 0.032]
boundary = { x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] }

[fluid]
density = 960
kinematic_viscosity = 1e-4

[gravity]
acceleration = [0, 0, -9.81]

[contacts]
restitution = 0.5

[[material_pairs]]
between = ["glass", "glass"]
friction = 0.2

[[shapes]]
name = "ball"
type = "sphere"
diameter = 4e-3

[[bodies]]
name = "plastic"
shape = "ball"
density = 1120
position = [0.008, 0.008, 0.024]

[[fill]]
name = "glass balls"
shape = "ball"
material = "glass"
density = 2500
count = 8
box = [[0, 0, 0.001], [0.016, 0.016, 0.019]]

[run]
time = 0.5
balance = { every = 100 }

[output]
bodies = { every = 100 }
fields = { every = 500, quantities = ["velocity", "density"] }
checkpoint = { every = 1000, keep = 2 }

[[quantities]]
name = "settling"
type = "mean-velocity"
body = "glass balls"
axis = "z"
)";
}

std::string sound_dry_case() {
  return R"([units]
system = "si"
cell_size = 6e-3
time_step = 2.5e-4

[domain]
size = [0.156, 0.03, 0.156]
boundary = "no-slip"

[gravity]
acceleration = [0, 0, -9.81]

[contacts]
friction = 0.3
margin = 3e-3

[[shapes]]
name = "ball"
type = "sphere"
diameter = 6e-3

[[shapes]]
name = "brick"
type = "box"
edges = [0.01, 0.01, 0.02]

[[walls]]
name = "drum"
type = "tube"
axis = "y"
radius = 0.06
point = [0.078, 0.015, 0.078]
angular_velocity = 0.6

[[bodies]]
shape = "brick"
density = 2500
position = [0.078, 0.015, 0.078]
orientation = { axis = [0, 1, 0], degrees = 30 }

[[bodies]]
shape = "ball"
density = 2500
positions = [[0.078, 0.015, 0.1], [0.078, 0.015, 0.11]]

[run]
time = 1.0
)";
}

void PrintTo(const Mistake& mistake, std::ostream* out) {
  *out << mistake.from << " -> " << mistake.to;
}

void expect_named(const std::string& sound, const Mistake& mistake) {
  ASSERT_TRUE(said_of(sound).empty()) << said_of(sound).front();
  std::string text = sound;
  const auto at = text.find(mistake.from);
  ASSERT_NE(at, text.npos) << mistake.from;
  text.replace(at, mistake.from.size(), mistake.to);
  const long line =
      mistake.at == "the file" ? 0 : line_of(text, mistake.at.empty() ? mistake.to : mistake.at);
  const std::vector<std::string> said = said_of(text);
  const bool named = std::any_of(said.begin(), said.end(),
                                 [&](const std::string& s) { return names(s, line, mistake.parts); });
  std::string all;
  for (const std::string& s : said) all += s + '\n';
  EXPECT_TRUE(named) << "line " << line << " is not named so, but:\n" << (all.empty() ? "nothing" : all);
}

}  // namespace silt::coupler::testing
