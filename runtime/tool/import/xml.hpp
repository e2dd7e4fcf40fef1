// Elements of an XML file to numbers and names; a mistake is told with file and line.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <set>
#include <string>
#include <tinyxml2.h>
#include <vector>

namespace cdot {

class XmlReader {
 protected:
  using Element = tinyxml2::XMLElement;

  // `text` stays with the reader. Returns the root.
  Element& parse(const std::string& text);
  // Puts the elements of the files that <include file="..."/> names in its place, each file once. Their paths are seen
  // from `folder`. Included elements have the line 0.
  void include_files(Element& of, const std::filesystem::path& folder);
  [[noreturn]] void fail(int line, const std::string& what) const;
  std::string attribute(const Element& e, const char* key) const;  // which it needs
  std::vector<double> list(const Element& e,
                           const char* key) const;  // finite numbers, parted by blanks; {} if not given
  std::vector<double> numbers(const Element& e, const char* key, std::size_t count) const;  // likewise
  Eigen::Vector3d vector(const Element& e, const char* key, const Eigen::Vector3d& otherwise) const;
  double number(const Element& e, const char* key, double otherwise) const;
  double not_negative(const Element& e, const char* key, double otherwise) const;
  Eigen::Vector3d direction(const Element& e, const char* key, const Eigen::Vector3d& otherwise) const;  // of length 1

  std::string file_;

 private:
  void include(Element& of, Element& include, const std::filesystem::path& folder);

  tinyxml2::XMLDocument document_;
  std::set<std::string> included_;
};

}  // namespace cdot
