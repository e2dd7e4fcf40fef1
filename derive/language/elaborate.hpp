// A spec's tree to a Joint: resolves names, bodies and includes, checks types and units. Internal to the reader;
// language/read.hpp is its interface.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "derive/language/evaluate.hpp"
#include "derive/language/read.hpp"
#include "derive/syntax/ast.hpp"
#include "derive/syntax/lexer.hpp"

namespace cdot::derive {

// The value that an including joint gives to a parameter of the included one.
struct Given {
  Value value;
  std::string text;
  bool taken = false;
  bool of_world = false;
};

// One file on its way into the joint: the spec itself, or what it includes.
struct Source {
  std::shared_ptr<const SourceFile> file;
  Tokens tokens;
  JointAst ast;
  std::string prefix;                  // of the names that it brings in
  std::vector<int> bodies;             // what its a, b, ... are here; empty: the same
  std::map<std::string, Given> given;  // its parameters that the including joint gives
  std::optional<Span> include;         // where the spec includes it; empty: it is the spec
  std::vector<std::string> including;  // the files on the way to it
  Diagnostics diagnostics;
  bool clashed = false;  // with names of the spec; errors that follow from that are not reported
  std::map<std::string, Span> declared_anywhere;  // also further down
};

struct Entry {
  Value value;
  std::string kind;  // "point", ..., "let", or "arm"
  Span where;        // in the spec; of what came with an include: the include
  bool included = false;
  bool used = false;
  bool of_world = false;  // fixed in the world, or made of what is
};

class Elaborator {
 public:
  Elaborator(const Library& library, int dimension, const Anchors& anchors);
  void run(Source& spec);
  void finish(ReadResult& result, Source& spec);

 private:
  friend class SourceNames;

  void statements(Source& source);
  // elaborate_include.cpp
  void include(Source& source, const IncludeAst& item);
  bool includable(Source& source, const IncludeAst& item);
  bool same_space(Source& source, const IncludeAst& item, const Source& inner);
  bool map_bodies(Source& source, const IncludeAst& item, Source& inner);
  void give_parameters(Source& source, const IncludeAst& item, Source& inner);
  void check_given(Source& source, const IncludeAst& item, const Source& inner);
  bool take_given(Source& source, const DeclaredAst& d);
  void report_included(Source& source, const IncludeAst& item, const Source& inner);
  // elaborate_declare.cpp
  void declare(Source& source, const DeclaredAst& d);
  bool resolve_body(Source& source, const DeclaredAst& d, Parameter& p);
  bool resolve_unit(Source& source, const DeclaredAst& d, const Value& given, Parameter& p);
  bool resolve_range(Source& source, const DeclaredAst& d, Parameter& p);
  bool default_in_range(Source& source, const DeclaredAst& d, const Value& given, const Parameter& p);
  std::optional<double> bound(Source& source, const Ast& ast, const DeclaredAst& d, const Parameter& p);
  Value default_value(Source& source, const DeclaredAst& d);
  bool default_fits(Source& source, const DeclaredAst& d, Value& given);
  void default_axes(const Value& given, Parameter& p);
  bool build_symbol(Source& source, const DeclaredAst& d, Parameter& p, Value& value);
  bool symbol_is_free(Source& source, const DeclaredAst& d, const std::string& symbol, bool arm);
  bool build_frame(Source& source, const DeclaredAst& d, Role role, Parameter& p, Value& value);
  void let(Source& source, const DeclaredAst& d);
  bool is_component(std::string_view ending) const;
  std::string vector_of_component(const std::string& name) const;
  std::string free_name_like(const std::string& name) const;
  bool name_is_free(Source& source, const Word& word, const std::string& full);
  void enter(Source& source, const std::string& full, std::string kind, Value value, Span where, bool of_world = false);
  // elaborate_row.cpp
  void row(Source& source, const StatementAst& s);
  std::optional<Value> constraint(Source& source, const StatementAst& s);
  void add_row(Source& source, const StatementAst& s, Row row);
  void keep(Source& source, const StatementAst& s, const Row& whole);
  bool row_makes_sense(Source& source, const StatementAst& s, const Value& C);
  Value coordinate_value(Source& source, const StatementAst& s);
  void coordinate(Source& source, const StatementAst& s);
  bool free_of_velocity(Source& source, const Ast& ast, const Value& value, std::string_view place);
  std::string written(const Source& source, const StatementAst& s) const;
  // elaborate_law.cpp
  void energy(Source& source, const StatementAst& s);
  void force(Source& source, const StatementAst& s);
  void limit_force(Source& source, const StatementAst& s, std::size_t at);
  Value law_value(Source& source, const StatementAst& s);
  Expr read_by_inputs(const StatementAst& s, Expr e);
  void coordinate_of_effect(Source& source, const StatementAst& s, const Value& value, Unit unit);
  LawInput& point_input(const std::string& name, const Value& point, Span where);
  LawInput& body_input(int body, bool turns, Span where);
  LawInput& turning_input(Expr leaf, Span where);
  LawInput& add_input(std::string name, Row row, bool has_value);
  LawInput* input_of(const std::string& text);
  Expr leaf_of_input(std::string name, bool vector_input);
  void check_law(Source& spec);
  // elaborate_free.cpp
  void free_coordinate(Source& source, const StatementAst& s);
  const Value& mass();
  const Value* load(const std::string& name);
  const Value& own_load();
  void check_free(Source& spec);
  // elaborate_bound.cpp
  void bound(Source& source, const StatementAst& s);
  void row_of_joint(Source& source, const StatementAst& s);
  bool names_in_kernel(const std::string& name) const;
  bool may_name_row(Source& source, const Word& label);
  std::optional<BoundedRow> bounded_row(Source& source, const StatementAst& s, const Word& coordinate);
  bool numbers_of_bound(Source& source, const StatementAst& s, const Ast& rate, BoundedRow& row);
  bool events(Source& source, const StatementAst& s, BoundedRow& row);
  bool event(Source& source, const ConditionAst& condition, BoundedRow& row, Expr& distance);
  bool are_limits(Source& source, const Ast& where, Expr lower, Expr upper);
  Expr bound_value(Source& source, const Ast& ast, const Unit& unit, const std::vector<Expr>& also);
  const Coordinate* bounded_coordinate(Source& source, const Word& name);
  void drop_idle_inputs();
  // Checks at the end.
  void check_bodies(Source& spec);
  void warn_unused(Source& spec);
  bool arises_in_derivative(Expr e) const;

