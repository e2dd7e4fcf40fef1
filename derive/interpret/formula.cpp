// Text -> tokens -> tree -> typed, unit-checked expression -> components -> program -> tape.
#include "derive/interpret/formula.hpp"

#include <algorithm>
#include <map>

#include "derive/derivation/derivation.hpp"
#include "derive/expression/components.hpp"
#include "derive/expression/symbols.hpp"
#include "derive/interpret/program_in_time.hpp"
#include "derive/interpret/tape.hpp"
#include "derive/language/evaluate.hpp"
#include "derive/syntax/parser.hpp"

namespace cdot {
namespace {

using namespace derive;

constexpr int most_bodies_named = 26;  // the pool names bodies by letters

// "pin", "pin.angle", "rate(pin.angle)": the written form of a quantity; empty for other trees.
std::string written_name(const Ast& ast) {
  if (ast.kind == Ast::Kind::name) return ast.text;
  const std::string inner = ast.args.size() == 1 ? written_name(ast.args[0]) : "";
  if (inner.empty()) return "";
  if (ast.kind == Ast::Kind::member) return inner + "." + ast.text;
  return ast.kind == Ast::Kind::call ? ast.text + "(" + inner + ")" : "";
}

std::optional<Unit> unit_of(std::string_view text) {
  if (text.empty() || text == "1") return Unit{};
  const SourceFile file("", "[" + std::string(text) + "]");
  Diagnostics none;
  const Tokens tokens = lex(file, false, none);
  const std::optional<WrittenUnit> unit = Parser(file, tokens, false, none).unit();
  return unit ? std::optional(unit->unit) : std::nullopt;
}

class Names final : public Scope {
 public:
  Names(Pool& pool, const Vocabulary& vocabulary) : pool_(pool), vocabulary_(vocabulary) {
    for (std::size_t k = 0; k < vocabulary.quantities.size(); ++k)
      index_.emplace(vocabulary.quantities[k].name, static_cast<int>(k));
    origin_ = vector(zero_vector(pool), Unit{.m = 1});
    origin_.type = Type::point;
    origin_.arm = origin_.e;
    origin_.anchored = true;
  }

  // Turns every written quantity into one name. "rate(pin.agnle)" and "pin.agnle" are mistakes.
  void join(Ast& ast, Diagnostics& diagnostics) const {
    const std::string name = written_name(ast);
    if (ast.kind != Ast::Kind::name && index_.contains(name)) {
      ast.kind = Ast::Kind::name, ast.text = name;
      ast.args.clear();
    } else if (is_almost_a_quantity(ast)) {
      diagnostics.error(ast.where, "there is no " + quote(name), hint(name));
      ast = {};
    }
    for (Ast& part : ast.args) join(part, diagnostics);
  }

  const Value* find(const std::string& name) override {
    const auto known = index_.find(name);
    if (known == index_.end()) return name == "origin" && has_origin() ? &origin_ : nullptr;
    const auto [at, is_new] = values_.emplace(name, Value{});
    if (!is_new) return &at->second;
    const Vocabulary::Quantity& q = vocabulary_.quantities[static_cast<std::size_t>(known->second)];
    const std::string symbol = "q" + std::to_string(known->second);
    const std::optional<Unit> unit = unit_of(q.unit);
    at->second = q.vector ? vector(pool_.vector_symbol(symbol, Role::given, known->second), unit)
                          : scalar(pool_.symbol(symbol, Role::given, known->second), unit);
    return &at->second;
  }

  // Bodies get their numbers in the order of their first use.
  int body(const std::string& name) const override {
    if (std::ranges::find(vocabulary_.bodies, name) == vocabulary_.bodies.end()) return -1;
    auto at = std::ranges::find(bodies_, name);
    if (at == bodies_.end() && bodies_.size() == most_bodies_named) return -1;
    if (at == bodies_.end()) at = bodies_.insert(at, name);
    return static_cast<int>(at - bodies_.begin());
  }
  void use_body(int, Span) override {}
  void use_world() override {}
  std::vector<std::string> known() const override {
    std::vector<std::string> names = vocabulary_.bodies;
    for (const Vocabulary::Quantity& q : vocabulary_.quantities) names.push_back(q.name);
    names.insert(names.end(), {"time", "pi", "world"});
    if (has_origin()) names.push_back("origin");
    return names;
  }
  std::string hint(const std::string& name) const override {
    if (bodies_.size() == most_bodies_named && std::ranges::count(vocabulary_.bodies, name) > 0)
      return "one expression may name 26 bodies";
    const std::string near = nearest(name, known());
    if (!near.empty()) return "did you mean `" + near + "`?";
    const std::vector<std::string> all = known();
    if (all.size() > 12) return "`cdot-run list` shows the coordinates of joints; bodies and joints have their names";
    return "known are " + listed(all);
  }

