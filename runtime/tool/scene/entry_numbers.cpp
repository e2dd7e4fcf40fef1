// The numbers of a TOML table: fractions, degrees, ranges, shifts of copies, and what may stand in their place.
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <numbers>

#include "runtime/text/number.hpp"
#include "runtime/tool/scene/entry.hpp"

namespace cdot {
namespace {

// "1/60", and "30 deg" in radians; nothing if the text is neither.
std::optional<double> number_in_text(std::string_view text, bool angle) {
  const std::optional<double> value = text::take_number(text);
  if (value && angle && text == " deg") return *value * std::numbers::pi / 180;
  return text.empty() ? value : std::nullopt;
}

}  // namespace

std::optional<double> Entry::plain_number(const toml::node& node, const std::string& key, Quantity quantity) {
  // value<double>() has no value for whole numbers that a double rounds.
  if (const auto* whole = node.as_integer()) return static_cast<double>(whole->get());
  if (node.is_number()) return node.value<double>();
  if (!node.is_string()) {
    wrong_type(node, key, "a number");
    return {};
  }
  const std::optional<double> value = number_in_text(*node.value<std::string_view>(), quantity.angle);
  if (!value) {
    error(span_of(node.source()), fmt::format("`{}` must be a number, but is a text", key),
          quantity.angle ? "0.5 (rad) or \"30 deg\"" : "0.5, or a fraction as \"1/60\"");
  }
  return value;
}

// Copy k adds k times the shift to number `index` of `key`.
std::optional<double> Entry::shift_of(const std::string& key, std::size_t index) {
  const toml::table* shift = of_copies(shift_key);
  const toml::node* node = shift ? shift->get(key) : nullptr;
  if (!node) return 0;
  const toml::array* array = node->as_array();
  const toml::node* element = array ? array->get(index) : index == 0 ? node : nullptr;
  if (!element) {
    wrong_type(*node, "shift." + key, "shaped as `" + key + "`");
    return {};
  }
  const std::optional<double> step = plain_number(*element, "shift." + key, {Sign::any, true});
  if (!step) return {};
  return *step * copy_;
}

// `node` as a number in its range; `index` says which element of a list it is.
std::optional<double> Entry::shifted_number(const toml::node& node, const std::string& key, std::size_t index,
                                            Quantity quantity) {
  const std::optional<double> start = plain_number(node, key, quantity), shift = shift_of(key, index);
  if (!start || !shift) return {};
  const double value = *start + *shift;
  const char* wrong = nullptr;
  if (quantity.sign == Sign::positive && value <= 0) wrong = "greater than 0";
  if (quantity.sign == Sign::not_negative && value < 0) wrong = "0 or more";
  if (!std::isfinite(value)) wrong = "finite";
  if (!wrong) return value;
  error(span_of(node.source()), fmt::format("`{}` is {}: it must be {}", key, value, wrong));
  return {};
}

std::optional<double> Entry::number(const std::string& key, Quantity quantity) {
  const toml::node* node = find(key);
  if (!node) return {};
  return shifted_number(*node, key, 0, quantity);
}

std::optional<std::vector<double>> Entry::numbers(const std::string& key, std::size_t size, Quantity quantity) {
  const toml::node* node = find(key);
  if (!node) return {};
  const toml::array* array = node->as_array();
  if (!array || array->size() != size) {
    const std::string found = array ? fmt::format("has {}", array->size()) : "is " + type_of(*node);
    error(span_of(node->source()), fmt::format("`{}` must be a list of {} numbers, but {}", key, size, found));
    return {};
  }
  std::vector<double> values;
  for (std::size_t k = 0; k < size; ++k) {
    const std::optional<double> value = shifted_number(*array->get(k), key, k, quantity);
    if (!value) return {};
    values.push_back(*value);
  }
  return values;
}

std::optional<Entry::Written> Entry::written_number(const toml::node& node, const std::string& key, std::size_t index,
                                                    Quantity quantity) {
  const auto* text = node.as_string();
  if (!node.is_table() && !(text && !number_in_text(text->get(), quantity.angle))) {
    const std::optional<double> number = shifted_number(node, key, index, quantity);
    return number ? std::optional(Written{number, {}, nullptr, span_of(node.source())}) : std::nullopt;
  }
  const std::optional<double> shift = shift_of(key, index);
  if (shift && *shift != 0)
    error(span_of(node.source()), fmt::format("`{}` is a function of time, and `shift` moves numbers", key),
          "braces stand for the number of the copy: \"{i} [N] * sin(time / 1 [s])\"");
  if (!shift || *shift != 0) return {};
  if (node.is_table()) return Written{{}, {}, node.as_table(), span_of(node.source())};
  const std::optional<std::string> expression = plain_text(node);
  return expression ? std::optional(Written{{}, *expression, nullptr, span_of(node.source())}) : std::nullopt;
}

std::optional<std::vector<Entry::Written>> Entry::written_numbers(const std::string& key,
                                                                  std::optional<std::size_t> size, Quantity quantity) {
  const toml::node* node = find(key);
  if (!node) return {};
  std::vector<Written> values;
  const toml::array* array = size ? node->as_array() : nullptr;
  if (size && (!array || array->size() != *size)) {
    const std::string found = array ? fmt::format("has {}", array->size()) : "is " + type_of(*node);
    error(span_of(node->source()), fmt::format("`{}` must be a list of {} numbers, but {}", key, *size, found));
    return {};
  }
  for (std::size_t k = 0; k < size.value_or(1); ++k) {
    const std::optional<Written> value = written_number(array ? *array->get(k) : *node, key, k, quantity);
    if (!value) return {};
    values.push_back(*value);
  }
  return values;
}

bool Entry::is_function(const std::string& key, Quantity quantity) {
  const toml::node* node = find(key);
  if (!node) return false;
  if (const auto* text = node->as_string()) return !number_in_text(text->get(), quantity.angle);
  return node->is_table() && node->as_table()->contains("table");
}

Entry Entry::at(const Written& written) const {
  return Entry(*written.table, written.where, fmt::format("the table of {}", what_), *mistakes_, copy_);
}

std::string Entry::beside(const std::string& path) const {
  return (std::filesystem::path(mistakes_->file()).parent_path() / path).string();
}

std::optional<std::vector<double>> Entry::rows(const std::string& key, std::size_t count) {
  const toml::node* node = find(key);
  if (!node) return {};
  std::vector<double> values;
  const toml::array* lists = node->as_array();
  for (std::size_t i = 0; lists && i < lists->size(); ++i) {
    const toml::array* row = lists->get(i)->as_array();
    for (std::size_t j = 0; row && row->size() == 3 && j < 3; ++j) {
      const std::optional<double> value = plain_number(*row->get(j), key, {});
      if (!value) return {};
      values.push_back(*value);
    }
  }
  if (values.size() == 3 * count && lists->size() == count) return values;
  error(span_of(node->source()), fmt::format("`{}` must be {} lists of three numbers", key, count));
  return {};
}

std::optional<int> Entry::whole(const std::string& key, int least) {
  const toml::node* node = find(key);
  if (!node) return {};
  const std::optional<std::int64_t> value = node->value_exact<std::int64_t>();
  if (!value && node->is_number()) {
    error(span_of(node->source()), fmt::format("`{}` is {}: it must be a whole number", key, *node->value<double>()));
  } else if (!value) {
    wrong_type(*node, key, "a whole number");
  }
  if (!value) return {};
  if (*value >= least && *value <= 1'000'000'000) return static_cast<int>(*value);
  error(span_of(node->source()), fmt::format("`{}` is {}: it must be {} or more", key, *value, least));
  return {};
}

}  // namespace cdot
