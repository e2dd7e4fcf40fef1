#include "derive/language/hand/names.hpp"

#include <algorithm>
#include <array>

#include "derive/expression/symbols.hpp"
#include "derive/syntax/lexer.hpp"

namespace cdot::derive {
namespace {

constexpr std::array special = {"E", "C", "Cdot", "J", "K", "lambda"};

bool is_special(const std::string& name) { return std::find(special.begin(), special.end(), name) != special.end(); }

}  // namespace

void HandNames::begin_part(std::vector<std::string> rows) {
  rows_ = std::move(rows);
  said_.clear();
  generated_now_.reset();
}

bool HandNames::is_free(const Word& name, Diagnostics& diagnostics) const {
  const bool of_spec = read_.names.contains(name.text);
  if (!of_spec && !own_.contains(name.text) && !is_special(name.text) && !is_symbol_of_tool(name.text)) return true;
  diagnostics.error(name.where, quote(name.text) + (of_spec ? " is already a name of the spec" : " is already defined"),
                    "choose another name");
  return false;
}

const Value* HandNames::find(const std::string& name) {
  if (const auto own = own_.find(name); own != own_.end()) return &own->second;
  if (const auto spec = read_.names.find(name); spec != read_.names.end()) return &spec->second;
  if (const auto said = said_.find(name); said != said_.end()) return &said->second;
  return is_special(name) ? &(said_[name] = quantity(name)) : nullptr;
}

// The rate of a coordinate of an effect.
const Value* HandNames::rate_of(const std::string& name) {
  const auto& law = read_.joint->law;
  if (!law) return nullptr;
  const auto input = std::ranges::find(law->inputs, name, &LawInput::name);
  const auto spec = read_.names.find(name);
  if (input == law->inputs.end() || spec == read_.names.end() || spec->second.type != Type::scalar) return nullptr;
  return &(rates_[name] = scalar(input->rate, input->unit / Unit{.s = 1}));
}

// A quantity that the entry does not define itself.
Value HandNames::quantity(const std::string& name) {
  if (name == "E") return of_matrix({0, 0, {read_.joint->pool->number(1)}});
  if (!generated_now_) generated_now_ = generated_(rows_);
  if (name == "lambda") return lambda();
  return simplest(name == "C"      ? generated_now_->C
                  : name == "Cdot" ? generated_now_->Cdot
                  : name == "J"    ? generated_now_->J
                                   : generated_now_->K);
}

// A number for one row, a column for several.
Value HandNames::lambda() const {
  const int rows = generated_now_->C.rows;
  Matrix column{rows, 1, {}};
  for (int i = 1; i <= rows; ++i)
    column.entries.push_back(
        read_.joint->pool->symbol(rows == 1 ? "lambda" : "lambda_" + std::to_string(i), Role::multiplier));
  return simplest(std::move(column));
}

int HandNames::body(const std::string& letter) const {
  const int body = body_of_letter(letter);
  return body < static_cast<int>(read_.joint->bodies.size()) ? body : -1;
}

std::string HandNames::bodies() const { return "the joint has " + listed(read_.joint->bodies); }

std::vector<std::string> HandNames::known() const {
  std::vector<std::string> all = {"time", "pi", "world"};
  all.insert(all.end(), special.begin(), special.end());
  for (const auto& [name, value] : own_) all.push_back(name);
  for (const auto& [name, value] : read_.names) all.push_back(name);
  return all;
}

std::string HandNames::hint(const std::string& name) const {
  using Kind = HandItemAst::Kind;
  for (const HandItemAst& item : ast_.items) {
    const bool listed =
        std::any_of(item.names.begin(), item.names.end(), [&](const Word& w) { return w.text == name; });
    if ((item.kind == Kind::let && item.word.text == name) || (item.kind == Kind::free && listed))
      return quote(name) + " is declared only in line " + std::to_string(file_.file->line(item.where.begin)) +
             "; move that up";
  }
  return body_of_letter(name) < 0 ? "" : bodies() + "; let and free declare other names";
}

}  // namespace cdot::derive
