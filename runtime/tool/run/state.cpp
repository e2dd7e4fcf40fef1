#include "runtime/tool/run/state.hpp"

#include <fmt/format.h>

#include "runtime/tool/run/output.hpp"

namespace cdot {

Snapshot read_state(const std::string& path) {
  const std::string text = read_file(path);
  try {
    return Snapshot::read(text);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path, error.what()));
  }
}

void write_state(const std::string& path, const Snapshot& state) { write_file(path, state.text()); }

}  // namespace cdot
