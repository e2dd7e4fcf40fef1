// A spec's text to its tree: header, declarations, lets, rows, coordinates.
#include <algorithm>
#include <utility>

#include "derive/syntax/other_words.hpp"
#include "derive/syntax/parse_law.hpp"
#include "derive/syntax/parser.hpp"

namespace cdot::derive {
namespace {

class JointParser {
 public:
  JointParser(const SourceFile& file, const Tokens& tokens, Diagnostics& diagnostics)
      : file_(file), tokens_(tokens), diagnostics_(diagnostics), p_(file, tokens, false, diagnostics) {}

  JointAst run() {
    p_.skip_blank_lines();
    if (!p_.at_word("joint") && !p_.at_word("effect"))
      diagnostics_.error(p_.peek().where, "the header is missing: " + p_.found(),
                         "start with `joint NAME planar`, or `effect NAME planar`");
    for (; !p_.at_end(); p_.skip_blank_lines()) {
      const std::size_t before = joint_.statements.size();
      statement();
      if (!p_.end_of_statement()) spoil(before);
    }
    comment();
    return std::move(joint_);
  }

 private:
  // A statement with an error is not used; its names are declared, so that their uses are no errors.
  void spoil(std::size_t first) {
    auto& all = joint_.statements;
    for (std::size_t i = first; i < all.size(); ++i) all[i].declared.broken = true;
    const auto acts = [](const StatementAst& s) { return s.acts(); };
    all.erase(std::remove_if(all.begin() + static_cast<std::ptrdiff_t>(first), all.end(), acts), all.end());
  }

  void statement() {
    const bool declares = p_.at_name(1);
    if (p_.peek().kind == TokenKind::string) return once(joint_.title, "the title of the joint", "");
    if ((p_.at_word("joint") || p_.at_word("effect")) && declares) return header();
    if (p_.at_word("source") && !p_.at_symbol("=", 1)) {
      p_.take();
      return once(joint_.source, "the source", "source");
    }
    if (p_.at_word("include") && declares) return includes();
    for (const char* kind : {"point", "vector", "unit", "frame", "scalar"})
      if (p_.at_word(kind) && declares) return declarations(kind);
    if (p_.at_word("let") && declares) return let();
    if (p_.at_word("coordinate") && declares) return coordinate();
    if (joint_.effect && (p_.at_word("energy") || p_.at_word("force") || p_.at_word("torque")) && !p_.at_symbol(":", 1))
      return law();
    if (joint_.effect && at_bounded_row(p_)) return bound();
    if (p_.at_word("keep"))
      return p_.fail(p_.peek().where, "`keep` stands at the end of the row that it is about",
                     "write cross(f.x, u) = 0 keep 2, in one line");
    for (const char* kind : {"point", "vector", "unit", "frame", "scalar", "let", "coordinate", "include", "joint"})
      if (p_.at_word(kind) && !p_.at_symbol("(", 1) && !p_.at_symbol(":", 1)) {
        p_.take();
        return p_.fail(p_.peek().where, "a name is missing after " + quote(kind) + ": " + p_.found());
      }
    if (p_.at_name() && (declares || p_.peek(1).kind == TokenKind::string) && !p_.at_word("velocity"))
      return unknown_statement();
    row();
  }

  // A name with - in it, which no name has, is read as one with _.
  Word name_in_header(const std::string& kind) {
    Word name = p_.name("the name of the " + kind);
    const std::string first = name.text;
    while (p_.at_symbol("-") && p_.at_name(1)) {
      p_.take();
      const Token part = p_.take();
      name.text += "_" + std::string(part.text);
      name.where.end = part.where.end;
    }
    if (name.text != first)
      diagnostics_.error(name.where, "a name has letters, digits and _, but no `-`", "call it " + name.text);
    return name;
  }

  // ( joint | effect ) NAME ( planar | spatial ), or effect NAME ( coordinate | joint )
  void header() {
    const Token word = p_.take();
    const std::string kind(word.text);
    if (!joint_.name.text.empty())
      p_.fail(word.where, "the file has a second header; a file contains one " + kind, "", {joint_.name.where});
    const Word name = name_in_header(kind);
    if (joint_.name.text.empty()) joint_.name = name, joint_.effect = kind == "effect";
    if (p_.failed()) return;
    const bool of_joint = kind == "effect" && (p_.at_word("coordinate") || p_.at_word("joint"));
    if (!p_.at_word("planar") && !p_.at_word("spatial") && !of_joint)
      return p_.fail(p_.peek().where, "`planar` or `spatial` is missing: " + p_.found(),
                     "write " + kind + " " + name.text + " planar");
    const Token dimension = p_.take();
    joint_.dimension = dimension.text;
    header_end_ = dimension.where.end;
  }

