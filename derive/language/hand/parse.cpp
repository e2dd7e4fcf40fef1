// The text of hand derivations to trees: entries and their items.
#include <algorithm>
#include <array>

#include "derive/language/hand/hand.hpp"
#include "derive/syntax/parser.hpp"

namespace cdot::derive {
namespace {

using Kind = HandItemAst::Kind;

constexpr std::array<std::string_view, 5> quantities = {"C", "Cdot", "J", "K", "b"};

bool is_quantity(std::string_view word) {
  return std::find(quantities.begin(), quantities.end(), word) != quantities.end() || is_of_law(word);
}

class HandParser {
 public:
  HandParser(HandFile& out, const Tokens& tokens)
      : out_(out), p_(*out.file, tokens, true, out.diagnostics), text_(out.file->text) {}

  void run() {
    p_.skip_blank_lines();
    for (; !p_.at_end(); p_.skip_blank_lines()) {
      const std::size_t before = out_.entries.empty() ? 0 : entry().items.size();
      statement();
      if (p_.end_of_statement()) continue;
      for (std::size_t i = before; i < entry().items.size(); ++i) entry().items[i].broken = true;
    }
    for (const HandEntryAst& e : out_.entries) check(e);
  }

 private:
  HandEntryAst& entry() { return out_.entries.back(); }

  void statement() {
    if (p_.at_word("entry")) return begin_entry();
    if (out_.entries.empty()) {
      p_.fail(p_.peek().where, "an entry must come first: " + p_.found(), "start with entry ID \"title\"");
      return out_.entries.push_back({});  // so that this error occurs once
    }
    if (p_.at_word("source")) return text(entry().source);
    if (p_.at_word("note")) return text(entry().note);
    if (p_.at_word("listed")) return text(entry().listed);
    if (p_.at_word("form")) return form();
    HandItemAst item;
    const Token first = p_.peek();
    parse(item);
    item.broken = p_.failed();
    item.where = p_.from(first);
    item.text = written(item.where);
    remember(item);
    entry().items.push_back(std::move(item));
  }

  void parse(HandItemAst& item) {
    if (p_.at_symbol("=", 1) && is_quantity(p_.peek().text)) return quantity(item);
    if (p_.at_symbol("=", 1) && p_.at_word("lambda")) {
      item.kind = Kind::lambda;
      return assigned(item);
    }
    if (p_.at_word("let")) {
      p_.take();
      return assigned(item);
    }
    if (p_.at_word("assume")) return assume(item);
    if (p_.at_word("free")) return names(item, Kind::free, "the name of a free symbol");
    if (p_.at_word("rows")) return names(item, Kind::rows, "the name of a row or coordinate");
    if (p_.at_word("update")) return update(item);
    if (p_.at_word("bound")) return bound(item);
    if (p_.at_word("claim")) return claim(item);
    unknown();
  }

  // "entry" ID [ STRING ]
  void begin_entry() {
    const Token first = p_.take();
    const Word id = p_.name("the id of the entry");
    const auto same = [&](const HandEntryAst& e) { return e.id == id.text && !id.text.empty(); };
    const auto before = std::find_if(out_.entries.begin(), out_.entries.end(), same);
    if (before != out_.entries.end())
      p_.fail(id.where, "two entries have the id " + quote(id.text), "choose another id", {before->where});
    HandEntryAst e;
    e.id = id.text;
    e.where = id.text.empty() ? first.where : id.where;
    if (p_.peek().kind == TokenKind::string) e.title = p_.take().text;
    out_.entries.push_back(std::move(e));
  }

  void text(std::string& target) {
    const Token keyword = p_.take();
    const std::string more = p_.string(keyword.text);
    target += (target.empty() ? "" : " ") + more;
  }

  // "form" ( "global" | "local" | "euler" )
  void form() {
    p_.take();
    const Word word = p_.name("global, local or euler");
    entry().form = word.text;
    if (!p_.failed() && name_of(form_named(word.text)) != word.text)
      p_.fail(word.where, "a form is global, local or euler, not " + quote(word.text));
  }

  void quantity(HandItemAst& item) {
    item.kind = Kind::quantity;
    for (auto said = entry().items.rbegin(); said != entry().items.rend(); ++said) {
      if (said->kind == Kind::rows) break;
      if (said->kind == Kind::quantity && said->word.text == p_.peek().text)
        p_.fail(p_.peek().where, quote(p_.peek().text) + " is given twice in this entry",
                "write two entries, or `rows ...` before the items about other rows", {said->word.where});
    }
    assigned(item);
  }

  // NAME "=" expression
  void assigned(HandItemAst& item) {
    item.word = p_.name("the name");
    p_.expect("=", "after the name");
    item.right = p_.expression();
  }

  // "assume" ( NAME "on" ( BODY | "world" ) | BODY "immovable" | expression "=" expression )
  void assume(HandItemAst& item) {
    item.kind = Kind::assume;
    p_.take();
    if (p_.at_name() && p_.at_word("on", 1)) {
      item.word = p_.name("a name");
      p_.take();
      item.body = p_.name("a body or world");
    } else if (p_.at_name() && p_.at_word("immovable", 1)) {
      item.body = p_.name("a body");
      p_.take();
      item.flag = true;
    } else {
      equation(item);
    }
  }

