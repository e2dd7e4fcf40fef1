#include "derive/syntax/lexer.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace cdot::derive {
namespace {

constexpr std::size_t longest_name = 64;
constexpr std::size_t largest_file = 1 << 20;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_ascii(char c) { return static_cast<unsigned char>(c) < 0x80; }
bool is_control(char c) { return is_ascii(c) && (c < ' ' || c == 0x7F) && c != '\t' && c != '\n' && c != '\r'; }

// Characters that word processors write in place of those of the language.
struct LookAlike {
  std::string_view character, meaning;
};
// clang-format off
constexpr std::array<LookAlike, 9> look_alikes = {{
    {"\u2212", "-"}, {"\u2013", "-"}, {"\u00D7", "*"}, {"\u00B7", "*"}, {"\u22C5", "*"}, {"\u2264", "<="},
    {"\u2265", ">="}, {"\u2032", "'"}, {"\u2019", "'"}}};
// clang-format on

class Lexer {
 public:
  Lexer(const SourceFile& file, bool hand, Diagnostics& diagnostics)
      : text_(file.text), hand_(hand), diagnostics_(diagnostics) {}

  Tokens run() {
    if (text_.starts_with("\uFEFF")) at_ = 3;  // a byte order mark
    tokens_.readable = is_text();
    if (!tokens_.readable) at_ = text_.size();
    while (at_ < text_.size()) step();
    add(TokenKind::newline, at_, at_);
    add(TokenKind::end, at_, at_);
    return std::move(tokens_);
  }

 private:
  // True if the bytes are a text; reports only the first byte that is not UTF-8.
  bool is_text() {
    if (text_.size() > largest_file) {
      diagnostics_.error({0, 0}, "the file has " + std::to_string(text_.size()) + " bytes; at most 1 MiB is read",
                         "is this the right file?");
      return false;
    }
    const std::size_t nul = text_.find('\0');
    if (nul != std::string_view::npos) {
      diagnostics_.error(span(nul, nul + 1), "this file is not a text: it has a NUL byte",
                         "save the file as UTF-8; is this the right file?");
      return false;
    }
    bool control = false;
    for (std::size_t i = 0; i < text_.size();) {
      const int length = utf8_length(text_, i);
      const std::size_t end = i + static_cast<std::size_t>(length > 0 ? length : 1);
      if (length == 0 && valid_) diagnostics_.error(span(i, end), "this byte is not UTF-8", "save the file as UTF-8");
      valid_ = valid_ && length > 0;
      if (is_control(text_[i]) && !control)
        diagnostics_.error(span(i, end), "the text has a control character", "remove it");
      control |= is_control(text_[i]);
      i = end;
    }
    return true;
  }

