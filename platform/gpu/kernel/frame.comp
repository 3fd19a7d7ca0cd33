#version 450
#extension GL_GOOGLE_include_directive : require
// The kernel as SPIR-V; -DPAIRS: in pairs of words; -DLIT: of lit pictures.
layout(local_size_x = 8, local_size_y = 8) in;  // kGroupSide of renderer.cpp
#include "parameters.inc"
layout(std140, binding = 0) uniform Parameters { uvec4 words[kParameterWords / 4]; } parameters;
layout(std430, binding = 1) readonly buffer Scene { uint words[]; } scene;
layout(std430, binding = 2) buffer Output { uint words[]; } result;
#define FN
#define OUT(T) out T
#define INOUT(T) inout T
#define P(i) parameters.words[(i) >> 2][(i) & 3]
#define S(i) scene.words[i]
#define R(i) result.words[i]
#define STORE(i, v) result.words[i] = v
#include "numbers.inc"
#include "picture.inc"
#include "octree.inc"
#ifdef LIT
#include "optics.inc"
#include "slope.inc"
#include "light.inc"
void main() { lit_invocation(gl_GlobalInvocationID.x, gl_GlobalInvocationID.y); }
#else
#include "invocation.inc"
void main() { invocation(gl_GlobalInvocationID.x, gl_GlobalInvocationID.y); }
#endif
