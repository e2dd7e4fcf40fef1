// One table of a scene file, read key by key: it checks types, ranges and `repeat`, and complains about unknown keys.
// Nothing else knows toml++.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <toml++/toml.h>
#include <vector>

#include "runtime/tool/scene/mistakes.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// The range of a number. A file may write any number as "1/60", an angle also as "30 deg".
enum class Sign { any, positive, not_negative };
struct Quantity {
  Sign sign = Sign::any;
  bool angle = false;
};

Span span_of(const toml::source_region& region);
std::string type_of(const toml::node& node);  // "a string", "an array", as a message names it

class Entry {
 public:
  // `what` names the table in messages: "[[body]]". Copies count from 0.
  Entry(const toml::table& table, Span header, std::string what, Mistakes& mistakes, int copy = 0);

  // Of the copies of a repeated entry.
  static constexpr const char *repeat_key = "repeat", *shift_key = "shift", *each_key = "each";

  // The entries of the array of tables `key`, with their copies.
  std::vector<Entry> list(const std::string& key);

  bool has(const std::string& key);
  bool leaves_table_unread(const std::string& key) const;   // an unread table
  std::vector<std::string> unread() const;                  // the keys that nobody has read
  Span where(const std::string& key) const;                 // of its value, or of the header if it is absent
  Span element(const std::string& key, std::size_t index);  // of one value of a list
  Span header() const { return header_; }
  const std::string& what() const { return what_; }
  void rename(std::string what) { what_ = std::move(what); }

  std::optional<double> number(const std::string& key, Quantity = {});
  std::optional<int> whole(const std::string& key, int least);
  std::optional<bool> flag(const std::string& key);
  std::optional<std::string> text(const std::string& key);
  std::string written(const std::string& key);  // the text before {i} is replaced; empty if there is none
  std::optional<std::vector<std::string>> texts(const std::string& key);
  std::optional<std::vector<double>> numbers(const std::string& key, std::size_t size, Quantity = {});
  // A number, or what stands in its place: a text that is none, or a table.
  struct Written {
    std::optional<double> number;
    std::string text;
    const toml::table* table = nullptr;
    Span where;
  };
  // The elements of a list of this size, or without a size the value itself.
  std::optional<std::vector<Written>> written_numbers(const std::string& key, std::optional<std::size_t> size,
                                                      Quantity = {});
  Entry at(const Written& table) const;               // as an entry of its own
  std::string beside(const std::string& path) const;  // a path from the folder of the file

  // `count` lists of three numbers, one after the other.
  std::optional<std::vector<double>> rows(const std::string& key, std::size_t count);
  // Nothing if the value is not a table; with an `example` that is a mistake.
  std::optional<Entry> table(const std::string& key, const std::string& example = "");
  bool is_array(const std::string& key);
  bool is_table(const std::string& key);
  bool is_function(const std::string& key, Quantity = {});  // a text that is no number, or { table = … }
  bool is_array_of_arrays(const std::string& key);
  std::optional<std::string> choice(const std::string& key, const std::vector<std::string>& allowed);
  void required(const std::string& key, const std::string& fix);  // a mistake if it is absent

  void error(Span where, const std::string& cause, const std::string& fix = {}) const;
  // Reports every key that nobody has read. Call it last.
  void close(const std::vector<std::string>& also_known = {}) const;

 private:
  const toml::table* of_copies(const char* key) const;  // `shift` or `each` of a repeated entry
  const toml::node* find(const std::string& key);
  std::optional<Written> written_number(const toml::node& node, const std::string& key, std::size_t index, Quantity);
  std::optional<double> plain_number(const toml::node& node, const std::string& key, Quantity);
  std::optional<std::string> plain_text(const toml::node& node);
  std::optional<double> shifted_number(const toml::node& node, const std::string& key, std::size_t index, Quantity);
  std::optional<double> shift_of(const std::string& key, std::size_t index);
  std::optional<std::string> substituted(const std::string& text, Span where) const;
  void wrong_type(const toml::node& node, const std::string& key, const std::string& wanted) const;
  void check_repeat(int copies);

  const toml::table* table_;
  Span header_;
  std::string what_;
  Mistakes* mistakes_;
  int copy_ = 0;
  bool repeated_ = false;
  std::set<std::string> asked_;
};

}  // namespace cdot
