// J in the other two forms of velocity in space, and what form (c) has to do with the partial derivative of C.
#include <algorithm>
#include <utility>

#include "derive/explain/lecture.hpp"

namespace cdot::derive {
namespace {

// A matrix that belongs to a body: A_a, G_a, e_a.
Formula of_body(const std::string& letter, const Lecture& lecture, std::size_t body) {
  return leaf({}, letter + "_" + lecture.joint.bodies[body]);
}

// The block of w in the other form: M A, or 2 M G.
Formula turning_block(const Lecture& lecture, const Statement& s, std::size_t body, Form form) {
  const Formula& block = s.J[body].w;
  if (block == number(0)) return block;
  if (form == Form::local) return product({block, of_body("A", lecture, body)});
  return product({number(2), block, of_body("G", lecture, body)});
}

Chain jacobian_in(const Lecture& lecture, const Part& part, Form form) {
  std::vector<Formula> blocks;
  for (const Statement& s : part.statements) {
    for (std::size_t b = 0; b < lecture.joint.bodies.size(); ++b) {
      blocks.push_back(s.J[b].v);
      blocks.push_back(turning_block(lecture, s, b, form));
    }
  }
  const std::string name = "J_" + std::string(name_of(form));
  const std::string of = part.block.name.empty() ? "" : "[" + part.block.name + "]";
  const int columns = static_cast<int>(2 * lecture.joint.bodies.size());
  return {leaf({}, name + of), {{matrix(columns, std::move(blocks)), ""}}};
}

void define_local(const Lecture& lecture, Step& step) {
  step.say(
      "w' are the components of w along the axes of the body: w = {} w'. So A multiplies the factor of w: "
      "J_local = J diag(E, A, E, A, ...).",
      {leaf({}, "A")});
  const std::string& a = lecture.joint.bodies[0];
  step.say(
      "K is the same: with inv_I'_" + a + " = A_" + a + "' inv_I_" + a + " A_" + a +
      ", the inverse inertia in the body's axes, J_local M'^-1 J_local' = J A A' inv_I A A' J' = K, since A A' = E.");
}

void define_euler(Step& step) {
  step.say("e = (e0, e1, e2, e3) are the Euler parameters of the body, e · e = 1, and w = 2 G e_dot with");
  const auto e = [](int k) { return leaf({}, "e" + std::to_string(k)); };
  step.show({leaf({}, "G"),
             {{matrix(4, {negative(e(1)), e(0), negative(e(3)), e(2),  //
                          negative(e(2)), e(3), e(0), negative(e(1)),  //
                          negative(e(3)), negative(e(2)), e(1), e(0)}),
               ""}}});
  step.say("So 2 G multiplies the factor of w: J_euler = J diag(E, 2 G, E, 2 G, ...).");
}

EulerColumns euler_columns_of(const Lecture& lecture, const Part& part, const Statement& s, std::size_t body) {
  EulerColumns worst = EulerColumns::partial_derivative;
  const std::size_t rows = s.vector() ? 3 : 1;
  for (std::size_t i = s.first; i < s.first + rows; ++i) {
    worst = std::max(worst, euler_columns(part.block.rows[i], lecture.joint, static_cast<int>(body)));
  }
  return worst;
}

// dC/de of one body, and where J's columns are just that.
void compare_with_partial(const Lecture& lecture, const Part& part, const Statement& s, std::size_t body, Step& step) {
  const Formula block = turning_block(lecture, s, body, Form::euler);
  const EulerColumns columns = euler_columns_of(lecture, part, s, body);
  const Formula C = label("C", s, s.C);
  const Formula name = quotient(leaf({}, "d" + C.name), leaf({}, "de_" + lecture.joint.bodies[body]));
  if (columns == EulerColumns::partial_derivative) {
    if (block == number(0)) return;
    step.show({name, {{block, "J_euler is the partial derivative itself"}}});
    return;
  }
  const Expr along = time_derivative(s.C, lecture.joint, {.stretched = static_cast<int>(body)});
  const Formula extra = product({lecture.notation.of(along), shaped(Shape::transpose, of_body("e", lecture, body))});
  const std::string where =
      columns == EulerColumns::where_C_is_zero
          ? "J_euler is the partial derivative where C = 0; elsewhere they agree on e · e_dot = 0 only"
          : "J_euler agrees with it on e · e_dot = 0 only";
  std::vector<SignedFormula> terms = terms_of(block);
  if (block == number(0)) terms.clear();
  terms.push_back({false, extra});
  step.show({name, {{sum(std::move(terms)), where}}});
}

}  // namespace

void explain_form(Lecture& lecture, const Part& part, Form form) {
  if (form == Form::global) return;
  const bool local = form == Form::local;
  Step& step = lecture.section(local ? "The Jacobian by angular velocities in the bodies' axes"
                                     : "The Jacobian by rates of the Euler parameters");
  if (local) define_local(lecture, step);
  else define_euler(step);
  step.show(jacobian_in(lecture, part, form));
  if (local) return;
  step.say(
      "Is that the partial derivative of C? A(e) is of second degree in e, so along e itself a vector s fixed in the "
      "body grows by 2 s, which no rotation does. Where e · e = 1, dC/de = J_euler + (dC/de e) e', and the last term "
      "vanishes for rates that preserve e · e = 1, that is e · e_dot = 0:");
  for (const Statement& s : part.statements) {
    if (s.kind == RowKind::velocity) {
      step.say("Row `" + s.row->name + "` is written at velocity level: there is no C to differentiate.");
      continue;
    }
    for (std::size_t b = 0; b < lecture.joint.bodies.size(); ++b) {
      compare_with_partial(lecture, part, s, b, step);
    }
  }
}

void show_form(const Lecture& lecture, const Part& part, Form form, Step& step) {
  if (form != Form::global) step.show(jacobian_in(lecture, part, form));
}

}  // namespace cdot::derive
