// The comment above a kernel: the joint in words, then C, J and K in the spec's own names, as `cdot explain` writes
// them.
#include <sstream>

#include "derive/explain/explain.hpp"
#include "derive/kernel/emit.hpp"

namespace cdot::derive {

std::vector<std::string> describe(const Kernel& kernel) {
  constexpr std::size_t width = 96;  // beside the marks of a comment
  const Joint& joint = kernel.derivation->joint;
  std::vector<std::string> lines = {joint.name + ": " + joint.title};
  if (!joint.source.empty()) lines.push_back("Source: " + joint.source);
  for (const std::vector<Chain>& part : summarise(*kernel.derivation)) {
    if (!part.empty()) lines.push_back("");
    for (const Chain& chain : part) {
      std::istringstream text(chain_text(chain, width));
      for (std::string line; std::getline(text, line);) lines.push_back(line);
    }
  }
  return lines;
}

}  // namespace cdot::derive