  Value evaluate(Source& source, const Ast& ast);
  void use_world() { joint_.uses_world = of_world_ = true; }
  // In the spec: at that place; in an include: at the statement that includes it.
  void error(Source& source, Span where, std::string message, std::string fix = {}, std::vector<Span> also = {});
  Span in_spec(const Source& source, Span where) const { return source.include.value_or(where); }

  const Library& library_;
  std::shared_ptr<Pool> pool_;
  const Anchors& anchors_;
  Joint joint_;
  std::map<std::string, Entry> names_;
  std::map<int, Span> bodies_;  // used bodies, and their first place
  std::map<std::string, Span> row_names_, coordinate_names_;
  Diagnostics* spec_diagnostics_ = nullptr;
  std::vector<Span> parameters_where_;
  std::vector<std::shared_ptr<const SourceFile>> included_;
  int include_count_ = 0;
  int row_count_ = 0;
  bool of_world_ = false;       // the statement has named a quantity of the world so far
  bool in_law_ = false;         // the statement is the law of an effect
  bool in_default_ = false;     // of a scalar
  bool of_coordinate_ = false;  // an effect on the coordinate of any joint
  Value mass_, unlimited_;
  BoundedRow* in_bound_ = nullptr;                                     // the row whose bounds of the force are read
  bool in_event_ = false;                                              // of that row
  Value load_;                                                         // in these bounds
  std::map<std::string, Value, std::less<>> law_values_, law_rates_;   // by names of inputs
  std::map<std::string, Coordinate, std::less<>> bounded_candidates_;  // the coordinates of an effect
};

// Scope as one source sees them.
class SourceNames final : public Scope {
 public:
  SourceNames(Elaborator& elaborator, Source& source) : e_(elaborator), source_(source) {}
  const Value* find(const std::string& name) override;
  const Value* rate_of(const std::string& name) override;
  const Value* load_of(const std::string& name) override;
  const Value* mass_of(const std::string& name) override;
  int body(const std::string& letter) const override;
  void use_body(int body, Span where) override;
  void use_world() override { e_.use_world(); }
  // Those not yet used come first: a wrong name most likely means one of them.
  std::vector<std::string> known() const override;
  std::string hint(const std::string& name) const override;

 private:
  Elaborator& e_;
  Source& source_;
};

bool depends_on_role(Expr e, Role role);

// Lexes and parses; errors go into the source's diagnostics.
void parse_source(Source& source);

}  // namespace cdot::derive
