#include "runtime/command_line/completion.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace cdot::command_line {
namespace {

// A function of a shell cannot have a hyphen in its name everywhere.
std::string function_of(std::string program) {
  std::ranges::replace(program, '-', '_');
  return "_" + program;
}

std::vector<std::string> names_of(std::span<const CompletedOption> options) {
  std::vector<std::string> names;
  for (const CompletedOption& option : options) names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

// "simulate:-o|simulate:--output": a pattern of `case` for an option of a command.
std::string pattern(const CompletedCommand& command, const CompletedOption& option) {
  std::vector<std::string> words;
  for (const std::string& name : option.names) words.push_back(command.name + ":" + name);
  return fmt::format("{}", fmt::join(words, "|"));
}

// Inside '…' of zsh, where brackets and colons part the fields of _arguments.
std::string quoted(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\'') result += "'\\''";
    else result += c == '[' || c == ']' || c == ':' || c == '\\' ? fmt::format("\\{}", c) : std::string(1, c);
  }
  return result;
}

std::string zsh_option(const CompletedOption& option) {
  const std::string value = option.is_flag          ? ""
                            : option.values.empty() ? ":value:_files"
                                                    : fmt::format(":value:({})", fmt::join(option.values, " "));
  std::string text;
  for (const std::string& name : option.names)
    text += fmt::format(" \\\n        '*{}[{}]{}'", name, quoted(option.help), value);
  return text;
}

// A pipe that prints the long options of a command, one a line.
std::string asked_options(const std::string& program, const CompletedCommand& command) {
  return fmt::format("$({} {} --help 2>/dev/null | sed -nE \"s/^ +(-[a-z],)?(--[a-z-]+).*/\\\\2/p\")", program,
                     command.name);
}

}  // namespace

std::string bash_completion(const std::string& program, std::span<const CompletedCommand> commands) {
  const std::string function = function_of(program);
  std::vector<std::string> names;
  std::string values, words;
  for (const CompletedCommand& command : commands) {
    names.push_back(command.name);
    const std::string options = command.asks_help ? asked_options(program, command)
                                                  : fmt::format("'{}'", fmt::join(names_of(command.options), " "));
    words += fmt::format("    {}) options={} values='{}' ;;\n", command.name, options, fmt::join(command.values, " "));
    for (const CompletedOption& option : command.options)
      if (!option.values.empty())
        values +=
            fmt::format("    {}) options= values='{}' ;;\n", pattern(command, option), fmt::join(option.values, " "));
  }
  return fmt::format(R"(# Completion of {0} in bash, written by `{0} completion bash`.
{1}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} command=${{COMP_WORDS[1]}} options= values=
  if ((COMP_CWORD == 1)); then
    COMPREPLY=($(compgen -W '{2} --help --version' -- "$word"))
    return
  fi
  case "$command" in
{4}  esac
  case "$command:$before" in
{3}  esac
  if [[ $word == -* ]]; then COMPREPLY=($(compgen -W "$options" -- "$word"))
  elif [[ $values ]]; then COMPREPLY=($(compgen -W "$values" -- "$word"))
  else COMPREPLY=($(compgen -f -- "$word"))
  fi
}}
complete -o filenames -F {1} {0}
)",
                     program, function, fmt::join(names, " "), values, words);
}

std::string zsh_completion(const std::string& program, std::span<const CompletedCommand> commands) {
  std::string names, options;
  for (const CompletedCommand& command : commands) {
    names += fmt::format("    '{}:{}'\n", command.name, quoted(command.summary));
    options += fmt::format("    {})\n      _arguments", command.name);
    for (const CompletedOption& option : command.options) options += zsh_option(option);
    if (command.asks_help)
      options += fmt::format(" \\\n        ${{${{(f)\"{}\"}}/%/:value:_files}}", asked_options(program, command));
    const bool files = command.values.empty();
    options += fmt::format(" \\\n        '*:argument:{}' ;;\n",
                           files ? "_files" : fmt::format("({})", fmt::join(command.values, " ")));
  }
  return fmt::format(R"(#compdef {0}
# Completion of {0} in zsh, written by `{0} completion zsh`.
{1}() {{
  local -a commands=(
{2}  )
  if ((CURRENT == 2)); then _describe command commands; return; fi
  local command=$words[2]
  shift words
  ((CURRENT--))
  case $command in
{3}  esac
}}
{1} "$@"
)",
                     program, function_of(program), names, options);
}

}  // namespace cdot::command_line
