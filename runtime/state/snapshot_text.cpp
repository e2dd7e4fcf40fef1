// A snapshot <-> text: lines for the Origin, a line for each array, and a hash of all lines. Hexadecimal floats keep
// every bit.
#include <charconv>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <iterator>

#include <cdot/settings.hpp>
#include <cdot/snapshot.hpp>

namespace cdot {
namespace {

constexpr std::string_view first_line = "cdot state 2";

template <class F>
bool with_number_type(char type, F f) {
  switch (type) {
    case 'd': return f(double{}), true;
    case 'f': return f(float{}), true;
    case 'e': return f(0.0L), true;
    case 'i': return f(int{}), true;
    case 'l': return f(0ll), true;
    case 'c': return f(static_cast<signed char>(0)), true;
  }
  return false;
}

// FNV-1a
std::uint64_t hash_of(std::string_view text) {
  std::uint64_t hash = 14695981039346656037ull;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return hash;
}

template <class Number>
void write(std::string& text, Number number) {
  auto out = std::back_inserter(text);
  if constexpr (std::is_floating_point_v<Number>)
    number == 0 && !std::signbit(number) ? fmt::format_to(out, " 0") : fmt::format_to(out, " {:a}", number);
  else fmt::format_to(out, " {}", static_cast<long long>(number));
}

// Reads lines and words; errors name the line.
class Reader {
 public:
  explicit Reader(std::string_view text) : size_(text.size()), rest_(text) { next_line(); }

  void next_line() {
    ++line_number_;
    line_start_ = size_ - rest_.size();
    ended_ = rest_.empty();
    line_ = rest_.substr(0, rest_.find('\n'));
    rest_.remove_prefix(std::min(rest_.size(), line_.size() + 1));
  }
  bool ended() const { return ended_; }
  std::string_view line() const { return line_; }
  std::size_t line_start() const { return line_start_; }

  std::string_view word() {
    line_.remove_prefix(std::min(line_.size(), line_.find_first_not_of(' ')));
    const std::string_view word = line_.substr(0, line_.find(' '));
    line_.remove_prefix(word.size());
    return word;
  }
  void expect(std::string_view wanted) {
    if (const auto found = word(); found != wanted)
      fail(fmt::format("\"{}\" where \"{}\" should stand", found, wanted));
  }
  template <class Number>
  Number number(int base = 10) {
    std::string_view found = word(), digits = found;
    Number number{};
    std::from_chars_result result{};
    if constexpr (std::is_floating_point_v<Number>) {
      const bool negative = digits.starts_with('-');
      digits.remove_prefix(negative ? 1 : 0);
      digits.remove_prefix(digits.starts_with("0x") ? 2 : 0);
      result = std::from_chars(digits.data(), digits.data() + digits.size(), number, std::chars_format::hex);
      if (negative) number = -number;
    } else {
      result = std::from_chars(digits.data(), digits.data() + digits.size(), number, base);
    }
    if (digits.empty() || result.ec != std::errc{} || result.ptr != digits.data() + digits.size())
      fail(fmt::format("\"{}\" is not a number", found));
    return number;
  }
  void end_line() {
    if (const auto more = word(); !more.empty()) fail(fmt::format("unexpected \"{}\"", more));
    next_line();
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(fmt::format("line {}: {}: this is not a complete state", line_number_, what));
  }

 private:
  std::size_t size_, line_start_ = 0;
  std::string_view rest_, line_;
  int line_number_ = 0;
  bool ended_ = false;
};

Snapshot::Origin read_origin(Reader& reader) {
  Snapshot::Origin origin;
  const auto pair = [&](const char* name, int* count, std::uint64_t& hash) {
    reader.expect(name);
    if (count) *count = reader.number<int>();
    hash = reader.number<std::uint64_t>(16);
    reader.end_line();
  };
  reader.expect("of");
  origin.method = reader.line().substr(std::min<std::size_t>(1, reader.line().size()));
  reader.next_line();
  pair("bodies", &origin.body_count, origin.bodies);
  pair("joints", &origin.joint_count, origin.joints);
  pair("order", nullptr, origin.order);
  return origin;
}

// Reads one line: name, type, count, numbers. Appends the numbers to `bytes`.
Snapshot::Item read_item(Reader& reader, std::string_view name, std::vector<std::byte>& bytes) {
  const std::string_view type = reader.word();
  const Snapshot::Item item{std::string(name), type.size() == 1 ? type[0] : ' ', reader.number<std::size_t>()};
  const bool known = with_number_type(item.type, [&](auto number) {
    for (std::size_t k = 0; k < item.count; ++k) {
      number = reader.number<decltype(number)>();
      const auto* from = reinterpret_cast<const std::byte*>(&number);
      bytes.insert(bytes.end(), from, from + sizeof number);
    }
  });
  bytes.resize(Snapshot::aligned(bytes.size()));
  if (!known) reader.fail(fmt::format("\"{}\" is not a type of numbers", type));
  reader.end_line();
  return item;
}

}  // namespace

std::string Snapshot::text() const {
  std::string text =
      fmt::format("{}\nof {}\nbodies {} {:x}\njoints {} {:x}\norder {:x}\n", first_line, origin_.method,
                  origin_.body_count, origin_.bodies, origin_.joint_count, origin_.joints, origin_.order);
  std::size_t at = 0;
  for (const Item& item : items()) {
    text += fmt::format("{} {} {}", item.name, item.type, item.count);
    with_number_type(item.type, [&](auto number) {
      for (std::size_t k = 0; k < item.count; ++k, at += sizeof number) {
        std::memcpy(&number, bytes_.data() + at, sizeof number);
        write(text, number);
      }
    });
    at = aligned(at);
    text += '\n';
  }
  return text + fmt::format("end {:x}\n", hash_of(text));
}

Snapshot Snapshot::read(std::string_view text) {
  Reader reader(text);
  Snapshot snapshot;
  if (reader.line() != first_line) reader.fail(fmt::format("it does not begin with \"{}\"", first_line));
  reader.next_line();
  snapshot.origin_ = read_origin(reader);
  Items items;
  std::string_view name;
  for (; !reader.ended() && (name = reader.word()) != "end";) items.push_back(read_item(reader, name, snapshot.bytes_));
  snapshot.items_ = std::make_shared<const Items>(std::move(items));
  if (reader.ended()) reader.fail("the last line is missing");
  if (reader.number<std::uint64_t>(16) != hash_of(text.substr(0, reader.line_start())))
    reader.fail("the text was changed: its hash differs");
  return snapshot;
}

}  // namespace cdot
