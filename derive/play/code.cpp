// The kernel of a spec as HTML: its names are those of the derivation, so that pointing at one lights up the others.
#include <cctype>
#include <fmt/format.h>
#include <set>
#include <string_view>

#include "derive/explain/explain.hpp"
#include "derive/explain/formats/mathml.hpp"
#include "derive/kernel/generate.hpp"
#include "derive/language/specs_folder.hpp"
#include "derive/play/spec.hpp"
#include "runtime/text/html.hpp"

namespace cdot::play {
namespace {

using namespace derive;

bool is_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

// The names that a page of the derivation marks.
std::set<std::string> names_in(const std::string& html) {
  constexpr std::string_view mark = "data-name=\"";
  std::set<std::string> names;
  for (std::size_t at = 0; (at = html.find(mark, at)) != html.npos;) {
    at += mark.size();
    names.insert(html.substr(at, html.find('"', at) - at));
  }
  return names;
}

class Code {
 public:
  Code(const Joint& joint, std::set<std::string> names) : joint_(joint), names_(std::move(names)) {}

  std::string html(std::string_view code) const {
    std::string out;
    while (!code.empty()) {
      std::size_t end = 0;
      while (end < code.size() && is_of_name(code[end])) ++end;
      if (end == 0) {
        out += text::html_escaped(std::string(code.substr(0, 1))), code.remove_prefix(1);
        continue;
      }
      const std::string word(code.substr(0, end)), member = member_after(code.substr(end));
      const std::string name = name_of(word, member);
      const std::size_t length = end + (name.empty() || !is_of_body(word) ? 0 : member.size() + 1);
      const std::string text = text::html_escaped(std::string(code.substr(0, length)));
      out += name.empty() ? text : fmt::format("<span data-name=\"{}\">{}</span>", name, text);
      code.remove_prefix(length);
    }
    return out;
  }

 private:
  // "x" of ".x + …"
  static std::string member_after(std::string_view rest) {
    if (rest.empty() || rest[0] != '.') return {};
    std::size_t end = 1;
    while (end < rest.size() && is_of_name(rest[end])) ++end;
    return std::string(rest.substr(1, end - 1));
  }

  // a is the pose of the body a, va its velocity and ma its inverse mass.
  bool is_of_body(const std::string& word) const { return !body_of(word).empty(); }
  std::string body_of(const std::string& word) const {
    for (const std::string& body : joint_.bodies)
      if (word == body || word == "v" + body || word == "m" + body) return body;
    return {};
  }

  std::string name_of(const std::string& word, const std::string& member) const {
    const std::string body = body_of(word);
    std::string name = word;
    if (!body.empty() && member.empty()) return {};
    if (word == body && !body.empty()) name = (member.size() > 1 ? "theta_" : "x_") + body;
    else if (!body.empty() && word[0] == 'v') name = (member[0] == 'w' ? "w_" : "v_") + body;
    else if (!body.empty()) name = (member[0] == 'I' ? "inv_I_" : "inv_m_") + body;
    if (names_.contains(name)) return name;
    if (name.size() > 2 && name[name.size() - 2] == '_') name.resize(name.size() - 2);  // ra_x
    return names_.contains(name) ? name : std::string();
  }

  const Joint& joint_;
  std::set<std::string> names_;
};

}  // namespace

nlohmann::json kernel_of_spec(const std::string& path) {
  return with_derivation(path, [](const Derivation& derivation) {
    const std::set<std::string> names = names_in(explanation_html(explain(derivation)));
    const std::string kernel = print(simplified(plan(derivation))).kernel;
    return nlohmann::json{{"html", Code(derivation.joint, names).html(kernel)}};
  });
}

}  // namespace cdot::play
