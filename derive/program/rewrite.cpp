#include "derive/program/rewrite.hpp"

namespace cdot::derive {

Program rewritten(const Program& program, const Rewrite& rewrite) {
  const std::vector<int> uses = use_counts(program);
  ProgramBuilder builder(program.ops.size());
  Moved at{std::vector<int>(program.ops.size(), -1)};
  for (std::size_t i = 0; i < program.ops.size(); ++i) {
    if (uses[i] == 0) continue;
    const Operation& op = program.ops[i];
    Made made = rewrite(builder, op, static_cast<int>(i), at);
    if (!made) {
      Operands args = op.args;
      for (int& arg : args) arg = at(arg);
      made = builder.rebuild(op, std::move(args));
    }
    at.to[i] = *made;
  }
  for (const Output& o : program.outputs) builder.output(o.name, at(o.op));
  return builder.finish();
}

}  // namespace cdot::derive
