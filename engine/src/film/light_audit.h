// What an estimate from the side of the light says about a picture: by cells, the tiles of a picture with an error goal.
//
// It sees surfaces with a continuous lobe that the camera sees directly, and of their light all that comes from emitters which can
// be followed; a path from the camera sees that and more. Radiances are means over R, G, B, as relMSE weighs them, and over the
// pixels of the cell, in W m^-2 sr^-1.
#pragma once

#include <vector>

namespace fluxfarm {

struct LightAudit {
  struct Cell {
    // Light that a path from the camera finds in the long run, and the variance of that estimate.
    double radiance = 0, variance = 0;
    // Light that no path from the camera can find.
    double unreachable = 0;
    // Share of the picture there that is seen in or through smooth surfaces, where the audit is blind. Zero where nothing is
    // unreachable and nothing rare: nobody asks.
    double blind = 0;
    // Of light that was scattered sharply (integrators/photon/sharpness.h) the mean square of what one path that may find it
    // brings back, W^2 m^-4 sr^-2: what such light adds to the variance of path tracing, but for what falls on other surfaces.
    double sharp_square = 0;
  };
  std::vector<Cell> cells;  // of make_tiles(crop, kErrorTile), in that order
  // Share of the light arriving at surfaces with a continuous lobe, anywhere in the scene, that no path from the camera can find.
  double unreachable_share = 0;
  // The share, in the same, of light that was scattered sharply and that paths may find, and the mean radiance that a path which
  // finds it brings back, W m^-2 sr^-1. Zero where the method looks for such light.
  double rare_share = 0, rare_brightness = 0;
  // A scene that cannot be audited has no cells. All that is known is whether it has what makes light that no path finds: point,
  // spot or directional emitters together with smooth surfaces.
  enum Outcome { kAudited, kNotPossible, kNotPossibleWithUnreachable } outcome = kAudited;
};

}  // namespace fluxfarm
