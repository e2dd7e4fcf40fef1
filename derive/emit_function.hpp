// One function of the kernel contract as C++ text.
#pragma once

#include <string>
#include <vector>

#include "derive/joint.hpp"
#include "derive/print_program.hpp"

namespace cdot::derive {

class FunctionWriter {
 public:
  explicit FunctionWriter(const Joint& joint);

  // `static void name(arguments of the contract) { statements }`, indented by `depth` levels.
  std::vector<std::string> function(const std::string& name, const Program& program,
                                    std::size_t rows, int depth) const;

  // default_value(index, ...): one case per parameter that has a default.
  struct Case {
    int index = 0;
    std::string comment;
    const Program* program = nullptr;
  };
  std::vector<std::string> default_value(const std::vector<Case>& cases) const;

 private:
  // A local name for one body's part of an argument: `const Pose<T>& a = q[0];`
  struct BodyPart {
    std::string name, argument, type;
    std::size_t body = 0;
  };

  std::vector<std::string> body(const Program& program, bool in_place, bool zeroed,
                                int depth) const;
  std::string arguments(const std::vector<std::string>& names, const std::set<std::string>& read,
                        std::size_t rows) const;
  std::string sized(std::string declaration, std::size_t rows) const;
  bool reads(const std::set<std::string>& read, const std::string& argument) const;

  std::size_t bodies_ = 0;
  std::vector<BodyPart> parts_;
  Printing printing_;
};

}  // namespace cdot::derive
