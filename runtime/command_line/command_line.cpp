#include "runtime/command_line/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <utility>

#include "runtime/command_line/completion.hpp"
#include "runtime/text/number.hpp"
#include "runtime/text/spelling.hpp"

namespace cdot::command_line {
namespace {

// CLI11 says no more than that it cannot convert.
const CLI::Validator whole_number(
    [](const std::string& text) {
      int number = 0;
      const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
      const bool whole = failure == std::errc{} && end == text.data() + text.size();
      return whole ? "" : fmt::format("`{}` is not a whole number up to {}", text, std::numeric_limits<int>::max());
    },
    "");

// Adds an option, by the type of its target.
struct Add {
  CLI::App& app;
  const std::string &names, &help;

  CLI::Option* operator()(bool* to) const { return app.add_flag(names, *to, help); }
  template <class T>
  CLI::Option* operator()(T* to) const {
    return of_kind<T>(app.add_option(names, *to, help));
  }
  template <class T>
  CLI::Option* operator()(const std::function<void(T)>& take) const {
    return of_kind<T>(app.add_option_function<std::remove_cvref_t<T>>(names, take, help));
  }

 private:
  template <class T>
  static CLI::Option* of_kind(CLI::Option* option) {
    return std::is_same_v<T, int> ? option->check(whole_number) : option;
  }
};

// CLI11's own ranges accept nan, and print the largest double in full. Replaces a fraction, 1/60, by its value.
CLI::Validator finite_number(const std::string& kind, const char* words, bool (*in_range)(double)) {
  const auto problem = [=](std::string& text) {
    std::string_view rest = text;
    const std::optional<double> number = text::take_number(rest);
    if (!number || !rest.empty() || !std::isfinite(*number) || !in_range(*number))
      return fmt::format("`{}` is not {}", text, words);
    if (text.find('/') != text.npos) text = fmt::format("{}", *number);
    return std::string();
  };
  return {problem, kind};
}

}  // namespace

Option& Option::required() { return option_->required(), *this; }
Option& Option::positive() {
  return option_->transform(finite_number("POSITIVE", "a positive number", [](double x) { return x > 0; })), *this;
}
Option& Option::not_negative() {
  return option_->transform(finite_number("NONNEGATIVE", "a number from 0 on", [](double x) { return x >= 0; })), *this;
}
Option& Option::one_of(const std::vector<std::string>& texts) { return option_->check(CLI::IsMember(texts)), *this; }
Option& Option::separated_by_commas() { return option_->delimiter(','), *this; }
Option& Option::excludes(const std::string& earlier) { return option_->excludes(earlier), *this; }
Option& Option::needs(const std::string& earlier) { return option_->needs(earlier), *this; }
Option& Option::repeatable() { return option_->take_last(), *this; }
Option& Option::shown_as(const std::string& kind) { return option_->type_name(kind), *this; }
Option& Option::shows_default() { return option_->capture_default_str(), *this; }

Option Line::add(const std::string& names, const Target& to, const std::string& help) {
  return Option(std::visit(Add{app_, names, help}, to));
}

void Line::footer(const std::string& text) { app_.footer(text); }

void Line::retire() { app_.group("")->allow_extras()->set_help_flag(); }
void Line::is_of_a_program() { app_.allow_extras(); }

namespace {

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

// CLI11 keeps the texts of one_of() in the name of the option's type: "TEXT:{bash,zsh}".
std::vector<std::string> values_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{'), end = type.rfind('}');
  if (begin == type.npos || end == type.npos) return {};
  return CLI::detail::split(type.substr(begin + 1, end - begin - 1), ',');
}

CompletedCommand completed(const CLI::App& command) {
  CompletedCommand result{
      command.get_name(), first_line(command.get_description()), {}, {}, command.get_allow_extras()};
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) {
      result.values = values_of(*option);
      continue;
    }
    CompletedOption& last = result.options.emplace_back();
    for (const std::string& name : option->get_snames()) last.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) last.names.push_back("--" + name);
    last.help = first_line(option->get_description());
    last.values = values_of(*option);
    last.is_flag = option->get_items_expected_max() == 0;
  }
  return result;
}

// A retired command has no group, and no help.
std::vector<CompletedCommand> completed_commands(const CLI::App& app) {
  std::vector<CompletedCommand> commands;
  for (const CLI::App* command : app.get_subcommands({}))
    if (!command->get_group().empty()) commands.push_back(completed(*command));
  return commands;
}

