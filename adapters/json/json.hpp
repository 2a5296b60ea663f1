#pragma once
// JSON as a value that is built up and printed: what report.json is made of.
//
//   Json report = Json::object();
//   report["steps"] = 20000;
//   report["stage_seconds"]["stream collide"] = Json::object({{"min", 1.5}, {"max", 1.75}});
//   report["skipped"].push_back("lubrication");
//   file << report.text();
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <list>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace silt::adapters {

/// A JSON value. Objects keep the order in which their keys were first named.
class Json {
 public:
  using Member = std::pair<std::string, Json>;

  Json() = default;  // null
  Json(bool value) : value_(value) {}
  template <std::signed_integral T>
  Json(T value) : value_(static_cast<std::int64_t>(value)) {}
  template <std::unsigned_integral T>
  requires(!std::same_as<T, bool>) Json(T value) : value_(static_cast<std::uint64_t>(value)) {}
  /// A number is printed with the fewest digits that read back to the same bits; NaN and infinities become
  /// null.
  Json(double value) : value_(value) {}
  Json(std::string value) : value_(std::move(value)) {}
  Json(std::string_view value) : value_(std::string(value)) {}
  Json(const char* value) : value_(std::string(value)) {}

  static Json object(std::initializer_list<Member> = {});
  static Json array(std::initializer_list<Json> = {});
  template <class Range>
  static Json array_of(const Range& values) {
    Json a = array();
    for (const auto& v : values) a.push_back(Json(v));
    return a;
  }

  /// The member of that name, added (null) if missing; the reference lasts as long as the object. A null
  /// becomes an object; throws std::logic_error for other values.
  Json& operator[](std::string_view key);
  /// Appends a value. A null becomes an array; throws std::logic_error for other values.
  void push_back(Json);

  /// The numbers of a member, each with its path, "member.key", and as printed; of an array of three
  /// "member.x" and so on. A null is one, with no text: what is not known now. Nothing if there is none.
  std::vector<std::pair<std::string, std::string>> numbers(const std::string& key) const;

  /// The text, indented by two spaces a level; arrays of plain values on one line. Text is UTF-8: bytes that
  /// are not valid become U+FFFD, control characters are escaped.
  std::string text() const;

 private:
  using Object = std::list<Member>;  // a reference to a member outlives those added after it
  using Array = std::vector<Json>;
  void print(std::string& out, int level) const;
  void list_numbers(const std::string& path, std::vector<std::pair<std::string, std::string>>& out) const;
  bool is_plain() const {
    return !std::holds_alternative<Object>(value_) && !std::holds_alternative<Array>(value_);
  }

  std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, Array, Object> value_;
};

}  // namespace silt::adapters