  void once(std::string& target, std::string_view what, std::string_view keyword) {
    const Token t = p_.peek();
    const std::string text = keyword.empty() ? std::string(p_.take().text) : p_.string(keyword);
    if (!target.empty()) p_.fail(t.where, std::string(what) + " is given twice", "join the two texts into one");
    target = text;
  }

  // include NAME [ "(" argument { "," argument } ")" ] [ "as" NAME ] { "," ... }
  void includes() {
    p_.take();
    do {
      StatementAst s = begin(StatementAst::Kind::include);
      s.include.joint = p_.name("the name of a joint");
      if (p_.accept("(")) {
        do argument(s.include);
        while (p_.accept(","));
        p_.expect(")", "after the bodies and parameters");
      }
      if (p_.at_word("as")) {
        p_.take();
        s.include.prefix = p_.name("the prefix for its names");
      }
      finish(s);
    } while (p_.accept(","));
  }

  // BODY, or NAME "=" expression
  void argument(IncludeAst& include) {
    if (!p_.at_symbol("=", 1)) {
      const Word body = p_.name("a body");
      if (!include.given.empty() && !p_.failed())
        p_.fail(body.where, "a body stands after a parameter", "bodies stand first");
      return include.bodies.push_back(body);
    }
    DeclaredAst given;
    given.name = p_.name("a parameter");
    default_value(given);
    include.given.push_back(std::move(given));
  }

  // declared { "," declared }
  void declarations(const std::string& kind) {
    p_.take();
    do {
      StatementAst s = begin(StatementAst::Kind::declare);
      s.declared.kind = kind;
      s.declared.name = p_.name("the name of the " + kind);
      s.declared.unit = p_.unit();
      if (kind == "scalar") range(s.declared);
      else on_body(s.declared);
      default_value(s.declared);
      finish(s);
    } while (p_.accept(","));
    if (p_.at_name() && !p_.failed())
      p_.fail(p_.peek().where, "after the " + kind + " comes " + quote(p_.peek().text), "the form is " + form_of(kind));
  }

  static std::string form_of(const std::string& kind) {
    if (kind == "scalar") return "scalar NAME [unit] above 0 = default, where the bound and the default may be missing";
    return kind + " NAME on BODY = default";
  }

  // ( "above" | "from" | "below" ) expression, or "between" expression "and" expression
  void range(DeclaredAst& d) {
    const Token first = p_.peek();
    if (p_.at_symbol("<") || p_.at_symbol(">"))
      return p_.fail(first.where, "a range is written in words",
                     std::string("write ") + (first.text == "<" ? "below" : "above") + " and a number");
    const bool both = p_.at_word("between");
    if (!both && !p_.at_word("above") && !p_.at_word("from") && !p_.at_word("below")) return;
    p_.take();
    RangeAst range;
    range.from = first.text == "from";
    (first.text == "below" ? range.below : range.above) = p_.expression();
    if (both && !p_.at_word("and") && !p_.failed())
      p_.fail(p_.peek().where, "the upper bound is missing: `and` and a number must follow", "write between 0 and 1");
    if (both && !p_.failed()) {
      p_.take();
      range.below = p_.expression();
    }
    range.where = p_.from(first);
    d.range = std::move(range);
  }

  void on_body(DeclaredAst& d) {
    if (p_.failed()) return;
    if (!p_.at_word("on"))
      return p_.fail(p_.at_end_of_statement() ? d.name.where : p_.peek().where,
                     "the body of " + quote(d.name.text) + " is missing: `on` and a body must follow",
                     "write " + d.kind + " " + d.name.text + " on a (or b, ..., or world)");
    p_.take();
    d.body = p_.name("the body");
    if (p_.at_symbol("[") && !p_.failed())
      p_.fail(p_.peek().where, "the unit stands before `on`",
              "write " + d.kind + " " + d.name.text + " [unit] on " + d.body.text);
  }

  void default_value(DeclaredAst& d) {
    if (p_.accept("=")) d.value = p_.expression();
    d.broken = p_.failed();
  }

