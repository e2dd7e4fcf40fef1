// The spaces that the runtime is compiled for. Every stage is one template. CDOT_FOR_EACH_SPACE(declaration)
// instantiates it for each space; `declaration` is a macro of the space. With CDOT_EXTENDED the same files make a
// second library: Worlds in extended precision, without snapshots, changes and diagnoses.
#pragma once

#include <cdot/planar.hpp>
#include <cdot/spatial.hpp>

#define CDOT_FOR_EACH_EXTENDED_SPACE(declaration) declaration(Planar<long double>) declaration(Spatial<long double>)

#ifdef CDOT_EXTENDED
#define CDOT_FOR_EACH_SPACE(declaration) CDOT_FOR_EACH_EXTENDED_SPACE(declaration)
#define CDOT_FOR_EACH_NUMBER(declaration) declaration(long double)
#define CDOT_EXACT_NUMBER long double  // number type of K
#else
#define CDOT_FOR_EACH_SPACE(declaration) \
  declaration(Planar<double>) declaration(Planar<float>) declaration(Spatial<double>) declaration(Spatial<float>)
#define CDOT_FOR_EACH_NUMBER(declaration) declaration(double) declaration(float)
#define CDOT_EXACT_NUMBER double
#endif
