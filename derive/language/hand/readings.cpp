#include "derive/language/hand/readings.hpp"

namespace cdot::derive {
namespace {

// `node` is a part of `whole`.
void exchange(Ast& whole, Ast& node, std::vector<OtherAst>& found) {
  const bool velocity = node.text == "v" || node.text == "w";
  if (node.kind == Ast::Kind::call && velocity && node.args.size() == 1) {
    const std::string written = node.text, of = "(" + node.args[0].text + ")";
    node.text = written == "v" ? "w" : "v";
    found.push_back(
        {whole, "with " + node.text + of + " in place of " + written + of, node.text + "_" + node.args[0].text});
    node.text = written;
  }
  for (Ast& arg : node.args) exchange(whole, arg, found);
}

}  // namespace

std::vector<OtherAst> with_velocities_exchanged(const Ast& ast) {
  std::vector<OtherAst> found;
  Ast whole = ast;
  exchange(whole, whole, found);
  return found;
}

}  // namespace cdot::derive
