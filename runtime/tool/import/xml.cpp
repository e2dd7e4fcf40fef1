#include "runtime/tool/import/xml.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <locale>
#include <sstream>
#include <string_view>

#include <cdot/settings.hpp>

namespace cdot {

using Eigen::Vector3d;

XmlReader::Element& XmlReader::parse(const std::string& text) {
  if (document_.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS)
    fail(document_.ErrorLineNum(), fmt::format("this is no XML ({})", document_.ErrorName()));
  return *document_.RootElement();
}

void XmlReader::include_files(Element& of, const std::filesystem::path& folder) {
  for (Element* e = of.FirstChildElement(); e;) {
    const bool includes = e->Name() == std::string_view("include");
    if (includes) include(of, *e, folder);
    else include_files(*e, folder);
    Element* const next = e->NextSiblingElement();  // which a file has just brought, if e includes one
    if (includes) of.DeleteChild(e);
    e = next;
  }
}

void XmlReader::include(Element& of, Element& include, const std::filesystem::path& folder) {
  const std::string name = attribute(include, "file"), path = (folder / name).string();
  if (!included_.insert(name).second) fail(include.GetLineNum(), fmt::format("{} is included twice", name));
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLError error = document.LoadFile(path.c_str());
  if (error == tinyxml2::XML_ERROR_FILE_NOT_FOUND || error == tinyxml2::XML_ERROR_FILE_COULD_NOT_BE_OPENED)
    fail(include.GetLineNum(), fmt::format("there is no {} to include", path));
  if (error != tinyxml2::XML_SUCCESS)
    fail(include.GetLineNum(),
         fmt::format("{}:{}: this is no XML ({})", path, document.ErrorLineNum(), document.ErrorName()));
  tinyxml2::XMLNode* last = &include;
  for (const auto* e = document.RootElement()->FirstChild(); e; e = e->NextSibling())
    last = of.InsertAfterChild(last, e->DeepClone(&document_));
}

void XmlReader::fail(int line, const std::string& what) const {
  if (line == 0 && !included_.empty()) throw Error(fmt::format("{}, in a file that it includes: {}", file_, what));
  throw Error(fmt::format("{}:{}: {}", file_, line, what));
}

std::string XmlReader::attribute(const Element& e, const char* key) const {
  const char* value = e.Attribute(key);
  if (!value || !*value) fail(e.GetLineNum(), fmt::format("<{}> needs the attribute `{}`", e.Name(), key));
  return value;
}

std::vector<double> XmlReader::list(const Element& e, const char* key) const {
  std::vector<double> values;
  const char* text = e.Attribute(key);
  if (!text) return values;
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  for (double value; in >> value;) values.push_back(value);
  const bool all = in.eof() && !values.empty();
  if (!all || !std::ranges::all_of(values, [](double v) { return std::isfinite(v); }))
    fail(e.GetLineNum(), fmt::format("`{}` of <{}> is \"{}\": it takes finite numbers", key, e.Name(), text));
  return values;
}

std::vector<double> XmlReader::numbers(const Element& e, const char* key, std::size_t count) const {
  const char* text = e.Attribute(key);
  const auto wrong = [&] {
    fail(e.GetLineNum(), fmt::format("`{}` of <{}> is \"{}\": it takes {} finite number{}", key, e.Name(), text, count,
                                     count == 1 ? "" : "s"));
  };
  if (!text) return {};
  std::vector<double> values;
  try {
    values = list(e, key);
  } catch (const Error&) {
    wrong();
  }
  if (values.size() != count) wrong();
  return values;
}

Vector3d XmlReader::vector(const Element& e, const char* key, const Vector3d& otherwise) const {
  const std::vector<double> v = numbers(e, key, 3);
  return v.empty() ? otherwise : Vector3d(v[0], v[1], v[2]);
}

double XmlReader::number(const Element& e, const char* key, double otherwise) const {
  const std::vector<double> v = numbers(e, key, 1);
  return v.empty() ? otherwise : v[0];
}

double XmlReader::not_negative(const Element& e, const char* key, double otherwise) const {
  const double value = number(e, key, otherwise);
  if (value < 0) fail(e.GetLineNum(), fmt::format("`{}` of <{}> is {}: it must not be negative", key, e.Name(), value));
  return value;
}

Vector3d XmlReader::direction(const Element& e, const char* key, const Vector3d& otherwise) const {
  const Vector3d along = vector(e, key, otherwise);
  if (!(along.norm() > 1e-9))
    fail(e.GetLineNum(), fmt::format("`{}` of <{}> is a direction of length 0", key, e.Name()));
  return along.normalized();
}

}  // namespace cdot