  void equation(HandItemAst& item) {
    item.left = p_.expression();
    p_.expect("=", "between the two sides");
    item.right = p_.expression();
  }

  void names(HandItemAst& item, Kind kind, std::string_view what) {
    item.kind = kind;
    p_.take();
    do item.names.push_back(p_.name(what));
    while (p_.accept(","));
  }

  // "update" ( "v" | "w" | "x" | "angle" ) "(" BODY ")" ( "+=" | "-=" ) expression
  void update(HandItemAst& item) {
    item.kind = Kind::update;
    p_.take();
    item.word = p_.name("v, w, x or angle");
    const std::string& t = item.word.text;
    if (!p_.failed() && t != "v" && t != "w" && t != "x" && t != "angle")
      p_.fail(item.word.where, "an update changes v(a), w(a), x(a) or angle(a), not " + quote(t));
    p_.expect("(", "after what is updated");
    item.body = p_.name("a body");
    p_.expect(")", "after the body");
    if (p_.failed()) return;
    if (!p_.at_symbol("+=") && !p_.at_symbol("-="))
      return p_.fail(p_.peek().where, "`+=` or `-=` is missing: " + p_.found());
    item.flag = p_.take().text == "-=";
    item.right = p_.expression();
  }

  // "bound" "lambda" ( ">=" "0" | "free" )
  void bound(HandItemAst& item) {
    item.kind = Kind::bound;
    p_.take();
    const bool lambda = p_.at_word("lambda");
    if (lambda) p_.take();
    if (lambda && p_.at_word("free")) return void(p_.take());
    item.flag = true;
    if (!lambda || !p_.accept(">=") || p_.peek().text != "0")
      return p_.fail(p_.peek().where, "a bound is `lambda >= 0` or `lambda free`: " + p_.found());
    p_.take();
  }

  // "claim" ( "C" | "Cdot" | "J" | "K" | "b" | "update" ) ":" expression "=" expression
  void claim(HandItemAst& item) {
    item.kind = Kind::claim;
    p_.take();
    item.word = p_.name("what the claim is about");
    if (!p_.failed() && !is_quantity(item.word.text) && item.word.text != "update")
      p_.fail(item.word.where, "a claim is about C, Cdot, J, K, b or update, not " + quote(item.word.text));
    p_.expect(":", "after what the claim is about");
    equation(item);
  }

  void unknown() {
    const Token t = p_.take();
    std::vector<std::string> words = statement_words(true);
    for (const std::string_view q : quantities) words.emplace_back(q);
    for (const std::string_view q : quantities_of_law) words.emplace_back(q);
    const std::string near = t.kind == TokenKind::name ? nearest(t.text, words) : "";
    p_.fail(t.where, "no item of an entry starts with " + quote(t.text),
            near.empty() ? "items are C, Cdot, J, K, b, lambda = ...; let, free, rows, assume, update, bound, claim, "
                           "form, note, source, listed"
                         : "did you mean " + quote(near) + "?");
  }

  void remember(const HandItemAst& item) {
    if (item.kind != Kind::assume || item.broken || item.body.text.empty()) return;
    if (item.flag) entry().immovable.push_back(item.body.text);
    else entry().anchors[item.word.text] = item.body.text;
  }

  void check(const HandEntryAst& e) {
    const auto says = [](const HandItemAst& i) {
      return i.kind != Kind::assume && i.kind != Kind::let && i.kind != Kind::free && i.kind != Kind::rows;
    };
    const bool empty = std::none_of(e.items.begin(), e.items.end(), says);
    if (e.id.empty() || p_.failed()) return;
    if (empty && e.listed.empty())
      out_.diagnostics.error(
          e.where, "the entry " + quote(e.id) + " has nothing to compare",
          "give C, Cdot, J, K, b, an update or a claim, of an effect energy, force, stiffness, damping "
          "or wrench, or the reason: listed \"...\"");
    if (e.source.empty())
      out_.diagnostics.warning(e.where, "the entry " + quote(e.id) + " has no source",
                               "name its publication: source \"...\"");
  }

  // An item as its author wrote it, in one line.
  std::string written(Span s) const {
    std::string out;
    bool comment = false;
    for (int i = s.begin; i < s.end; ++i) {
      const char c = text_[static_cast<std::size_t>(i)];
      comment = c == '#' || (comment && c != '\n');
      const bool blank = comment || c == ' ' || c == '\t' || c == '\n' || c == '\r';
      if (!blank) out += c;
      else if (!out.empty() && out.back() != ' ') out += ' ';
    }
    return out;
  }

  HandFile& out_;
  Parser p_;
  std::string_view text_;
};

}  // namespace

HandFile read_hand(std::shared_ptr<const SourceFile> file) {
  HandFile out;
  out.file = std::move(file);
  const Tokens tokens = lex(*out.file, true, out.diagnostics);
  if (tokens.readable) HandParser(out, tokens).run();
  out.diagnostics.sort();
  return out;
}

}  // namespace cdot::derive
