// The numbers of the bodies' velocities, and what acts on them without joints.
#pragma once

#include <fmt/format.h>
#include <string>

#include "derive/compile/rows/row_blocks.hpp"

namespace cdot::compile {

// Of a body's velocity.
struct Component {
  int body;
  std::size_t column;
  std::string name;                                 // "rod.x"
  std::string in(const std::string& array) const {  // "v[rod].x"
    return fmt::format("{}[{}]{}", array, name.substr(0, name.find('.')), name.substr(name.find('.')));
  }
};

// f(component, acceleration by gravity and constant forces, drag)
template <class F>
void each_component(const RowBlocks& blocks, F f) {
  const Mechanism& all = blocks.mechanism();
  for (int b = 0; b < static_cast<int>(all.bodies.size()); ++b) {
    const Body& body = all.bodies[static_cast<std::size_t>(b)];
    for (std::size_t c = 0; body.moves && c < all.columns(); ++c)
      f(Component{b, c, fmt::format("{}.{}", blocks.body_name(b), all.column(c))}, all.push(body, c),
        c < all.linear() ? body.linear_drag : body.angular_drag);
  }
}

// Velocities as inputs, by the names of components.
inline Values velocities_in(const RowBlocks& blocks, Algebra& algebra, const std::string& array) {
  Values velocities;
  each_component(blocks, [&](const Component& c, double, double) { velocities[c.name] = algebra.input(c.in(array)); });
  return velocities;
}

// M^-1 force of one component.
inline int change_of(const RowBlocks& blocks, Algebra& algebra, const Component& component, const Forces& forces) {
  return blocks.weighted(algebra, component.body, component.column, [&](std::size_t column) {
    const auto force = forces.find({component.body, column});
    return force == forces.end() ? algebra.value(0) : algebra.sum(force->second);
  });
}

}  // namespace cdot::compile
