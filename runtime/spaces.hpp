// The spaces that the runtime is compiled for. Every stage is one template, instantiated for each
// of them by CDOT_FOR_EACH_SPACE(declaration), where `declaration` is a macro of the space.
#pragma once

#include "runtime/planar.hpp"
#include "runtime/spatial.hpp"

#define CDOT_FOR_EACH_SPACE(declaration)                                              \
  declaration(Planar<double>) declaration(Planar<float>) declaration(Spatial<double>) \
      declaration(Spatial<float>)