// The first word is neither a command nor an option of the program; empty if it is.
std::string unknown_command(const CLI::App& app, int argc, const char* const* argv) {
  std::vector<std::string> names;
  for (const CompletedCommand& command : completed_commands(app)) names.push_back(command.name);
  const std::string all = fmt::format("the commands are {}", fmt::join(names, ", "));
  if (argc < 2) return fmt::format("no command: {}", all);
  const std::string word = argv[1];
  const auto is_called = [&](const CLI::App* command) { return command->check_name(word); };
  if (std::ranges::any_of(app.get_subcommands({}), is_called)) return {};
  if (word.starts_with('-')) {
    const std::vector<std::string> options = {"-h", "--help", "--version"};
    if (std::ranges::find(options, word) != options.end()) return {};
    return fmt::format("no option is called `{}`{}", word, text::did_you_mean(word, options));
  }
  const std::string near = text::did_you_mean(word, names);
  return fmt::format("no command is called `{}`{}", word, near.empty() ? ": " + all : near);
}

// Options by which other programs call those of a command.
constexpr std::pair<std::string_view, std::string_view> options_elsewhere[] = {
    {"--method", "--integrator"},  {"--scheme", "--integrator"}, {"--dt", "--step"},
    {"--timestep", "--step"},      {"--duration", "--until"},    {"--time", "--until"},
    {"--tolerance", "--accuracy"},
};

std::string option_meant(const std::string& name, std::span<const std::string> known) {
  for (const auto& [elsewhere, here] : options_elsewhere)
    if (name == elsewhere && std::ranges::find(known, here) != known.end())
      return fmt::format("; did you mean `{}`?", here);
  return text::did_you_mean(name, known);
}

// The first option that the command does not have; else empty.
std::string unknown_option(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands()) {
    std::vector<std::string> known;
    for (const CompletedOption& option : completed(*command).options)
      known.insert(known.end(), option.names.begin(), option.names.end());
    for (const std::string& word : app.remaining(true)) {
      if (word.size() < 2 || word[0] != '-') continue;
      const std::string name = word.substr(0, word.find('='));
      return fmt::format("{} has no option `{}`{}", command->get_name(), name, option_meant(name, known));
    }
  }
  return {};
}

int complain(const Program& program, const std::string& what, const std::string& command) {
  fmt::print(stderr, "{}: {}\nRun `{}{} --help` for more.\n", program.name, what, program.name,
             command.empty() ? "" : " " + command);
  return wrong_usage;
}

// The status, if all of the standard output has been written.
int if_written(const Program& program, int status) {
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return status;
  fmt::print(stderr, "{}: standard output cannot be written: {}\n", program.name, std::strerror(errno));
  return wrong_usage;
}

void add_completion(CLI::App& app, const Program& program, Run& selected) {
  CLI::App& sub = *app.add_subcommand("completion", "Write the script by which a shell completes these commands");
  const auto shell = std::make_shared<std::string>();
  sub.add_option("SHELL", *shell, "bash: for `source`; zsh: a file in $fpath")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh"}));
  sub.footer(
      fmt::format("In bash:  source <({0} completion bash)\n"
                  "In zsh:   {0} completion zsh > ~/.zfunc/_{0}, with ~/.zfunc in $fpath before compinit",
                  program.name));
  sub.callback([&, shell] {
    selected = [&, shell] {
      const std::vector<CompletedCommand> commands = completed_commands(app);
      const std::string name = program.name;
      fmt::print("{}", *shell == "bash" ? bash_completion(name, commands) : zsh_completion(name, commands));
      return 0;
    };
  });
}

}  // namespace

int run(const Program& program, std::span<const Command> commands, int argc, const char* const* argv) {
  CLI::App app(program.description, program.name);
  app.require_subcommand(1);
  app.footer(program.footer);
  app.set_version_flag("--version", fmt::format("{} {}", program.name, CDOT_VERSION), "Print the version and exit");
  Run selected;
  for (const Command& command : commands) {
    CLI::App& sub = *app.add_subcommand(command.name, command.summary);
    Line line(sub);
    sub.callback([&selected, run = command.add_options(line)] { selected = run; });
  }
  add_completion(app, program, selected);
  if (const std::string unknown = unknown_command(app, argc, argv); !unknown.empty())
    return complain(program, unknown, "");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (const std::string unknown = unknown_option(app); !unknown.empty())
      return complain(program, unknown, app.get_subcommands().front()->get_name());
    return if_written(program, app.exit(error) == 0 ? 0 : wrong_usage);
  }
  return if_written(program, selected());
}

}  // namespace cdot::command_line
