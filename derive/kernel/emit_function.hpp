// One function of the kernel contract as C++ text.
#pragma once

#include <string>
#include <vector>

#include "derive/kernel/plan.hpp"
#include "derive/program/print.hpp"

namespace cdot::derive {

class FunctionWriter {
 public:
  explicit FunctionWriter(const Joint& joint);

  // `static void f(arguments of the contract) { statements }`, indented by `depth` levels.
  std::vector<std::string> function(const KernelFunction& f, std::size_t rows, int depth) const;

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

  struct BodyOptions {
    bool in_place = false;   // `apply` reads the velocities that it overwrites
    bool zeroed = false;     // the matrix was cleared before
    bool isotropic = false;  // inertias are numbers
  };
  void name_inputs_of_law(const Joint& joint);
  void name_inputs_of_body(const Joint& joint, std::size_t b);
  std::vector<std::string> body(const Program& program, const BodyOptions& options, int depth) const;
  std::string arguments(const std::vector<std::string>& names, const std::set<std::string>& read,
                        std::size_t rows) const;
  std::string sized(std::string declaration, std::size_t rows) const;
  bool reads(const std::set<std::string>& read, const std::string& argument) const;

  std::size_t bodies_ = 0, width_ = 0;
  bool on_any_coordinate_ = false, reads_mass_ = false;  // of an effect
  std::vector<BodyPart> parts_;
  Printing printing_;
};

}  // namespace cdot::derive
