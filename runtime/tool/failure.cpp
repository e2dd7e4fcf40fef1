#include "runtime/tool/failure.hpp"

#include <exception>
#include <fmt/format.h>

#include "runtime/command_line/command_line.hpp"
#include "runtime/text/colour.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

int report_failure(const char* program) {
  try {
    throw;
  } catch (const SceneError& error) {
    text::print_messages(stderr, error.what());
    fmt::print(stderr, "{} mistake{}\n", error.mistakes, error.mistakes == 1 ? "" : "s");
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", program, error.what());
  }
  return command_line::wrong_usage;
}

}  // namespace cdot
