#include "adapters/stl/number_word.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

namespace silt::adapters {

namespace {

std::optional<double> parsed(std::string_view digits, std::chars_format format) {
  double x = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x, format);
  if (end != digits.data() + digits.size()) return {};
  if (error == std::errc::result_out_of_range)  // a number all the same, above or below all of double
    return std::min(digits.find("e-"), digits.find("E-")) < digits.size()
               ? 0
               : std::numeric_limits<double>::infinity();
  if (error != std::errc()) return {};
  return x;
}

}  // namespace

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
  const std::string text = "'" + std::string(word.substr(0, 40)) + "'";
  const std::size_t comma = word.find(',');
  std::string with_point(word);
  if (comma != word.npos) with_point[comma] = '.';
  if (comma != word.npos && number_in(with_point)) return text + " (a decimal comma: write a point)";
  return text;
}

}  // namespace silt::adapters
