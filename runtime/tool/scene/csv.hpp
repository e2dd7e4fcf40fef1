// A file of columns: a line of heads, "time [s], thrust [N]", and lines of numbers. Commas or semicolons part them, and
// # begins a comment.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cdot {

class Csv {
 public:
  // The numbers of a column in this unit; a head without a unit is in it. Throws cdot::Error.
  std::vector<double> column(std::string_view name, std::string_view unit) const;

 private:
  friend Csv read_csv(const std::string& path);
  struct Head {
    std::string name, unit;  // no unit: empty
  };
  std::vector<Head> heads_;
  std::vector<std::vector<double>> columns_;
};

// Throws cdot::Error with line and column of what is wrong.
Csv read_csv(const std::string& path);

}  // namespace cdot
