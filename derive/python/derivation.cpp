// A spec -> its derivation as JSON, text, LaTeX and C++.
#include "derive/derivation/derivation.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <sstream>
#include <string>

#include <cdot/settings.hpp>

#include "derive/engines/engines.hpp"
#include "derive/explain/explain.hpp"
#include "derive/kernel/generate.hpp"
#include "derive/language/specs_folder.hpp"
#include "derive/python/arrays.hpp"

namespace cdot::python {
namespace {

using namespace derive;

constexpr std::size_t no_page = 1'000'000;  // a width that breaks no line

// "rod.joint" of a text that says `joint rod planar`.
std::string file_name_of(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line, kind, name; std::getline(lines, line);) {
    std::istringstream words(line);
    if (words >> kind >> name && (kind == "joint" || kind == "effect")) return name + "." + kind;
  }
  return "text.joint";
}

// A text has several lines, a path or a name one. A text includes the specs of the folder, and sees its planar or its
// spatial ones.
ReadResult read_spec(const std::string& spec, const SpecsFolder& specs) {
  if (spec.find('\n') == std::string::npos) return specs.read(specs.find(spec));
  const auto file = std::make_shared<const SourceFile>(file_name_of(spec), spec);
  const std::string known = dimension_of(*file) == 2 ? "planar/revolute" : "spatial/spherical";
  return read_joint(file, load_library(specs.find(known).parent_path()));
}

// The joint or effect of a spec, derived. Its expressions live in the pool of the spec.
class Derived {
 public:
  Derived(const std::string& spec, const std::string& folder) : read_(read_spec(spec, SpecsFolder(folder))) {
    messages = render(*read_.file, read_.diagnostics);
    if (!read_.joint) throw Error(messages);
    try {
      derivation_ = std::make_unique<Derivation>(derive::derive(*read_.joint));
    } catch (const NotLinear& error) {
      refuse(error.what());
    } catch (const NumberTooLarge& error) {
      refuse(error.what());
    }
  }

  std::string json() const { return explanation_json(*derivation_); }
  std::string text(const std::string& form) const { return explanation_text(explain(*derivation_, form_of(form))); }
  std::string latex(const std::string& form) const { return explanation_latex(explain(*derivation_, form_of(form))); }
  std::string html(const std::string& form) const { return explanation_html(explain(*derivation_, form_of(form))); }

  // The rows, then each coordinate: pairs of plain text and LaTeX.
  using Formulas = std::vector<std::vector<std::pair<std::string, std::string>>>;
  Formulas formulas() const {
    Formulas all;
    for (const std::vector<Chain>& block : summarise(*derivation_)) {
      all.emplace_back();
      for (const Chain& chain : block) {
        std::string text = chain_text(chain, no_page);
        while (text.ends_with('\n')) text.pop_back();
        all.back().emplace_back(std::move(text), chain_latex(chain, read_.joint->bodies));
      }
    }
    return all;
  }

  std::string kernel() const { return print(simplified_kernel()).kernel; }

  std::string emit(const std::string& name) const {
    std::vector<std::string> known;
    for (const Engine& engine : engines()) known.emplace_back(engine.name);
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw py::value_error(fmt::format("engine must be one of {}, but is `{}`", fmt::join(known, ", "), name));
    return single_header(engine_named(name), simplified_kernel());
  }

  std::string messages;  // warnings of the spec

 private:
  Kernel simplified_kernel() const { return simplified(plan(*derivation_)); }
  [[noreturn]] void refuse(const char* reason) const {
    Diagnostics diagnostics;
    diagnostics.error(read_.joint->rows.empty() ? derive::Span{} : read_.joint->rows.front().where, reason);
    throw Error(render(*read_.file, diagnostics));
  }
  Form form_of(const std::string& name) const {
    const Form form = form_named(name);
    if (name_of(form) != name) throw py::value_error("form must be global, local or euler, but is `" + name + "`");
    if (read_.joint->dimension == 2 && form != Form::global)
      throw py::value_error("form is for joints in space: in the plane w is one number, in every form");
    return form;
  }

  ReadResult read_;
  std::unique_ptr<Derivation> derivation_;
};

}  // namespace

void bind_derivation(py::module_& module) {
  py::register_exception<NoSuchSpec>(module, "NoSuchSpec", module.attr("Error")).attr("__doc__") =
      "No spec has this name or path.";
  py::register_exception<CannotEmit>(module, "CannotEmit", module.attr("Error")).attr("__doc__") =
      "The engine cannot have this joint; the message says why.";
  const char* forms =
      "In space, `form` is global, local or euler: w in world axes, in body axes, or the rates of the Euler "
      "parameters.";
  py::class_<Derived>(module, "Derived", "A spec, read and derived, as texts. cdot.derive() makes sympy of them.")
      .def(py::init<const std::string&, const std::string&>(), py::arg("spec"), py::arg("specs") = "specs",
           "A spec by its path, by its name in the folder `specs`, or its text, which has several lines.")
      .def("json", &Derived::json, "The output of `cdot explain --json`.")
      .def("text", &Derived::text, py::arg("form") = "global",
           ("The lecture as plain text. " + std::string(forms)).c_str())
      .def("latex", &Derived::latex, py::arg("form") = "global",
           ("The lecture as an article in LaTeX. " + std::string(forms)).c_str())
      .def("html", &Derived::html, py::arg("form") = "global", ("The lecture as a page. " + std::string(forms)).c_str())
      .def("formulas", &Derived::formulas,
           "Names, C, J and K of the rows, then of each coordinate: lists of pairs of plain text and LaTeX.")
      .def("kernel", &Derived::kernel, "The kernel as C++: the text that `cdot derive` writes into generated/.")
      .def("emit", &Derived::emit, py::arg("engine"),
           "A header that makes the joint one of an engine: the text of `cdot emit --for ENGINE`.")
      .def_readonly("messages", &Derived::messages, "Warnings about the spec, with line and caret; empty if none.");
}

}  // namespace cdot::python
