// One TOML table of a scene -> its keys as numbers and texts, with copies; unknown keys are mistakes.
#include "runtime/tool/scene/entry.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>

#include "runtime/tool/scene/keys.hpp"

namespace cdot {
namespace {

constexpr int most_copies = 100000;

}  // namespace

KeyTable keys_of_copies() {
  return {"Copies of a [[body]], [[joint]] or [[spring]]; {i}, {i+1}, {i-1} in a text are the copy's number, from 1",
          {{Entry::repeat_key, "how many there are", "1"},
           {Entry::shift_key, "{ position = [1, 0] }: each copy's numbers differ from the one before by that", ""},
           {Entry::each_key, "{ name = [\"a\", \"b\"] }: the values of a key, one a copy", ""}}};
}

Span span_of(const toml::source_region& region) {
  const int line = static_cast<int>(region.begin.line), begin = static_cast<int>(region.begin.column);
  // A value over several lines is marked from its start to the end of that line.
  const bool one_line = region.end.line == region.begin.line;
  return {line, begin, one_line ? static_cast<int>(region.end.column) : 1 << 20};
}

std::string type_of(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (node.is_array()) return node.is_array_of_tables() ? "a list of tables" : "a list";
  if (node.is_string()) return "a text";
  if (node.is_number()) return "a number";
  if (node.is_boolean()) return "true or false";
  return "a date or time";
}

Entry::Entry(const toml::table& table, Span header, std::string what, Mistakes& mistakes, int copy)
    : table_(&table), header_(header), what_(std::move(what)), mistakes_(&mistakes), copy_(copy) {}

std::vector<Entry> Entry::list(const std::string& key) {
  std::vector<Entry> entries;
  const toml::node* node = find(key);
  if (!node) return entries;
  if (!node->is_array_of_tables()) {
    error(span_of(node->source()), fmt::format("`{}` is {}", key, type_of(*node)),
          fmt::format("start each one with a line [[{}]]", key));
    return entries;
  }
  for (const toml::node& element : *node->as_array()) {
    Entry entry(*element.as_table(), span_of(element.source()), fmt::format("[[{}]]", key), *mistakes_);
    const int copies = entry.whole(repeat_key, 1).value_or(1);
    entry.repeated_ = entry.has(repeat_key);
    entry.check_repeat(copies);
    for (entry.copy_ = 0; entry.copy_ < std::min(copies, most_copies); ++entry.copy_) entries.push_back(entry);
  }
  return entries;
}

// `shift` adds a step from copy to copy, `each` gives one value per copy. Both need `repeat`.
void Entry::check_repeat(int copies) {
  for (const char* key : {shift_key, each_key}) {
    const toml::node* node = find(key);
    if (!node) continue;
    if (!repeated_) error(where(key), fmt::format("`{}` without `repeat`", key), "add repeat = 10");
    if (!node->is_table()) wrong_type(*node, key, "a table, as { position = [1, 0] }");
  }
  if (copies > most_copies) error(where(repeat_key), fmt::format("`repeat` is more than {}", most_copies));
  const toml::table* each = table_->get_as<toml::table>(each_key);
  if (!each) return;
  for (auto&& [key, values] : *each) {
    const std::string name = fmt::format("each.{}", key.str());
    const toml::array* array = values.as_array();
    if (!array) {
      wrong_type(values, name, "a list with one value per copy");
    } else if (static_cast<int>(array->size()) != copies) {
      error(span_of(values.source()), fmt::format("`{}` has {} values for {} copies", name, array->size(), copies));
    }
  }
}

const toml::table* Entry::of_copies(const char* key) const {
  return repeated_ ? table_->get_as<toml::table>(key) : nullptr;
}

const toml::node* Entry::find(const std::string& key) {
  asked_.insert(key);
  const toml::table* each = of_copies(each_key);
  const toml::array* values = each ? each->get_as<toml::array>(key) : nullptr;
  if (values && copy_ < static_cast<int>(values->size())) return values->get(static_cast<std::size_t>(copy_));
  return table_->get(key);
}

bool Entry::has(const std::string& key) { return find(key) != nullptr; }

bool Entry::leaves_table_unread(const std::string& key) const {
  return table_->get_as<toml::table>(key) && !asked_.contains(key);
}

Span Entry::where(const std::string& key) const {
  const toml::node* node = table_->get(key);
  if (const toml::table* each = node ? nullptr : of_copies(each_key)) node = each->get(key);
  return node ? span_of(node->source()) : header_;
}

Span Entry::element(const std::string& key, std::size_t index) {
  const toml::node* node = find(key);
  const toml::node* element = node && node->is_array() ? node->as_array()->get(index) : nullptr;
  return element ? span_of(element->source()) : where(key);
}

void Entry::error(Span where, const std::string& cause, const std::string& fix) const {
  mistakes_->add(where, cause, fix);
}

void Entry::wrong_type(const toml::node& node, const std::string& key, const std::string& wanted) const {
  error(span_of(node.source()), fmt::format("`{}` must be {}, but is {}", key, wanted, type_of(node)));
}

std::optional<bool> Entry::flag(const std::string& key) {
  const toml::node* node = find(key);
  if (!node) return {};
  const std::optional<bool> value = node->value_exact<bool>();
  if (!value) wrong_type(*node, key, "true or false");
  return value;
}

// In a repeated entry {i}, {i+1}, {i-2} stand for the number of the copy, from 1.
std::optional<std::string> Entry::substituted(const std::string& text, Span where) const {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t open = std::min(text.find('{', at), text.size());
    result += text.substr(at, open - at);
    if (open == text.size()) break;
    const std::size_t close = text.find('}', open);
    const std::string inside = close == std::string::npos ? "" : text.substr(open + 1, close - open - 1);
    int offset = 0;
    const char *first = inside.data() + (inside.starts_with("i+") ? 2 : 1), *last = inside.data() + inside.size();
    const bool plain = inside == "i";
    const bool offset_fine = inside.size() > 2 && inside.size() < 10 && inside[0] == 'i' &&
                             (inside[1] == '+' || inside[1] == '-') && std::from_chars(first, last, offset).ptr == last;
    if (!repeated_ || !(plain || offset_fine)) {
      error(where, fmt::format("\"{}\": braces stand for the number of a copy", text),
            repeated_ ? "write {i}, {i+1} or {i-1}" : "add `repeat = 10`, or leave the braces out");
      return {};
    }
    result += std::to_string(copy_ + 1 + offset);
    at = close + 1;
  }
  return result;
}