  bool is_almost_a_quantity(const Ast& ast) const {
    if (written_name(ast).empty()) return false;
    const bool call = ast.kind == Ast::Kind::call;
    const bool member = ast.kind == Ast::Kind::member && ast.args[0].kind == Ast::Kind::name;
    if (call ? is_operator(ast.text) : !member || std::ranges::count(vocabulary_.bodies, ast.args[0].text) > 0)
      return false;
    const std::string start = call ? ast.text + "(" : ast.args[0].text + ".";
    return std::ranges::any_of(vocabulary_.quantities, [&](const auto& q) { return q.name.starts_with(start); });
  }

  int index_of_body(int body) const {
    const auto at = std::ranges::find(vocabulary_.bodies, bodies_[static_cast<std::size_t>(body)]);
    return static_cast<int>(at - vocabulary_.bodies.begin());
  }

 private:
  // Places are of bodies, whose names come first.
  bool has_origin() const {
    return !vocabulary_.bodies.empty() && std::ranges::count(vocabulary_.bodies, "origin") == 0;
  }

  Pool& pool_;
  const Vocabulary& vocabulary_;
  Value origin_;
  std::map<std::string, int> index_;
  std::map<std::string, Value> values_;
  mutable std::vector<std::string> bodies_;
};

Formula::Input input_of(Expr leaf, const Names& names) {
  using Of = Formula::Input::Of;
  const std::string& name = leaf->symbol;
  // The component's letter is the last one; an axis in space ends with two: "axis_a_x_y".
  const auto letter = [&](std::size_t from_end) {
    const std::size_t k = std::string_view("xyz").find(name[name.size() - from_end]);
    return k == std::string::npos ? 0 : static_cast<int>(k);
  };
  const bool vector = name.size() > 2 && name[name.size() - 2] == '_' && name.back() >= 'x' && name.back() <= 'z';
  if (leaf->role == Role::time) return {Of::time, -1, 0};
  if (leaf->role == Role::given) return {Of::quantity, leaf->body, vector ? letter(1) : 0};
  const int body = names.index_of_body(leaf->body);
  switch (leaf->role) {
    case Role::position: return {Of::position, body, letter(1)};
    case Role::velocity: return {Of::velocity, body, letter(1)};
    case Role::angle: return {Of::angle, body, 0};
    case Role::spin: return {Of::spin, body, vector ? letter(1) : 0};
    default: return {Of::axis, body, leaf->pool->dimension() == 2 ? letter(1) : 3 * letter(3) + letter(1)};
  }
}

// The value, or poison with an error in `diagnostics`.
Value value_of(const SourceFile& file, Names& names, Pool& pool, Diagnostics& diagnostics) {
  const Tokens tokens = lex(file, false, diagnostics);
  if (diagnostics.has_errors()) return {};
  Parser parser(file, tokens, false, diagnostics);
  Ast ast = parser.expression();
  parser.end_of_statement();
  if (diagnostics.has_errors()) return {};
  names.join(ast, diagnostics);
  if (diagnostics.has_errors()) return {};
  Value value = Evaluator(pool, names, diagnostics)(ast);
  if (value.type != Type::poison && value.type != Type::scalar)
    diagnostics.error(ast.where, "this is " + std::string(in_words(value.type)) + ", and a number is needed",
                      value.type == Type::vector  ? "take a component, .x or .y, or the length, norm(u)"
                      : value.type == Type::point ? "a component of its way from another point: (x(rod) - origin).y"
                                                  : "");
  return value;
}

void check_unit(const SourceFile& file, const Value& value, std::string_view unit, Diagnostics& diagnostics) {
  if (unit.empty() || diagnostics.has_errors() || !value.unit) return;
  const std::optional<Unit> wanted = unit_of(unit);
  Value like = value;
  like.unit = wanted, like.ratio = false;
  if (same_unit(value, like)) return;
  diagnostics.error({0, static_cast<int>(file.text.size())},
                    "this is in " + spoken(*value.unit) + ", and " + spoken(*wanted) + " are needed",
                    "numbers take their unit in brackets: 10 [" + std::string(unit) + "], 2 [rad/s] * time");
}

// The value of a text, or its mistakes.
Value read_value(std::string_view text, Names& names, Pool& pool, std::string_view unit,
                 std::vector<FormulaMistake>& mistakes) {
  const SourceFile file("", std::string(text));
  Diagnostics diagnostics;
  const Value value = value_of(file, names, pool, diagnostics);
  check_unit(file, value, unit, diagnostics);
  diagnostics.sort();
  for (const Diagnostic& d : diagnostics.list)
    if (d.severity == Severity::error) mistakes.push_back({d.where.begin, d.where.end, d.message, d.fix});
  return value;
}

constexpr int most_registers = 512;  // of a formula of the time, on the stack

FormulaMistake too_far_from_one(std::string_view text) {
  return {0, static_cast<int>(text.size()),
          "a product of its numbers, in its value or a derivative, is above 1e18 or below 1e-18",
          "numbers nearer to 1, by another unit of length or of time"};
}

}  // namespace

struct Formula::Program {
  NamedTape tape;
  std::vector<double> registers;
};

Formula::Reading Formula::read(std::string_view text, const Vocabulary& vocabulary, std::string_view unit) {
  const RoundedNumbers in_doubles;
  Pool pool(vocabulary.dimension);
  Names names(pool, vocabulary);
  Reading reading;
  const Value value = read_value(text, names, pool, unit, reading.mistakes);
  if (!reading.mistakes.empty()) return reading;
  Formula formula;
  formula.unit_ = derive::text(value.unit.value_or(unit_of(unit).value_or(Unit{})));
  formula.program_ = std::make_shared<Program>();
  try {
    Components components;
    formula.program_->tape = NamedTape(assemble({{"value", components.of(value.e)}}));
  } catch (const NumberTooLarge&) {
    reading.mistakes.push_back(too_far_from_one(text));
    return reading;
  }
  formula.program_->registers = formula.program_->tape.registers();
  for (const std::string& name : formula.program_->tape.inputs())
    formula.inputs_.push_back(input_of(pool.find(name), names));
  reading.formula = std::move(formula);
  return reading;
}

double Formula::operator()(std::span<const double> inputs) const {
  double value = 0;
  program_->tape.run(inputs, program_->registers, {&value, 1});
  return value;
}

struct FormulaInTime::Program {
  NamedTape tape;
};

ProgramInTime program_in_time(std::string_view text, std::string_view unit) {
  const RoundedNumbers in_doubles;
  const auto pool = std::make_shared<Pool>(2);
  const Vocabulary no_words;
  Names names(*pool, no_words);
  ProgramInTime read;
  const Value value = read_value(text, names, *pool, unit, read.mistakes);
  if (!read.mistakes.empty()) return read;
  Joint nothing;
  nothing.pool = pool;
  try {
    const Expr rate = time_derivative(value.e, nothing), acceleration = time_derivative(rate, nothing);
    Components components;
    read.program = assemble({{"value", components.of(value.e)},
                             {"rate", components.of(rate)},
                             {"acceleration", components.of(acceleration)}});
  } catch (const NumberTooLarge&) {
    read.mistakes.push_back(too_far_from_one(text));
  }
  return read;
}

FormulaInTime::Reading FormulaInTime::read(std::string_view text, std::string_view unit) {
  ProgramInTime written = program_in_time(text, unit);
  Reading reading{{}, std::move(written.mistakes)};
  if (!reading.mistakes.empty()) return reading;
  auto program = std::make_shared<Program>();
  program->tape = NamedTape(written.program);
  const int length = static_cast<int>(text.size());
  if (program->tape.tape().registers > most_registers)
    reading.mistakes.push_back({0, length, "the expression with its derivatives has more than 512 operations",
                                "a table: { table = \"profile.csv\", column = \"F\" }"});
  if (!reading.mistakes.empty()) return reading;
  FormulaInTime formula;
  formula.constant_ = program->tape.inputs().empty();
  formula.program_ = std::move(program);
  reading.formula = std::move(formula);
  return reading;
}

std::array<double, 3> FormulaInTime::at(double time) const {
  const NamedTape& tape = program_->tape;
  std::array<double, most_registers> registers;
  place_constants(tape.tape(), registers.data());
  std::array<double, 3> values{};
  tape.run(std::span(&time, constant_ ? 0 : 1), registers, values);
  return values;
}

}  // namespace cdot
