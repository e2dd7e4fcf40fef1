// A tree of JSON -> text. Members of an object keep the order in which they were added. nlohmann-json prints it, inside
// json.cpp alone: each file that includes that library takes seconds to compile.
#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <ranges>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace cdot::text {

class Json {
 public:
  using Array = std::vector<Json>;
  using Object = std::vector<std::pair<std::string, Json>>;
  using Value = std::variant<std::nullptr_t, bool, std::int64_t, double, std::string, Array, Object>;

  Json(std::nullptr_t = nullptr) {}
  Json(std::same_as<bool> auto truth) : value(truth) {}
  template <std::integral Whole>
  requires(!std::same_as<Whole, bool>) Json(Whole number) : value(static_cast<std::int64_t>(number)) {}
  Json(double number) : value(number) {}
  Json(const char* text) : value(std::string(text)) {}
  Json(std::string_view text) : value(std::string(text)) {}
  Json(const std::string& text) : value(text) {}
  template <std::ranges::range List>
  Json(const List& list) : value(Array(std::ranges::begin(list), std::ranges::end(list))) {}
  // {{"name", value}, …} is an object, {value, …} any other array.
  Json(std::initializer_list<Json> list);

  static Json array() { return of(Array()); }
  static Json object() { return of(Object()); }

  Json& operator[](const std::string& key);  // added if it is not there; null becomes an object
  Json& push_back(Json element);             // the new element; null becomes an array
  void update(const Json& other);            // with the members of another object

  // In one line; with an indent, in one line for each element.
  std::string dump(int indent = -1) const;

  Value value = nullptr;

 private:
  static Json of(Value value);
};

// The elements of an array, each printed with an indent of 2, as an array printed so.
std::string array_of_printed(const std::vector<std::string>& elements);

}  // namespace cdot::text