std::optional<std::string> Entry::plain_text(const toml::node& node) {
  return substituted(std::string(*node.value<std::string_view>()), span_of(node.source()));
}

std::optional<std::string> Entry::text(const std::string& key) {
  const toml::node* node = find(key);
  if (!node) return {};
  if (node->is_string()) return plain_text(*node);
  wrong_type(*node, key, "a text in quotes");
  return {};
}

std::string Entry::written(const std::string& key) {
  const toml::node* node = find(key);
  return toml::node_view(node).value_or(std::string());
}

std::optional<std::vector<std::string>> Entry::texts(const std::string& key) {
  const toml::node* node = find(key);
  if (!node) return {};
  if (!node->is_array()) {
    wrong_type(*node, key, "a list of texts, as [\"a\", \"b\"]");
    return {};
  }
  std::vector<std::string> result;
  for (const toml::node& element : *node->as_array()) {
    if (!element.is_string()) wrong_type(element, key, "a list of texts");
    const auto text = element.is_string() ? plain_text(element) : std::nullopt;
    if (!text) return {};
    result.push_back(*text);
  }
  return result;
}

std::optional<Entry> Entry::table(const std::string& key, const std::string& example) {
  const toml::node* node = find(key);
  if (node && node->is_table())
    return Entry(*node->as_table(), span_of(node->source()), fmt::format("`{}` of {}", key, what_), *mistakes_, copy_);
  if (node && !example.empty()) error(where(key), fmt::format("`{}` must be a table", key), example);
  return {};
}

bool Entry::is_table(const std::string& key) { return toml::node_view(find(key)).is_table(); }

bool Entry::is_array(const std::string& key) { return toml::node_view(find(key)).is_array(); }

bool Entry::is_array_of_arrays(const std::string& key) { return toml::node_view(find(key))[0].is_array(); }

std::optional<std::string> Entry::choice(const std::string& key, const std::vector<std::string>& allowed) {
  const std::optional<std::string> value = text(key);
  if (!value || std::find(allowed.begin(), allowed.end(), *value) != allowed.end()) return value;
  error(where(key), fmt::format("unknown {} \"{}\"", key, *value), did_you_mean(*value, allowed));
  return {};
}

void Entry::required(const std::string& key, const std::string& fix) {
  if (!has(key)) error(header_, fmt::format("{} has no `{}`", what_, key), fix);
}

std::vector<std::string> Entry::unread() const {
  std::vector<std::string> keys;
  for (auto&& [key, node] : *table_)
    if (!asked_.contains(std::string(key.str()))) keys.emplace_back(key.str());
  return keys;
}

void Entry::close(const std::vector<std::string>& also_known) const {
  std::vector<std::string> known(also_known);
  for (const std::string& key : asked_) {
    const bool only_repeated = key == shift_key || key == each_key;
    if (!only_repeated || repeated_) known.push_back(key);
  }
  for (auto&& [key, node] : *table_) {
    const std::string name(key.str());
    if (asked_.contains(name)) continue;
    error(span_of(key.source()), fmt::format("unknown key `{}` in {}", name, what_), did_you_mean(name, known));
  }
  const std::vector<std::string> shiftable(asked_.begin(), asked_.end());
  for (const char* list : {shift_key, each_key}) {
    const toml::table* inner = of_copies(list);
    if (!inner) continue;
    for (auto&& [key, node] : *inner) {
      const std::string name(key.str());
      if (asked_.contains(name)) continue;
      error(span_of(key.source()), fmt::format("unknown key `{}.{}` in {}", list, name, what_),
            did_you_mean(name, shiftable));
    }
  }
}

}  // namespace cdot
