// The mistakes in the text of a scene file -> a report. Each has a place, a cause and, where one is likely, a fix.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cdot {

// A part of one line. Columns count characters from 1; `end` is one past the last. Line 0 stands for the whole file.
struct Span {
  int line = 0, begin = 0, end = 0;
  auto operator<=>(const Span&) const = default;
};

class Mistakes {
 public:
  Mistakes(std::string file, std::string_view text);

  void add(Span where, std::string cause, std::string fix = {});
  bool none() const { return found_.empty(); }
  int count() const;
  const std::string& file() const { return file_; }

  // All mistakes in the order of the file, each with its line and carets under the wrong part.
  std::string report() const;
  // One such paragraph: `kind` is "error" or "warning".
  std::string paragraph(std::string_view kind, Span where, std::string_view cause, std::string_view fix) const;

 private:
  struct Mistake {
    Span where;
    std::string cause, fix;
    auto operator<=>(const Mistake&) const = default;
  };
  std::vector<Mistake> ordered() const;

  std::string file_;
  std::vector<std::string> lines_;
  std::vector<Mistake> found_;
};

// "a scene calls it `spin`" for a word of other engines that means a known one; else empty.
std::string called_here(std::string_view word, std::span<const std::string> known);
// The same, or "did you mean `angle`?" for the known word nearest to `word`; else the list of known words, if there are
// any.
std::string did_you_mean(std::string_view word, std::span<const std::string> known);

}  // namespace cdot