  void step() {
    const char c = text_[at_];
    if (c == '\n') return newline();
    if (c == ' ' || c == '\t' || c == '\r') return void(++at_);
    if (is_control(c)) return void(++at_);  // is_text reported it
    if (c == '#') return comment();
    if (c == '"') return string();
    if (is_letter(c)) return name();
    if (is_digit(c)) return number();
    if (c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1])) return bare_fraction();
    if (symbol()) return;
    unknown();
  }

  void newline() {
    if (depth_ > 0 && statement_follows(at_ + 1)) depth_ = 0;  // the parser reports the open bracket
    if (depth_ == 0) add(TokenKind::newline, at_, at_ + 1);
    ++at_;
  }

  // True if the next line opens a statement: an open bracket must not swallow it.
  bool statement_follows(std::size_t i) const {
    while (i < text_.size() && (text_[i] == ' ' || text_[i] == '\t')) ++i;
    std::size_t end = i;
    while (end < text_.size() && is_letter(text_[end])) ++end;
    if (!starts_statement(text_.substr(i, end - i))) return false;
    while (end < text_.size() && text_[end] == ' ') ++end;
    return end < text_.size() && (is_letter(text_[end]) || text_[end] == '"');
  }

  void comment() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
    if (tokens_.list.empty() || tokens_.list.back().kind == TokenKind::newline)
      tokens_.comments.push_back(span(begin, at_));
  }

  void string() {
    const std::size_t begin = at_++;
    while (at_ < text_.size() && text_[at_] != '"' && text_[at_] != '\n') ++at_;
    Token token{TokenKind::string, span(begin, at_), text_.substr(begin + 1, at_ - begin - 1)};
    if (at_ < text_.size() && text_[at_] == '"') token.where = span(begin, ++at_);
    else
      diagnostics_.error(span(begin, begin + 1), "the text in quotes has no closing quote",
                         "close it with \" on the same line");
    tokens_.list.push_back(token);
  }

  void name() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) ++at_;
    if (at_ - begin > longest_name)
      diagnostics_.error(span(begin, at_),
                         "the name has " + std::to_string(at_ - begin) + " characters; at most 64 are allowed");
    const bool opens = tokens_.list.empty() || tokens_.list.back().kind == TokenKind::newline;
    add(TokenKind::name, begin, begin + std::min(at_ - begin, longest_name));
    if (hand_ && opens && tokens_.list.back().text == "entry") id();
  }

  // The id of an entry, such as P2P-11: all up to the next blank.
  void id() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    const std::size_t begin = at_;
    while (at_ < text_.size() && text_[at_] > ' ' && text_[at_] <= '~' && text_[at_] != '"') ++at_;
    if (at_ > begin) add(TokenKind::name, begin, std::min(at_, begin + longest_name));
  }

  void digits() {
    while (at_ < text_.size() && is_digit(text_[at_])) ++at_;
  }

  // digits [ "." digits ] [ "e" [sign] digits ]
  void number() {
    const std::size_t begin = at_;
    digits();
    if (at_ + 1 < text_.size() && text_[at_] == '.' && is_digit(text_[at_ + 1])) {
      ++at_;
      digits();
    }
    std::size_t e = at_;
    if (e < text_.size() && (text_[e] == 'e' || text_[e] == 'E')) {
      ++e;
      if (e < text_.size() && (text_[e] == '+' || text_[e] == '-')) ++e;
      if (e < text_.size() && is_digit(text_[e])) {
        at_ = e;
        digits();
      }
    }
    add(TokenKind::number, begin, at_);
    if (at_ < text_.size() && (is_letter(text_[at_]) || text_[at_] == '.')) junk_after_number(begin);
  }

  void junk_after_number(std::size_t begin) {
    const std::size_t end_of_number = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]) || text_[at_] == '.')) ++at_;
    const std::string digits(text_.substr(begin, std::min<std::size_t>(end_of_number - begin, 20)));
    const std::string rest(text_.substr(end_of_number, std::min<std::size_t>(at_ - end_of_number, 20)));
    tokens_.list.pop_back();
    if (rest.starts_with('.'))
      reject(begin, "this is not a number", "digits must stand on both sides of the point, as in 1.0");
    else if (rest == "m" || rest == "rad" || rest == "deg" || rest == "s" || rest == "kg" || rest == "N" || rest == "J")
      reject(begin, "a unit stands in square brackets", "write " + digits + " [" + rest + "]");
    else if (rest == "d" || rest == "D")
      reject(begin, "this is neither a number nor a name",
             "a joint is `planar` or `spatial`; a product is " + digits + "*" + rest);
    else
      reject(begin, "this is neither a number nor a name",
             "names do not start with a digit; a product is " + digits + "*" + rest + ", and 2 m is 2 [m]");
  }

  void bare_fraction() {
    const std::size_t begin = at_++;
    digits();
    diagnostics_.error(span(begin, at_), "a number starts with a digit",
                       "write 0" + std::string(text_.substr(begin, std::min<std::size_t>(at_ - begin, 20))));
    add(TokenKind::number, begin + 1, at_);
  }

  bool symbol() {
    static constexpr std::array<std::string_view, 7> pairs = {"==", "<=", ">=", "+=", "-=", "=>", "=<"};
    const auto two = text_.substr(at_, 2);
    const bool pair = std::find(pairs.begin(), pairs.end(), two) != pairs.end();
    static constexpr std::string_view singles = "()[]{},.:;=<>+-*/^'";
    if (!pair && singles.find(text_[at_]) == std::string_view::npos) return false;
    const char c = text_[at_];
    if (c == '(' || c == '[') ++depth_;
    if ((c == ')' || c == ']') && depth_ > 0) --depth_;
    const std::size_t length = pair ? 2 : 1;
    add(TokenKind::symbol, at_, at_ + length);
    at_ += length;
    return true;
  }

  void unknown() {
    for (const LookAlike& l : look_alikes)
      if (text_.substr(at_).starts_with(l.character)) {
        const Span where = span(at_, at_ + l.character.size());
        diagnostics_.error(where, "this character only looks like " + quote(l.meaning), "write " + quote(l.meaning));
        at_ += l.character.size();
        return tokens_.list.push_back({TokenKind::symbol, where, l.meaning});
      }
    const std::size_t begin = at_;
    const bool ascii = is_ascii(text_[at_]);
    do ++at_;
    while (at_ < text_.size() && !known(text_[at_]) && is_ascii(text_[at_]) == ascii);
    const std::string_view strange = text_.substr(begin, at_ - begin);
    if (ascii)
      reject(begin, "the language does not use the character " + quote(strange),
             strange.starts_with('|') ? "the length of a vector is norm(u), the size of a number abs(x)" : "");
    else if (valid_)
      reject(begin, "only ASCII letters are allowed here",
             "names consist of a-z, A-Z, 0-9 and _; other letters may stand in comments and \"texts\"");
    else tokens_.list.push_back({TokenKind::unknown, span(begin, at_), {}});
  }

  // The characters since `begin` are no token.
  void reject(std::size_t begin, std::string message, std::string fix = {}) {
    const Span where = span(begin, at_);
    diagnostics_.error(where, std::move(message), std::move(fix));
    tokens_.list.push_back({TokenKind::unknown, where, {}});
  }

  static bool known(char c) {
    static constexpr std::string_view others = " \t\r\n#\"()[]{},.:;=<>+-*/^'";
    return is_letter(c) || is_digit(c) || others.find(c) != std::string_view::npos;
  }

  static Span span(std::size_t begin, std::size_t end) { return {static_cast<int>(begin), static_cast<int>(end)}; }

  void add(TokenKind kind, std::size_t begin, std::size_t end) {
    tokens_.list.push_back({kind, span(begin, end), text_.substr(begin, end - begin)});
  }

  std::string_view text_;
  bool hand_;
  bool valid_ = true;  // UTF-8 throughout
  Diagnostics& diagnostics_;
  std::size_t at_ = 0;
  int depth_ = 0;
  Tokens tokens_;
};

}  // namespace

Tokens lex(const SourceFile& file, bool hand, Diagnostics& diagnostics) { return Lexer(file, hand, diagnostics).run(); }

std::string quote(std::string_view word) {
  std::string out = "`";
  for (const char c : word.substr(0, 40)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (word.size() > 40 ? "...`" : "`");
}

const std::vector<std::string>& statement_words(bool hand) {
  static const std::vector<std::string> joint = {"joint", "source", "include", "point",    "vector",    "unit",
                                                 "frame", "scalar", "let",     "velocity", "coordinate"};
  static const std::vector<std::string> entry = {"entry",  "source", "note",  "assume", "let",  "free",  "rows",
                                                 "lambda", "update", "bound", "claim",  "form", "listed"};
  return hand ? entry : joint;
}

bool starts_statement(std::string_view word) {
  const auto has = [&](bool hand) {
    const auto& words = statement_words(hand);
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  return has(false) || has(true);
}

}  // namespace cdot::derive
