// The names in the formulas of a hand derivation: its lets and free symbols, names of the spec, and C, Cdot, J, K,
// lambda and E.
#pragma once

#include "derive/language/evaluate.hpp"
#include "derive/language/hand/hand.hpp"

namespace cdot::derive {

class HandNames final : public Scope {
 public:
  HandNames(const HandEntryAst& ast, const HandFile& file, const ReadResult& read, const GeneratedRows& generated)
      : ast_(ast), file_(file), read_(read), generated_(generated) {}

  // From here on C, J and so on belong to these rows, unless the entry defines them.
  void begin_part(std::vector<std::string> rows);
  void say(const std::string& quantity, const Value& value) { said_[quantity] = value; }
  // True if the entry may define the name; otherwise reports an error.
  bool is_free(const Word& name, Diagnostics& diagnostics) const;
  void define(const std::string& name, const Value& value) { own_[name] = value; }

  const Value* find(const std::string& name) override;
  const Value* rate_of(const std::string& name) override;
  int body(const std::string& letter) const override;
  void use_body(int, Span) override {}
  void use_world() override {}
  std::vector<std::string> known() const override;
  std::string hint(const std::string& name) const override;
  std::string bodies() const;  // a fix for an unknown body

 private:
  Value quantity(const std::string& name);
  Value lambda() const;

  const HandEntryAst& ast_;
  const HandFile& file_;
  const ReadResult& read_;
  const GeneratedRows& generated_;
  std::map<std::string, Value> own_, rates_;
  std::vector<std::string> rows_;  // of this part
  std::map<std::string, Value> said_;
  std::optional<Generated> generated_now_;
};

}  // namespace cdot::derive
