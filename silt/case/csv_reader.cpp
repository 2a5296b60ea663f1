#include "silt/case/csv_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>

namespace silt {
namespace {

using View = std::string_view;

constexpr View byte_order_mark = "\xEF\xBB\xBF";  // of UTF-8
constexpr View blanks = " \t";
constexpr View missing_values[] = {"nan", "inf", "infinity", "na", "n/a", "#n/a", "null"};

bool contains(View text, View piece) {
  return text.find(piece) != text.npos;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_control(char c) {
  return std::iscntrl(static_cast<unsigned char>(c)) != 0 && c != '\t';
}

/// Takes a finite number, with a sign or not, off the beginning of a text; returns false for none.
bool take_number(View& text, double& x) {
  const View digits = text.substr(text.size() > 1 && text[0] == '+' && text[1] != '-');
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x);
  if (error != std::errc{} || !std::isfinite(x)) return false;
  text = digits.substr(static_cast<std::size_t>(end - digits.data()));
  return true;
}

View unsigned_part(View text) {
  return text.substr(!text.empty() && (text[0] == '-' || text[0] == '+'));
}

bool stands_for_no_number(View text) {
  std::string small(unsigned_part(text));
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(std::begin(missing_values), std::end(missing_values), small) != std::end(missing_values);
}

/// Returns whether a word is a number or begins like one after signs, quotes etc.: 4, -.5, '4', (4, x=4.
bool looks_like_number(View word) {
  if (stands_for_no_number(word)) return true;
  if (const auto equals = word.rfind('='); equals != word.npos) word.remove_prefix(equals + 1);
  const auto first =
      std::ranges::find_if(word, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; });
  return first != word.end() && is_digit(*first);
}

bool any_word_looks_like_number(View field, View separators) {
  while (!field.empty()) {
    const auto end = std::min(field.find_first_of(separators), field.size());
    if (looks_like_number(trimmed(field.substr(0, end)))) return true;
    field.remove_prefix(std::min(end + 1, field.size()));
  }
  return false;
}

bool is_number(View text) {
  double x = 0;
  text = trimmed(text);
  return take_number(text, x) && text.empty();
}

/// Returns whether `piece` is somewhere between two digits.
bool between_digits(View text, View piece) {
  for (auto at = text.find(piece); at != text.npos; at = text.find(piece, at + 1)) {
    const auto after = at + piece.size();
    if (at > 0 && after < text.size() && is_digit(text[at - 1]) && is_digit(text[after])) return true;
  }
  return false;
}

/// Returns the fault of a field that is not a number.
std::string complaint_of_field(const std::string& field) {
  constexpr View wide_blanks[] = {" ", "\u00A0", "\u2009", "\u202F"};
  double x = 0;
  View rest = field;
  const bool begins_with_number = take_number(rest, x);
  if (field.empty()) return "has an empty field";
  if (stands_for_no_number(field)) return fmt::format("has \"{}\", which is no finite number", field);
  if (contains(field, byte_order_mark)) return "has a byte order mark, as files joined together have";
  if (contains(field, "\u2212")) return "has a minus sign that is not the one of ASCII, -";
  for (const View blank : wide_blanks)
    if (between_digits(field, blank))
      return fmt::format("has a blank within \"{}\", as some put between thousands", field);
  if (between_digits(field, "'") || between_digits(field, "_") || between_digits(field, "\u2019"))
    return fmt::format("has a mark within \"{}\", as some put between thousands", field);
  if (between_digits(field, ","))
    return "has a comma within a number: a decimal comma, or one between thousands";
  if (contains(field, "#")) return "has a comment behind its numbers, which must stand on a line of its own";
  if (contains(field, "=") || contains(field, ":"))
    return fmt::format("has \"{}\", a name with its number", field);
  if (field.find_first_of("'`[](){}<>$\"") != field.npos)
    return fmt::format("has \"{}\", with quotes or brackets around a number", field);
  if (begins_with_number && (rest[0] == 'D' || rest[0] == 'd'))
    return fmt::format("has \"{}\", with an exponent as Fortran writes it: E, not D, goes before it", field);
  if (begins_with_number && (rest[0] == 'x' || rest[0] == 'X'))
    return fmt::format("has \"{}\", a hexadecimal number", field);
  if (begins_with_number) return fmt::format("has \"{}\", a number with something behind it", field);
  if (looks_like_number(field)) return fmt::format("has \"{}\", which is out of range, or no number", field);
  return fmt::format("has \"{}\", which is no number", field);
}

/// Returns the fault of a line due to the program that wrote it, or "".
std::string complaint_of_text(View line) {
  if (line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF"))
    return "begins with a byte order mark of UTF-16: the file must be saved as UTF-8";
  if (contains(line, View("\0", 1)))
    return "has NUL bytes, as text in UTF-16 and binary files have: the file must be text in UTF-8";
  if (std::ranges::any_of(line, is_control)) return "has control characters, as binary files have";
  return "";
}

/// Returns the separators used instead of commas, or "".
std::string complaint_of_separators(View line, std::size_t fields) {
  if (!any_word_looks_like_number(line, " \t;|,")) return "";
  const bool commas = contains(line, ",");
  if (contains(line, ";"))
    return commas ? "has semicolons between its numbers, and commas in them"
                  : "has semicolons between its numbers";
  if (contains(line, "\t"))
    return commas ? "has tabs and commas between its numbers" : "has tabs between its numbers";
  if (contains(line, "|")) return "has bars between its numbers";
  if (fields == 1 && line.find_first_of(blanks) != line.npos) return "has blanks between its numbers";
  return "";
}

/// Takes a field off the beginning of a line, without blanks and quotes (RFC 4180); `quoted` holds the
/// content of quotes. None if a quote does not end or has text beside it.
std::optional<View> take_field(View& line, std::string& quoted) {
  line = trimmed(line);
  const auto end = std::min(line.find(','), line.size());
  if (!line.starts_with('"')) {
    const View field = trimmed(line.substr(0, end));
    line.remove_prefix(end);
    return field;
  }
  quoted.clear();
  for (std::size_t at = 1; at < line.size(); ++at) {
    if (line[at] == '"' && (at + 1 == line.size() || line[at + 1] != '"')) {
      line = trimmed(line.substr(at + 1));
      return line.empty() || line[0] == ',' ? std::optional<View>(quoted) : std::nullopt;
    }
    quoted += line[at];
    at += line[at] == '"';  // a doubled quote is one
  }
  return {};
}

/// Splits a line at its commas; none if a field is invalid.
std::optional<std::vector<std::string>> csv_fields(View line) {
  std::vector<std::string> fields;
  std::string quoted;
  for (;; line.remove_prefix(1)) {
    const auto field = take_field(line, quoted);
    if (!field) return {};
    fields.emplace_back(*field);
    if (line.empty()) return fields;
  }
}

/// Reads a line with exactly these numbers.
bool take_numbers(View line, std::span<double> numbers) {
  std::string quoted;
  for (double& number : numbers) {
    auto field = take_field(line, quoted);
    if (!field) return false;
    View digits = trimmed(*field);
    const bool last = &number == &numbers.back();
    if (!take_number(digits, number) || !digits.empty() || line.empty() != last) return false;
    if (!last) line.remove_prefix(1);
  }
  return true;
}

/// Returns the fields of a heading line; none if one is, or looks like, a number: 4, +.5, "'4'", nan.
std::optional<std::vector<std::string>> csv_headings(View line) {
  auto fields = csv_fields(line);
  if (!fields || !complaint_of_text(line).empty()) return {};
  const View separators = fields->size() == 1 ? " \t;|" : "\t;|";
  for (const std::string& field : *fields)
    if (any_word_looks_like_number(field, separators)) return {};
  const bool all_empty = std::all_of(fields->begin(), fields->end(), std::mem_fn(&std::string::empty));
  return all_empty ? std::nullopt : std::move(fields);
}

/// Returns the difference of a line from comma-separated numbers: "has semicolons between its numbers".
std::string csv_complaint(View line, std::size_t numbers) {
  line = trimmed(line);
  if (const std::string found = complaint_of_text(line); !found.empty()) return found;
  const auto fields = csv_fields(line);
  if (!fields) return "has a quote that does not end there, or text beside one";
  if (const std::string found = complaint_of_separators(line, fields->size()); !found.empty()) return found;
  const bool ends_with_comma = fields->size() > 1 && fields->back().empty();
  if (ends_with_comma && std::all_of(fields->begin(), fields->end() - 1, is_number))
    return "ends with a comma";
  for (const std::string& field : *fields)
    if (!is_number(field)) return complaint_of_field(field);
  if (fields->size() == 2 * numbers)
    return fmt::format("has {} numbers, as {} with decimal commas", fields->size(), numbers);
  return fmt::format("has {} number{}", fields->size(), fields->size() == 1 ? "" : "s");
}

bool counts(std::string_view line) {
  const std::string_view text = trimmed(line);
  return !text.empty() && text[0] != '#';
}

/// Returns the beginning of a line, with question marks for characters that a terminal cannot show.
std::string shown_line(std::string_view line) {
  line = trimmed(line);
  std::size_t end = std::min<std::size_t>(60, line.size());
  while (end < line.size() && (line[end] & 0xC0) == 0x80) --end;  // cut between characters
  std::string text(line.substr(0, end));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7F' || c == '\xFE' || c == '\xFF') c = '?';
  return text;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(blanks);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

CsvReader::CsvReader(std::istream& stream) : stream_(&stream) {
  char mark[byte_order_mark.size()] = {};
  const auto got = static_cast<std::size_t>(stream.rdbuf()->sgetn(mark, std::ssize(byte_order_mark)));
  go_to(View(mark, got) == byte_order_mark ? got : 0);
  for (std::uint64_t begin = at_; take_line(); begin = at_, ++lines_) {
    if (!counts(line_)) continue;
    auto fields = csv_headings(line_);
    if (!fields) {
      go_to(begin);
      break;
    }
    headings_.push_back(std::move(*fields));
  }
}

void CsvReader::go_to(std::uint64_t byte) {
  at_ = byte;
  stream_->rdbuf()->pubseekpos(static_cast<std::streamoff>(at_), std::ios::in);
}

bool CsvReader::take_line() {
  using Traits = std::char_traits<char>;
  std::streambuf& bytes = *stream_->rdbuf();
  line_.clear();
  if (bytes.sgetc() == Traits::eof()) return false;
  for (int c = bytes.sbumpc(); c != Traits::eof(); c = bytes.sbumpc()) {
    ++at_;
    if (c == '\r' && bytes.sgetc() == '\n') continue;
    if (c == '\r' || c == '\n') break;
    line_ += Traits::to_char_type(c);
  }
  return true;
}

void CsvReader::take_part(int part, int parts) {
  const std::uint64_t head = at_;
  const auto end = static_cast<std::uint64_t>(stream_->rdbuf()->pubseekoff(0, std::ios::end, std::ios::in));
  const std::uint64_t begin = head + (end - head) * part / parts;
  end_ = head + (end - head) * (part + 1) / parts;
  if (part > 0) lines_ = 0;
  const bool skips = part > 0 && begin > 0;  // rest of a line of the part before
  go_to(skips ? begin - 1 : begin);
  if (skips) take_line();
}

bool CsvReader::next() {
  while (at_ < end_ && take_line()) {
    ++lines_;
    if (counts(line_)) return true;
  }
  return false;
}

void CsvReader::numbers(std::span<double> numbers, std::string_view must) const {
  if (take_numbers(line_, numbers)) return;
  throw std::invalid_argument(fmt::format("is \"{}\": it {}; it must be {}", shown_line(line_),
                                          csv_complaint(line_, numbers.size()), must));
}

}  // namespace silt