  // let NAME "=" expression
  void let() {
    p_.take();
    StatementAst s = begin(StatementAst::Kind::let);
    named_expression(s, "let");
  }

  // coordinate NAME [ unit ] "=" [ "velocity" ] expression; without the expression it is that of any joint
  void coordinate() {
    p_.take();
    StatementAst s = begin(StatementAst::Kind::coordinate);
    named_expression(s, "coordinate");
  }

  void named_expression(StatementAst& s, const std::string& keyword) {
    s.declared.name = p_.name("the name");
    s.declared.unit = p_.unit();
    if (keyword == "let" && s.declared.unit)
      p_.fail(s.declared.unit->where, "a let takes its unit from its expression", "remove the unit here");
    const bool of_any_joint =
        keyword == "coordinate" && (joint_.dimension == "coordinate" || joint_.dimension == "joint");
    if (!p_.failed() && !p_.at_symbol("=") && !of_any_joint)
      p_.fail(p_.peek().where, "`=` is missing after `" + keyword + " " + s.declared.name.text + "`: " + p_.found(),
              "write " + keyword + " " + s.declared.name.text + " = ...");
    if (p_.accept("=")) {
      s.velocity = keyword == "coordinate" && p_.at_word("velocity");
      if (s.velocity) p_.take();
      s.declared.value = p_.expression();
    }
    s.declared.broken = p_.failed();
    finish(s);
  }

  void law() {
    StatementAst s = begin(p_.at_word("energy") ? StatementAst::Kind::energy : StatementAst::Kind::force);
    parse_law(p_, s);
    finish(s);
  }

  void bound() {
    StatementAst s = begin(StatementAst::Kind::bound);
    parse_bounded_row(p_, s);
    finish(s);
  }

  // [ NAME ":" ] [ "velocity" ] expression ( "=" | "<=" | ">=" ) expression [ "keep" NUMBER ]
  void row() {
    StatementAst s = begin(StatementAst::Kind::row);
    if (p_.at_name() && p_.at_symbol(":", 1)) {
      s.label = p_.name("the name of the row");
      p_.take();
    }
    if (p_.at_word("velocity") && !p_.at_symbol("=", 1)) {
      p_.take();
      s.velocity = true;
    }
    if (!s.label.text.empty() && p_.at_symbol("="))
      p_.fail(p_.peek().where, "`:=` is not a relation of this language", "write =");
    s.left = p_.expression();
    relation(s);
    s.right = p_.expression();
    keep(s);
    if (!p_.failed() && (p_.at_symbol("=") || p_.at_symbol("<=") || p_.at_symbol(">=")))
      p_.fail(p_.peek().where, "a row has one relation, not two", "write two rows", {s.relation_where});
    finish(s);
  }

  // [ "keep" NUMBER ]
  void keep(StatementAst& s) {
    if (p_.failed() || !p_.at_word("keep")) return;
    p_.take();
    const Token t = p_.peek();
    if (t.kind != TokenKind::number)
      return p_.fail(t.where, "the number of rows is missing after `keep`: " + p_.found(), "write keep 2");
    p_.take();
    s.keep = {std::string(t.text), t.where};
  }

  void relation(StatementAst& s) {
    if (p_.failed()) return;
    const Token t = p_.peek();
    s.relation = t.text;
    s.relation_where = t.where;
    if (p_.accept("=") || p_.accept("<=") || p_.accept(">=")) return;
    if (p_.at_symbol("==")) p_.fail(t.where, "`==` is not a relation of this language", "write a single =");
    else if (p_.at_symbol("=>") || p_.at_symbol("=<"))
      p_.fail(t.where, quote(t.text) + " is not a relation of this language", t.text == "=>" ? "write >=" : "write <=");
    else if (p_.at_symbol("<") || p_.at_symbol(">"))
      p_.fail(t.where, quote(t.text) + " is not a relation of this language", "write " + std::string(t.text) + "=");
    else if (p_.at_symbol("+=") || p_.at_symbol("-="))
      p_.fail(t.where, quote(t.text) + " assigns a value; a row is an equation", "write =");
    else if (p_.at_symbol(")") || p_.at_symbol("]"))
      p_.fail(t.where, quote(t.text) + " closes nothing", "remove it, or open it before");
    else if (p_.at_end_of_statement())
      p_.fail(s.left.where, "this row has no `=`, `<=` or `>=`",
              "write ... = 0; to give a part a name: let NAME = ...");
    else if (p_.at_name() || p_.peek().kind == TokenKind::number || p_.at_symbol("("))
      p_.fail(t.where, "an operator is missing before " + quote(t.text), "write * for a product");
    else p_.fail(t.where, "`=`, `<=` or `>=` is missing: " + p_.found());
  }

