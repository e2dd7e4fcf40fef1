// Arguments of a program -> the options of one of its commands. Both programs describe their commands with it; CLI11
// stays inside command_line.cpp, since each file that includes CLI11 takes seconds to compile.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace cdot::command_line {

// Receives the value of an option. Its type decides which texts are values; the option of a bool is a flag.
using Target = std::variant<bool*, int*, double*, std::optional<double>*, std::string*, std::vector<double>*,
                            std::vector<std::string>*, std::function<void(int)>, std::function<void(double)>,
                            std::function<void(const std::string&)>>;

class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option& required();
  Option& positive();
  Option& not_negative();
  Option& one_of(const std::vector<std::string>& texts);
  Option& separated_by_commas();
  Option& excludes(const std::string& earlier);  // the name of an option that the line has already
  Option& needs(const std::string& earlier);
  Option& repeatable();                       // the last one counts
  Option& shown_as(const std::string& kind);  // the kind of its value, in the help: FILE
  Option& shows_default();

 private:
  CLI::Option* option_;
};

// The options of one command.
class Line {
 public:
  explicit Line(CLI::App& app) : app_(app) {}

  // The names are "-o,--output", or one in capitals for an argument without a name.
  Option add(const std::string& names, const Target& to, const std::string& help);
  void footer(const std::string& text);
  void retire();           // not in the help, and takes any argument
  void is_of_a_program();  // beside this one, which knows its options

 private:
  CLI::App& app_;
};

using Run = std::function<int()>;  // returns the exit status

struct Command {
  const char *name, *summary;
  Run (*add_options)(Line&);  // the result runs the command
};

struct Program {
  const char *name, *description;
  const char* footer;  // of the program, and of commands without their own
};

inline constexpr int wrong_usage = 2;

// Runs the command of the arguments. Reports wrong usage and returns `wrong_usage`.
int run(const Program& program, std::span<const Command> commands, int argc, const char* const* argv);

// Adds the options of a command. run() gets their values.
template <class Options>
Run with_options(Line& line, void (*add)(Line&, Options&), int (*run)(const Options&)) {
  auto options = std::make_shared<Options>();
  add(line, *options);
  return [options, run] { return run(*options); };
}

}  // namespace cdot::command_line
