#include "adapters/mesh/soup.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>
#include <stdexcept>

namespace silt::adapters {

namespace {

std::optional<double> parsed(std::string_view digits, std::chars_format format) {
  double x = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x, format);
  if (end != digits.data() + digits.size()) return {};
  if (error == std::errc::result_out_of_range)  // a number beyond the range of double
    return std::min(digits.find("e-"), digits.find("E-")) < digits.size()
               ? 0
               : std::numeric_limits<double>::infinity();
  if (error != std::errc()) return {};
  return x;
}

struct Foreign {
  std::string_view start;  // in lower case
  const char* what;
};

using namespace std::string_view_literals;

constexpr Foreign formats[] = {
    {"<!doctype"sv, "it is a page of the web (HTML), not a surface: download the file itself"},
    {"<html"sv, "it is a page of the web (HTML), not a surface: download the file itself"},
    {"<?xml"sv, "it is XML (as of 3MF, AMF or COLLADA): save the surface as STL, OBJ or PLY"},
    {"version https://git-lfs"sv,
     "it is a pointer of Git LFS, not the file itself: run 'git lfs pull' where it comes from"},
    {"iso-10303"sv, "it is STEP, which has no triangles: save it as STL, OBJ or PLY"},
    {"\x1f\x8b"sv, "it is compressed (gzip): unpack it"},
    {"pk\x03\x04"sv, "it is a zip archive (as 3MF is): unpack it, and save the surface as STL, OBJ or PLY"},
    {"\xff\xfe"sv, "it is text in UTF-16: save it as UTF-8 or ASCII"},
    {"\xfe\xff"sv, "it is text in UTF-16: save it as UTF-8 or ASCII"}};

bool is_space(unsigned char c) {
  return std::isspace(c);
}

}  // namespace

std::string_view next_word(std::string_view& text) {
  const auto begin = std::find_if_not(text.begin(), text.end(), is_space);
  const auto end = std::find_if(begin, text.end(), is_space);
  const std::string_view word(begin, end);
  text = {end, text.end()};
  return word;
}

std::optional<double> number_in(std::string_view word) {
  const bool has_sign = !word.empty() && (word[0] == '-' || word[0] == '+');
  const double sign = has_sign && word[0] == '-' ? -1 : 1;
  std::string digits(word.substr(has_sign));
  if (digits.empty() || digits[0] == '-' || digits[0] == '+') return {};
  if (digits.starts_with("1.#"))
    return std::numeric_limits<double>::quiet_NaN();  // as Microsoft's library writes it
  std::optional<double> x;
  if (digits.starts_with("0x") || digits.starts_with("0X"))
    x = parsed(std::string_view(digits).substr(2), std::chars_format::hex);
  else {
    if (const std::size_t d = digits.find_first_of("dD"); d != digits.npos && d > 0) digits[d] = 'e';
    x = parsed(digits, std::chars_format::general);
  }
  if (x) *x *= sign;
  return x;
}

std::string shown_word(std::string_view word) {
  if (word.empty()) return "the end of the file";
  std::string text = "'";
  text.append(word.substr(0, 40)) += '\'';
  const std::size_t comma = word.find(',');
  std::string with_point(word);
  if (comma != word.npos) with_point[comma] = '.';
  if (comma != word.npos && number_in(with_point)) return text + " (a decimal comma: write a point)";
  return text;
}

std::string_view without_mark(std::string_view bytes) {
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  return bytes;
}

void refuse_foreign(std::string_view bytes) {
  constexpr std::size_t longest = 100;
  if (bytes.empty()) throw std::invalid_argument("it is empty");
  std::string start(without_mark(bytes).substr(0, longest));
  start.erase(0, std::min(start.find_first_not_of(" \t\r\n"), start.size()));
  for (char& c : start) c = char(std::tolower(static_cast<unsigned char>(c)));
  for (const Foreign& format : formats)
    if (start.starts_with(format.start)) throw std::invalid_argument(format.what);
}

}  // namespace silt::adapters
