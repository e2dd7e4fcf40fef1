#include "runtime/command_line/command_line.hpp"

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>

namespace cdot::command_line {
namespace {

// Adds an option, by the type of its target.
struct Add {
  CLI::App& app;
  const std::string &names, &help;

  CLI::Option* operator()(bool* to) const { return app.add_flag(names, *to, help); }
  template <class T>
  CLI::Option* operator()(T* to) const {
    return app.add_option(names, *to, help);
  }
  template <class T>
  CLI::Option* operator()(const std::function<void(T)>& take) const {
    return app.add_option_function<std::remove_cvref_t<T>>(names, take, help);
  }
};

// CLI11's own ranges accept nan, and print the largest double in full.
CLI::Validator finite_number(const std::string& kind, const char* words, bool (*in_range)(double)) {
  const auto problem = [=](const std::string& text) {
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    const bool whole = !text.empty() && *end == '\0';
    return whole && std::isfinite(number) && in_range(number) ? "" : fmt::format("`{}` is not {}", text, words);
  };
  return {problem, kind};
}

}  // namespace

Option& Option::required() { return option_->required(), *this; }
Option& Option::positive() {
  return option_->check(finite_number("POSITIVE", "a positive number", [](double x) { return x > 0; })), *this;
}
Option& Option::not_negative() {
  return option_->check(finite_number("NONNEGATIVE", "a number from 0 on", [](double x) { return x >= 0; })), *this;
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

int run(const Program& program, std::span<const Command> commands, int argc, const char* const* argv) {
  CLI::App app(program.description, program.name);
  app.require_subcommand(1);
  app.footer(program.footer);
  Run selected;
  for (const Command& command : commands) {
    CLI::App& sub = *app.add_subcommand(command.name, command.summary);
    Line line(sub);
    sub.callback([&selected, run = command.add_options(line)] { selected = run; });
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : wrong_usage;
  }
  const int status = selected();
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return status;
  fmt::print(stderr, "{}: standard output cannot be written: {}\n", program.name, std::strerror(errno));
  return wrong_usage;
}

}  // namespace cdot::command_line
