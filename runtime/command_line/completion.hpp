// The commands and options of a program -> scripts by which a shell completes them.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace cdot::command_line {

struct CompletedOption {
  std::vector<std::string> names;   // "-o", "--output"
  std::string help;                 // its first line
  std::vector<std::string> values;  // all that it takes; empty: any
  bool is_flag = false;             // takes no value
};

struct CompletedCommand {
  std::string name, summary;
  std::vector<std::string> values;  // of its argument; empty: files
  std::vector<CompletedOption> options;
  bool asks_help = false;  // its options are those that its help lists when a person completes them
};

// Any other value or argument is completed as a file.
std::string bash_completion(const std::string& program, std::span<const CompletedCommand> commands);
std::string zsh_completion(const std::string& program, std::span<const CompletedCommand> commands);

}  // namespace cdot::command_line
