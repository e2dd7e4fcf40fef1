#include "derive/proof/words.hpp"

#include <algorithm>
#include <cctype>

#include "derive/derivation/derivation.hpp"

namespace cdot::derive {
namespace {

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

}  // namespace

std::string spec_text(Expr e, const Joint& joint) {
  if (!e->name.empty()) return e->name;
  std::map<const Node*, Expr> spelled;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    const std::string& name = joint.bodies[b];
    if (body.theta) spelled.emplace(&*body.theta, joint.pool->symbol("angle(" + name + ")", Role::given));
    spelled.emplace(&*body.x, joint.pool->vector_symbol("x(" + name + ")", Role::given));
  }
  for (const Parameter& p : joint.parameters)
    for (std::size_t k = 0; k < p.axes.size(); ++k)
      spelled.emplace(&*p.axes[k], joint.pool->vector_symbol(p.name + "." + "xyz"[k], Role::given, -1, true));
  return text(substitute(e, spelled));
}

std::string vanishing_vector(Expr u, const Joint& joint) {
  for (const Parameter& p : joint.parameters) {
    for (const Parameter& q : joint.parameters) {
      if (p.kind != ParameterKind::point || q.kind != ParameterKind::point) continue;
      if (p.value - q.value == u) return p.name + " = " + q.name;
    }
  }
  return spec_text(u, joint) + " = 0";
}

std::vector<Span> occurrences(const SourceFile& file, Span where, const std::set<std::string>& words) {
  const std::string& text = file.text;
  const auto end = std::min(static_cast<std::size_t>(where.end), text.size());
  std::vector<Span> spans;
  for (const std::string& word : words) {
    for (auto at = text.find(word, static_cast<std::size_t>(where.begin));
         at != std::string::npos && at + word.size() <= end; at = text.find(word, at + 1)) {
      const auto after = at + word.size();
      const bool begins = at == 0 || !is_word(text[at - 1]) || !is_word(word.front());
      const bool ends = after >= text.size() || !is_word(text[after]) || !is_word(word.back());
      if (begins && ends) spans.push_back({static_cast<int>(at), static_cast<int>(after)});
    }
  }
  std::sort(spans.begin(), spans.end(), [](Span a, Span b) { return a.begin < b.begin; });
  return spans;
}

}  // namespace cdot::derive
