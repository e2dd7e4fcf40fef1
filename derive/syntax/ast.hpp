// The syntax tree: every node has its place in the text. The parser looks up no names.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "derive/expression/rational.hpp"
#include "derive/expression/unit.hpp"
#include "derive/syntax/source.hpp"

namespace cdot::derive {

// A unit as written: `deg` is a radian with the factor pi/180.
struct WrittenUnit {
  Unit unit;
  int degrees = 0;  // power of pi/180
  Span where;
};

// A name and where it stands; an empty text where the parser missed one.
struct Word {
  std::string text;
  Span where;
};

struct Ast {
  enum class Kind {
    broken,     // reported already
    number,     // value [unit]
    name,       // text
    call,       // text(args...)
    sum,        // args joined by ops '+' and '-'; ops[0] is '+'
    product,    // args joined by ops '*' and '/'; ops[0] is '*'
    negate,     // -args[0]
    power,      // args[0] ^ args[1]
    member,     // args[0].text
    transpose,  // args[0]'
    matrix      // [args], row_lengths
  };
  Kind kind = Kind::broken;
  Span where;
  std::string text;
  Rational value;
  std::optional<WrittenUnit> unit;
  std::vector<Ast> args;
  std::string ops;
  std::vector<int> row_lengths;
};

// The values that a parameter may have, without the bounds themselves.
struct RangeAst {
  std::optional<Ast> above, below;
  bool from = false;  // with the lower bound: `from 0`
  Span where;
};

struct DeclaredAst {
  std::string kind;  // point vector unit frame scalar
  Word name;
  std::optional<WrittenUnit> unit;
  std::optional<RangeAst> range;  // of a scalar
  Word body;                      // empty text: a scalar, or reported already
  std::optional<Ast> value;
  Span where;
  bool broken = false;
};

struct IncludeAst {
  Word joint;
  std::vector<Word> bodies;        // empty: the same as here
  std::vector<DeclaredAst> given;  // name and value: what parameters of the joint are here
  Word prefix;                     // may be empty
  Span where;
};

// "after" or "until" left ( ">=" | "<=" ) right
struct ConditionAst {
  Ast left, right;
  bool at_least = true;  // ">="
  Span where;
};

// rate(coordinate) = value
struct RateAst {
  Word coordinate;
  Ast value;
};

// One statement of a spec. `include` and declarations have one item each: the parser splits lists.
struct StatementAst {
  enum class Kind { include, declare, let, coordinate, row, energy, force, bound };
  Kind kind = Kind::row;
  Span where;
  IncludeAst include;
  DeclaredAst declared;   // declare, coordinate, let (name, unit and value)
  Word label;             // of a row; of a force or torque: the coordinate, point or body that it acts on
  bool velocity = false;  // row; coordinate: declared by its rate
  std::string relation;   // "=", "<=", ">="
  Span relation_where;
  Ast left, right;                           // row; energy, force: the expression is `left`
  bool torque = false;                       // force: `torque on BODY`
  Word bounded;                              // bound: the coordinate. `left` is its prescribed rate, if `of_rate`
  bool of_rate = false, of_joint = false;    // of_joint: the row is those of the joint, `bounded` is empty
  std::optional<Ast> lower, upper;           // bound: of the coordinate, or of the force that prescribes its rate
  std::vector<RateAst> across;               // bound: further rates, which one force of at most `upper` prescribes
  std::optional<ConditionAst> after, until;  // bound: its events
  Word keep;                                 // row: how many of its components, as written
  int first_token = 0, end_token = 0;

  // A row of a joint, or a part of the law of an effect: it declares no name.
  bool acts() const { return kind == Kind::row || kind == Kind::energy || kind == Kind::force || kind == Kind::bound; }
};

// A joint or an effect.
struct JointAst {
  Word name;
  bool effect = false;
  std::string dimension;  // "planar", "spatial" or, of an effect, "coordinate", "joint"; empty if the header is missing
  std::string title, source, comment;
  std::vector<StatementAst> statements;
};

// One item of an entry of a hand derivation.
struct HandItemAst {
  enum class Kind { assume, let, free, rows, quantity, lambda, update, bound, claim };
  Kind kind = Kind::let;
  Word word;                // let, quantity, claim: what; update: v, w, x or angle; assume: the anchored name
  Word body;                // update, anchor, immovable
  std::vector<Word> names;  // free, rows
  bool flag = false;        // update: -=; bound: lambda >= 0; assume: the body is immovable
  Ast left, right;          // right: the expression; left: of a claim or an assumed equation
  Span where;
  std::string text;
  bool broken = false;
};

struct HandEntryAst {
  std::string id, title, source, note, listed;
  std::string form;                            // of the velocities: global, local or euler
  std::map<std::string, std::string> anchors;  // of parameters that the entry fixes elsewhere
  std::vector<std::string> immovable;
  std::vector<HandItemAst> items;
  Span where;
};

}  // namespace cdot::derive
