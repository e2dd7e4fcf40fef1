#include "runtime/text/json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace cdot::text {
namespace {

bool is_member(const Json& json) {
  const auto* pair = std::get_if<Json::Array>(&json.value);
  return pair && pair->size() == 2 && std::holds_alternative<std::string>(pair->front().value);
}

nlohmann::ordered_json printable(const Json& json);

struct Printable {
  nlohmann::ordered_json operator()(const Json::Array& array) const {
    nlohmann::ordered_json::array_t all;
    for (const Json& element : array) all.push_back(printable(element));
    return all;
  }
  nlohmann::ordered_json operator()(const Json::Object& object) const {
    nlohmann::ordered_json::object_t all;
    for (const auto& [key, member] : object) all.emplace_back(key, printable(member));
    return all;
  }
  nlohmann::ordered_json operator()(const auto& scalar) const { return scalar; }
};

nlohmann::ordered_json printable(const Json& json) { return std::visit(Printable(), json.value); }

}  // namespace

Json::Json(std::initializer_list<Json> list) {
  if (!std::ranges::all_of(list, is_member)) {
    value = Array(list);
    return;
  }
  Object members;
  for (const Json& pair : list) {
    const Array& both = std::get<Array>(pair.value);
    members.emplace_back(std::get<std::string>(both[0].value), both[1]);
  }
  value = std::move(members);
}

Json Json::of(Value value) {
  Json json;
  json.value = std::move(value);
  return json;
}

Json& Json::operator[](const std::string& key) {
  if (std::holds_alternative<std::nullptr_t>(value)) value = Object();
  auto& members = std::get<Object>(value);
  const auto known = std::ranges::find(members, key, &Object::value_type::first);
  return known != members.end() ? known->second : members.emplace_back(key, Json()).second;
}

Json& Json::push_back(Json element) {
  if (std::holds_alternative<std::nullptr_t>(value)) value = Array();
  return std::get<Array>(value).emplace_back(std::move(element));
}

void Json::update(const Json& other) {
  for (const auto& [key, member] : std::get<Object>(other.value)) (*this)[key] = member;
}

std::string Json::dump(int indent) const {
  return printable(*this).dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string array_of_printed(const std::vector<std::string>& elements) {
  std::string text;
  for (const std::string& element : elements) {
    text += text.empty() ? "[\n  " : ",\n  ";
    for (const char c : element) text += c == '\n' ? "\n  " : std::string(1, c);
  }
  return text.empty() ? "[]" : text + "\n]";
}

}  // namespace cdot::text
