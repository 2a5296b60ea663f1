#pragma once
// The fields of a line of a CSV file, and what is wrong with a line that should be numbers.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace silt::coupler {

inline constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // of UTF-8

/// Returns a text without the blanks around it.
std::string_view trimmed(std::string_view);

/// Takes a finite number off the beginning of a text, a plus sign included; false if there is none.
bool take_number(std::string_view& text, double& x);

/// Splits a line at its commas, takes off blanks around fields and quotes around them (RFC 4180); none if a
/// quote does not end, or something stands beside one.
std::optional<std::vector<std::string>> csv_fields(std::string_view line);

/// Returns the fields of a line of headings; none if a field is, or looks like, a number: 4, +.5, "'4'", nan.
std::optional<std::vector<std::string>> csv_headings(std::string_view line);

/// Returns how a line differs from so many numbers with commas between them: "has semicolons between its
/// numbers".
std::string csv_complaint(std::string_view line, std::size_t numbers);

}  // namespace silt::coupler
