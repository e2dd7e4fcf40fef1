#include "runtime/tool/run/state.hpp"

#include <fmt/format.h>
#include <fstream>
#include <sstream>

#include "runtime/tool/run/output.hpp"

namespace cdot {

Snapshot read_state(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  if (!file) throw Error(fmt::format("{}: cannot be read", path));
  try {
    return Snapshot::read(text.str());
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path, error.what()));
  }
}

void write_state(const std::string& path, const Snapshot& state) { write_file(path, state.text()); }

}  // namespace cdot
