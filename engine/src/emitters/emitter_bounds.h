// What is known about a group of emitters without asking each: where they lie, whither they shine and how strongly.
//
// [Conty18] A. Conty Estevez, C. Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", PACMCGIT 1(2), 2018.
#pragma once

#include "math/bounds.h"
#include "math/vec.h"

namespace fluxfarm {

// The orientation is a cone of normals and how far from a normal light may leave.
struct EmitterBounds {
  Bounds box;             // world, m
  Vec3f axis{0, 0, 1};    // unit, in the middle of the normals
  float spread = kPi;     // rad, every normal lies that close to the axis: theta_o
  float reach = kPi / 2;  // rad, light leaves that close to a normal, with at most the cosine of the angle to it: theta_e
  float intensity = 0;    // W sr^-1, luminance; what all together send along their normals

  // Both together. Either may be empty: of an empty box.
  static EmitterBounds join(const EmitterBounds& a, const EmitterBounds& b);
  // Size of the directions into which light goes, weighted with the cosine to the next normal, sr.
  double orientation_measure() const;
};

}  // namespace fluxfarm
