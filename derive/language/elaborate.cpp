#include "derive/language/elaborate.hpp"

#include <algorithm>

#include "derive/expression/symbols.hpp"
#include "derive/syntax/parser.hpp"

namespace cdot::derive {
namespace {

bool valid_name_of_file(const SourceFile& file, const std::string& name) {
  const std::filesystem::path path(file.path);
  return !is_spec(path) || path.stem() == name;
}

}  // namespace

bool depends_on_role(Expr e, Role role) {
  const std::vector<Expr> parts = topological(std::span<const Expr>(&e, 1));
  return std::any_of(parts.begin(), parts.end(), [&](Expr p) { return p->kind == Kind::symbol && p->role == role; });
}

void parse_source(Source& source) {
  source.tokens = lex(*source.file, false, source.diagnostics);
  if (!source.tokens.readable) return;
  source.ast = parse_joint(*source.file, source.tokens, source.diagnostics);
  for (const StatementAst& s : source.ast.statements)
    if (!s.declared.name.text.empty() && s.kind != StatementAst::Kind::coordinate)
      source.declared_anywhere.emplace(s.declared.name.text, s.declared.name.where);
}

Elaborator::Elaborator(const Library& library, int dimension, const Anchors& anchors)
    : library_(library), pool_(std::make_shared<Pool>(dimension)), anchors_(anchors) {
  joint_.pool = pool_;
  joint_.dimension = dimension;
  unlimited_ = scalar(unlimited_symbol(*pool_), std::nullopt);
}

void Elaborator::error(Source& source, Span where, std::string message, std::string fix, std::vector<Span> also) {
  if (source.include) {
    where = *source.include;
    source.clashed = true;
  }
  spec_diagnostics_->error(where, std::move(message), std::move(fix), std::move(also));
}

Value Elaborator::evaluate(Source& source, const Ast& ast) {
  SourceNames names(*this, source);
  return Evaluator(*pool_, names, source.diagnostics)(ast);
}

void Elaborator::run(Source& spec) {
  spec_diagnostics_ = &spec.diagnostics;
  joint_.name = spec.ast.name.text;
  joint_.title = spec.ast.title;
  joint_.source = spec.ast.source;
  joint_.comment = spec.ast.comment;
  joint_.file = spec.file;
  if (spec.ast.effect) joint_.law.emplace();
  of_coordinate_ = spec.ast.dimension == "coordinate" || spec.ast.dimension == "joint";
  if (joint_.law && spec.ast.dimension == "joint") {
    joint_.law->on_joint = true;
    joint_.law->free = Coordinate{"joint", {}, Unit{.any = 1}, spec.ast.name.where, "of any kind", "", {}, false};
  }
  spec.including = {spec.ast.name.text};
  statements(spec);
  if (is_word_of_cpp(joint_.name))
    spec.diagnostics.error(spec.ast.name.where,
                           quote(joint_.name) + " is a C++ keyword: the generated kernel cannot use it",
                           "choose another name");
  if (!spec.ast.name.text.empty() && !valid_name_of_file(*spec.file, spec.ast.name.text))
    spec.diagnostics.warning(spec.ast.name.where, "the file is not named after its joint " + quote(spec.ast.name.text),
                             "name it " + spec.ast.name.text + (spec.ast.effect ? ".effect" : ".joint"));
  check_bodies(spec);
  // Coordinates alone are enough: a scene may add a row by an effect.
  if (joint_.law) check_law(spec);
  else if (joint_.rows.empty() && joint_.coordinates.empty() && !spec.diagnostics.has_errors())
    spec.diagnostics.error(spec.ast.name.where, "the joint has neither a row nor a coordinate: it constrains nothing",
                           "add a row, such as pa = pb, or a coordinate");
  warn_unused(spec);
}

void Elaborator::statements(Source& source) {
  for (const StatementAst& s : source.ast.statements) {
    of_world_ = false;
    switch (s.kind) {
      case StatementAst::Kind::include: include(source, s.include); break;
      case StatementAst::Kind::declare: declare(source, s.declared); break;
      case StatementAst::Kind::let: let(source, s.declared); break;
      case StatementAst::Kind::row: row(source, s); break;
      case StatementAst::Kind::coordinate: coordinate(source, s); break;
      case StatementAst::Kind::energy: energy(source, s); break;
      case StatementAst::Kind::force: force(source, s); break;
      case StatementAst::Kind::bound: bound(source, s); break;
    }
  }
}

// Bodies are used in their order, and their letters name nothing else.
void Elaborator::check_bodies(Source& spec) {
  if (bodies_.empty()) return;
  const auto last = *bodies_.rbegin();
  for (int i = 0; i < last.first; ++i)
    if (!bodies_.contains(i)) {
      spec.diagnostics.error(last.second,
                             "body " + quote(body_name(last.first)) + " is used, but not " + quote(body_name(i)),
                             "bodies are a, b, c, ... in that order");
      break;
    }
  for (const auto& [body, where] : bodies_)
    if (const auto entry = names_.find(body_name(body)); entry != names_.end())
      spec.diagnostics.error(entry->second.where,
                             quote(body_name(body)) + " is a body here, so it cannot be a " + entry->second.kind,
                             "choose another name", {where});
  for (int i = 0; i <= last.first; ++i) joint_.bodies.push_back(body_name(i));
}

// The direction of a vector arises from its length by differentiation, so a row may use its name without writing it.
bool Elaborator::arises_in_derivative(Expr e) const {
  if (e->kind != Kind::unit) return false;
  const Expr length = norm(e->args[0]);
  std::vector<Expr> rows;
  for (const Row& r : joint_.rows) rows.push_back(r.C);
  const std::vector<Expr> parts = topological(rows);
  return std::find(parts.begin(), parts.end(), length) != parts.end();
}

void Elaborator::warn_unused(Source& spec) {
  if (spec.diagnostics.has_errors()) return;
  std::set<int> used_arms;  // a point is used if its arm is
  for (const auto& [name, entry] : names_)
    if (entry.kind == "arm" && entry.used) used_arms.insert(entry.where.begin);
  for (const auto& [name, entry] : names_) {
    if (entry.used || entry.included || entry.kind == "arm" || entry.value.type == Type::poison ||
        used_arms.contains(entry.where.begin))
      continue;
    if (entry.kind == "let" && arises_in_derivative(entry.value.e)) continue;
    spec.diagnostics.warning(entry.where, "the " + entry.kind + " " + quote(name) + " is not used", "remove it");
  }
}

void Elaborator::finish(ReadResult& result, Source& spec) {
  for (const auto& [name, entry] : names_) result.names.emplace(name, entry.value);
  spec.diagnostics.sort();
  result.diagnostics = spec.diagnostics;
  result.included = std::move(included_);
  if (!result.diagnostics.has_errors()) result.joint = std::move(joint_);
}

const Value* SourceNames::find(const std::string& name) {
  if (name == "unlimited" && e_.in_default_) return &e_.unlimited_;
  const auto found = e_.names_.find(source_.prefix + name);
  if (found == e_.names_.end() || found->second.kind == "rate") return nullptr;
  if (!e_.in_law_ && found->second.kind == "coordinate" && !e_.of_coordinate_) return nullptr;
  found->second.used = true;
  const Value& value = found->second.value;
  if (e_.in_law_ && value.type == Type::point && value.body >= 0) {
    e_.point_input(name, value, found->second.where);
    return &e_.law_values_.at(name);
  }
  e_.of_world_ |= found->second.of_world;
  return &value;
}

const Value* SourceNames::load_of(const std::string& name) { return e_.load(name); }

// The effective mass of the coordinate that an effect acts on.
const Value* SourceNames::mass_of(const std::string& name) {
  if (!e_.joint_.on_any_coordinate() || e_.joint_.law->free->name != name || !find(name)) return nullptr;
  return &e_.mass();
}

const Value* SourceNames::rate_of(const std::string& name) {
  if (!e_.in_law_) return nullptr;
  const auto entry = e_.names_.find(name);
  if (entry != e_.names_.end() && entry->second.kind == "rate") entry->second.used = true;
  else if (!find(name)) return nullptr;
  const auto rate = e_.law_rates_.find(name);
  return rate == e_.law_rates_.end() ? nullptr : &rate->second;
}

int SourceNames::body(const std::string& letter) const {
  const int body = body_of_letter(letter);
  if (body < 0 || source_.bodies.empty()) return body;
  return body < static_cast<int>(source_.bodies.size()) ? source_.bodies[static_cast<std::size_t>(body)] : -1;
}

void SourceNames::use_body(int body, Span where) { e_.bodies_.emplace(body, e_.in_spec(source_, where)); }

std::vector<std::string> SourceNames::known() const {
  std::vector<std::string> names, others = {"time", "world"};
  for (const auto& [name, entry] : e_.names_)
    if (e_.in_law_ || entry.kind != "coordinate") (entry.used ? others : names).push_back(name);
  names.insert(names.end(), others.begin(), others.end());
  return names;
}

std::string SourceNames::hint(const std::string& name) const {
  if (const auto known = e_.names_.find(name); known != e_.names_.end() && known->second.kind == "coordinate")
    return "only the law of an effect reads coordinates: write the expression of " + quote(name) + " here";
  if (const auto known = e_.names_.find(name); known != e_.names_.end() && known->second.kind == "rate")
    return "it has a rate, but no value: write rate(" + name + ") in the law";
  if (name == "unlimited") return "the default of a scalar may be unlimited: scalar most [N] = unlimited";
  if (const std::string vector = e_.vector_of_component(name); !vector.empty())
    return "did you mean " + quote(vector + "." + name.back()) + "?";
  if (name == "C") return "a row is an equation: write pa - pb = 0, with a name C: pa - pb = 0";
  if (name.size() > 2 && name[name.size() - 2] == '_' && body(name.substr(name.size() - 1)) >= 0) {
    static const std::map<std::string, std::string> quantities = {
        {"theta", "angle"}, {"phi", "angle"}, {"angle", "angle"}, {"x", "x"}, {"v", "v"}, {"w", "w"}, {"omega", "w"}};
    const auto known = quantities.find(name.substr(0, name.size() - 2));
    if (known != quantities.end()) return "did you mean `" + known->second + "(" + name.back() + ")`?";
  }
  const auto below = source_.declared_anywhere.find(name);
  if (below == source_.declared_anywhere.end()) {
    for (const auto& [other, entry] : e_.names_)
      if (entry.included && other.ends_with("_" + name)) return "did you mean " + quote(other) + ", from the include?";
    return {};
  }
  return quote(name) + " is declared only in line " + std::to_string(source_.file->line(below->second.begin)) +
         "; move that up";
}

}  // namespace cdot::derive