  void unknown_statement() {
    const Token t = p_.take();
    if (!joint_.effect && (t.text == "energy" || t.text == "force" || t.text == "torque"))
      return p_.fail(
          t.where, "a joint has no " + std::string(t.text) + ": effects have",
          "write `effect` in place of `joint` in the header, and name the file " + joint_.name.text + ".effect");
    if (p_.at_word("on")) {
      p_.fail(
          t.where, "no statement starts with " + quote(t.text),
          "write `point " + std::string(t.text) + " on " + std::string(p_.peek(1).text) + "`, or vector, unit, frame");
      return declare_broken("point", t);
    }
    const std::string meant(meaning_of(t.text));
    if (meant.find(' ') != std::string::npos)
      return p_.fail(t.where, "no statement starts with " + quote(t.text), meant);
    std::vector<std::string> words = statement_words(false);
    const std::string near = meant.empty() ? nearest(t.text, words) : meant;
    if (near.empty())
      p_.fail(t.where, "no statement starts with " + quote(t.text),
              "statements start with point, vector, unit, frame, scalar, let, include, coordinate, velocity, source; a "
              "row is an equation");
    else p_.fail(t.where, "no statement starts with " + quote(t.text), "did you mean " + quote(near) + "?");
    if (p_.at_name() &&
        (near == "point" || near == "vector" || near == "unit" || near == "frame" || near == "scalar" || near == "let"))
      declare_broken(near, p_.peek());
  }

  // Declares the name of a statement with an error, so that its uses are no errors of their own.
  void declare_broken(const std::string& kind, const Token& name) {
    StatementAst s = begin(kind == "let" ? StatementAst::Kind::let : StatementAst::Kind::declare);
    s.declared.kind = kind;
    s.declared.name = {std::string(name.text), name.where};
    s.declared.broken = true;
    finish(s);
  }

  StatementAst begin(StatementAst::Kind kind) {
    StatementAst s;
    s.kind = kind;
    s.first_token = p_.position();
    s.where = p_.peek().where;
    return s;
  }

  void finish(StatementAst& s) {
    s.end_token = p_.position();
    if (s.end_token > s.first_token) s.where.end = p_.peek(-1).where.end;
    s.declared.where = s.include.where = s.where;
    const bool acts = s.acts();
    const bool named = !s.declared.name.text.empty();
    const bool include = s.kind == StatementAst::Kind::include;
    if (p_.failed() && (acts || include)) return;
    if (acts || include || named) joint_.statements.push_back(std::move(s));
  }

  // The comment lines above the header; if there are none, those right under it.
  void comment() {
    const int header = joint_.name.where.begin;
    std::vector<Span> block;
    for (const Span& c : tokens_.comments) {
      const bool above = c.end <= header;
      if (!above && !block.empty() && block.front().end <= header) break;
      if (!above && (c.begin < header_end_ || !follows(block, c))) continue;
      block.push_back(c);
    }
    for (const Span& c : block) {
      std::string_view line = std::string_view(file_.text)
                                  .substr(static_cast<std::size_t>(c.begin), static_cast<std::size_t>(c.end - c.begin));
      line.remove_prefix(line.starts_with("# ") ? 2 : 1);
      if (line.ends_with('\r')) line.remove_suffix(1);
      joint_.comment += std::string(line) + "\n";
    }
  }

  bool follows(const std::vector<Span>& block, Span c) const {
    const int before = block.empty() ? file_.line(header_end_) : file_.line(block.back().begin);
    return file_.line(c.begin) == before + 1;
  }

  const SourceFile& file_;
  const Tokens& tokens_;
  Diagnostics& diagnostics_;
  Parser p_;
  JointAst joint_;
  int header_end_ = 0;
};

}  // namespace

JointAst parse_joint(const SourceFile& file, const Tokens& tokens, Diagnostics& diagnostics) {
  return JointParser(file, tokens, diagnostics).run();
}

}  // namespace cdot::derive
