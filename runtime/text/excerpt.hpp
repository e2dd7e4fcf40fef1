// Lays out a line of a file with carets under the part that a message concerns. Specs and scenes share it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cdot::text {

// The UTF-8 character at a byte. A character that is not valid counts as one byte.
struct Character {
  int length = 1;  // bytes
  bool valid = false, printable = false;
};
Character character_at(std::string_view text, std::size_t i);

// Bytes [begin, end) of a line; the first byte of a primary mark gets a caret.
struct Mark {
  int begin, end;
  bool primary = true;
};

// The style in which a kind of message shows a line.
struct Look {
  int columns;             // at most, of a long line
  std::string_view cut;    // stands for a part that is left out
  std::string_view blank;  // stands for a character that does not print, or is not valid; empty: itself
  char under;              // below a marked part, after its caret
  bool caret_at_end;       // the place behind the last character counts as a column
  // The first column to show, of a line of so many columns whose first mark covers [begin, end).
  int (*first)(int columns, int begin, int end);
};

struct Excerpt {
  std::string text, carets;
};
Excerpt excerpt(std::string_view line, std::vector<Mark> marks, const Look& look);

// "    7 | text" and "      | carets"; the numbers take `width` columns.
std::string numbered(int line, const Excerpt& shown, std::size_t width = 5);

}  // namespace cdot::text
