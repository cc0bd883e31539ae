// How probable it may at most be that Russian roulette lets a path go on.
#pragma once

namespace fluxfarm {

// So that a path between perfect reflectors, or in an endless white medium, ends, too.
//
// A bounce that keeps rho of the light and is survived with probability p multiplies the second moment by rho^2 / p: with a cap at
// or below rho^2 the variance grows with every bounce. 0.95, a common choice, does so in rooms of albedo 0.975 and more; this one
// not below 0.9995.
inline constexpr float kMaxSurvival = 0.999f;

}  // namespace fluxfarm
