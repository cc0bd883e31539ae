// Reads film and reconstruction filter.
#pragma once

#include "io/plugin_tree.h"
#include "scene/description.h"

namespace fluxfarm {

// Throws SceneError, also for an image without pixels or with too many, and for a crop window outside the frame.
FilmDescription read_film(const PluginNode& film);

// The film of a sensor that names none: 768 x 576, gaussian filter, as in Mitsuba.
FilmDescription default_film();

}  // namespace fluxfarm
